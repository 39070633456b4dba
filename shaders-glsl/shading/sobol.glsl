// Twin of photon-core's sobol.rs: the same words, bit for bit.
#ifndef SOBOL_GLSL
#define SOBOL_GLSL

uint sobol(uint index, uint dimension) {
    if (dimension == 0u) return bitfieldReverse(index);
    uvec3 v = uvec3(1u << 31, 3u << 30, 1u << 29);
    if (dimension == 1u) v.z = 5u << 29;
    if (dimension == 2u) v.z = 3u << 29;
    if (dimension == 4u) v.y = 1u << 30;
    uint point = 0u;
    for (; index != 0u; index >>= 1) {
        if ((index & 1u) != 0u) point ^= v.x;
        uint next;
        if (dimension == 1u) next = v.z ^ (v.z >> 1);
        else if (dimension == 2u) next = v.z ^ v.y ^ (v.y >> 2);
        else if (dimension == 3u) next = v.y ^ v.x ^ (v.x >> 3);
        else next = v.z ^ v.x ^ (v.x >> 3);
        v = uvec3(v.yz, next);
    }
    return point;
}

uint sobol_scramble(uint coordinate, uint seed) {
    uint x = bitfieldReverse(coordinate);
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    return bitfieldReverse(x);
}

#endif

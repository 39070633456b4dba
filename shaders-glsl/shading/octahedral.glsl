// Twin of photon-core's octahedral.rs: octahedral encoding of unit vectors in 32 bits.
#ifndef OCTAHEDRAL_GLSL
#define OCTAHEDRAL_GLSL

#include "shading/constants.glsl"
#include "shading/math.glsl"

uint octahedral_quantise(float f) {
    precise float scaled = clamp(f, -1.0, 1.0) * OCTAHEDRAL_STEPS + copysign(0.5, f);
    return uint(int(scaled)) & 0xFFFFu;
}

// Vectors that cannot be normalized become +z.
uint octahedral_pack(vec3 v) {
    precise float sum = abs(v.x) + abs(v.y) + abs(v.z);
    if (!is_positive_finite(sum)) return 0u;
    precise vec2 square = v.xy / sum;
    if (v.z < 0.0) {
        precise vec2 folded = (1.0 - abs(square.yx)) * vec2(copysign(1.0, v.x), copysign(1.0, v.y));
        square = folded;
    }
    return octahedral_quantise(square.x) | octahedral_quantise(square.y) << 16;
}

// A vector of the packed direction, of another length.
vec3 octahedral_unpack_unnormalized(uint word) {
    float x = float(bitfieldExtract(int(word), 0, 16)) * (1.0 / OCTAHEDRAL_STEPS);
    float y = float(bitfieldExtract(int(word), 16, 16)) * (1.0 / OCTAHEDRAL_STEPS);
    precise float z = 1.0 - abs(x) - abs(y);
    float fold = max(-z, 0.0);
    precise vec3 v = vec3(x - copysign(fold, x), y - copysign(fold, y), z);
    return v;
}

vec3 octahedral_unit(vec3 v) {
    precise vec3 unit = v / sqrt(dot3(v, v));
    return unit;
}

vec3 octahedral_unpack(uint word) {
    return octahedral_unit(octahedral_unpack_unnormalized(word));
}

#endif

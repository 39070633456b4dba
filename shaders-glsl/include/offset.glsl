// Twin of photon-core's offset.rs: points on triangles, and rays that leave them.
#ifndef OFFSET_GLSL
#define OFFSET_GLSL

// The point (1 - u - v) a + u b + v c.
vec3 barycentric(vec3 a, vec3 b, vec3 c, float u, float v) {
    precise vec3 point = a * (1.0 - u - v) + b * u + c * v;
    return point;
}

float off_surface_axis(float p, float n) {
    if (abs(p) < 1.0 / 32.0) {
        precise float moved = p + (1.0 / 65536.0) * n;
        return moved;
    }
    int steps = int(256.0 * n);
    return intBitsToFloat(floatBitsToInt(p) + (p < 0.0 ? -steps : steps));
}

// Moves `point` off its surface to the side that `normal` points to.
vec3 off_surface(vec3 point, vec3 normal) {
    return vec3(
        off_surface_axis(point.x, normal.x), off_surface_axis(point.y, normal.y), off_surface_axis(point.z, normal.z));
}

#endif

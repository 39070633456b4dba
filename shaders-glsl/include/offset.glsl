// Twin of photon-core's offset.rs: points on triangles, and rays that leave them.
#ifndef OFFSET_GLSL
#define OFFSET_GLSL

// The point (1 - u - v) a + u b + v c.
vec3 barycentric(vec3 a, vec3 b, vec3 c, float u, float v) {
    precise vec3 point = a * (1.0 - u - v) + b * u + c * v;
    return point;
}

// Moves `point` off its surface to the side that `normal` points to.
vec3 off_surface(vec3 point, vec3 normal) {
    precise vec3 moved = point + normal * (1.0 / 1048576.0);
    return moved;
}

#endif

// Twin of photon-core's offset.rs: points on triangles, and rays that leave them.
#ifndef OFFSET_GLSL
#define OFFSET_GLSL

const float OFFSET_STEP = 1.0 / 1048576.0;
const float OFFSET_MOST = 1.0 / 16.0;

// The point (1 - u - v) a + u b + v c.
vec3 barycentric(vec3 a, vec3 b, vec3 c, float u, float v) {
    precise vec3 point = a * (1.0 - u - v) + b * u + c * v;
    return point;
}

// Moves `point` off its surface to the side that `normal` points to.
vec3 off_surface(vec3 point, vec3 normal) {
    precise vec3 moved = point + normal * OFFSET_STEP;
    return moved;
}

// The weight that keeps a point two steps from an edge.
float least_weight(vec3 edge, float area) {
    precise float length = abs(edge.x) + abs(edge.y) + abs(edge.z);
    precise float wanted = 2.0 * OFFSET_STEP * length;
    return wanted < OFFSET_MOST * area ? wanted / area : OFFSET_MOST;
}

// The point of a triangle that a ray goes on from, two steps at least from its edges.
vec3 within(vec3 a, vec3 b, vec3 c, float u, float v) {
    precise float w = 1.0 - u - v;
    if (min(min(u, v), w) < OFFSET_MOST) {
        precise vec3 ab = b - a;
        precise vec3 ac = c - a;
        precise vec3 bc = c - b;
        precise vec3 across = vec3(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
        vec3 size = abs(across);
        float area = max(max(size.x, size.y), size.z);
        u = max(u, least_weight(ac, area));
        v = max(v, least_weight(ab, area));
        precise float lack = least_weight(bc, area) - (1.0 - u - v);
        if (lack > 0.0) {
            precise vec2 less = vec2(u, v) - lack;
            if (u > v) u = less.x;
            else v = less.y;
        }
    }
    return barycentric(a, b, c, u, v);
}

#endif

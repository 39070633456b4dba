// Twin of photon-core's offset.rs: points on triangles, and offsets of ray origins.
#ifndef OFFSET_GLSL
#define OFFSET_GLSL

#include "shading/constants.glsl"

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

// The barycentric weight that keeps a point away from the edge opposite a corner, and the position of the
// corner's foot on that edge.
vec2 above_edge(vec3 corner, vec3 from, vec3 to) {
    precise vec3 side = corner - from;
    precise vec3 edge = to - from;
    float squared = dot3(edge, edge);
    float along = dot3(side, edge) / (squared > 0.0 ? squared : 1.0);
    precise vec3 height = side - edge * along;
    vec3 size = abs(height);
    float tallest = max(max(size.x, size.y), max(size.z, OFFSET_MARGIN / OFFSET_MAX_SLOPE));
    return vec2(OFFSET_MARGIN / tallest, clamp(along, 0.0, 1.0));
}

// The weights of a corner and the two after it, adjusted so that the first has its minimum value.
vec3 raised(vec3 weights, vec2 above, float least, float next_least) {
    precise float lack = above.x - weights.x;
    if (!(lack > 0.0)) return weights;
    precise float spare = max(weights.y - least, 0.0);
    precise float next_spare = max(weights.z - next_least, 0.0);
    precise float across = lack * (1.0 - above.y);
    precise float rest = lack - next_spare;
    precise float first = min(max(across, rest), spare);
    precise vec3 result = vec3(weights.x + lack, weights.y - first, weights.z - (lack - first));
    return result;
}

// The displacement from a point to where it is two steps away from every edge.
vec3 inward(vec3 a, vec3 b, vec3 c, float u, float v) {
    vec2 at = above_edge(a, b, c), bt = above_edge(b, c, a), ct = above_edge(c, a, b);
    precise vec3 weights = vec3(1.0 - u - v, u, v);
    weights = raised(weights, at, bt.x, ct.x);
    weights = raised(weights.yzx, bt, ct.x, at.x).zxy;
    weights = raised(weights.zxy, ct, at.x, bt.x).yzx;
    precise vec3 way = (b - a) * (weights.y - u) + (c - a) * (weights.z - v);
    vec3 size = abs(way);
    float length = max(max(size.x, size.y), size.z);
    precise vec3 limited = way * (4.0 * OFFSET_MARGIN / max(length, 4.0 * OFFSET_MARGIN));
    return limited;
}

// The origin for a ray that starts on a triangle, at least two steps away from its edges. The host computes the
// margin.
vec3 within(vec3 a, vec3 b, vec3 c, float margin, float u, float v) {
    precise vec3 point = barycentric(a, b, c, u, v);
    precise float w = 1.0 - u - v;
    if (min(min(u, v), w) < margin) point = point + inward(a, b, c, u, v);
    return point;
}

#endif

// Boundaries of media that light passes: which media enclose a point, and where a ray crosses them. Twin of photon-core's
// boundaries.rs.
#ifndef BOUNDARIES_GLSL
#define BOUNDARIES_GLSL

#include "shading/media.glsl"

// Media whose boundaries enclose a point, and how often: four of each, a byte each.
struct Enclosing {
    uint media;
    int counts;
};

// Adds the crossing of a boundary: 1 where its medium is entered, -1 where it is left.
void enclosing_add(inout Enclosing around, uint medium, int crossing) {
    int place = -1;
    for (int at = 24; at >= 0; at -= 8) {
        if (bitfieldExtract(around.counts, at, 8) == 0) place = at;
    }
    for (int at = 24; at >= 0; at -= 8) {
        bool is_known = bitfieldExtract(around.counts, at, 8) != 0 && bitfieldExtract(around.media, at, 8) == medium;
        if (is_known) place = at;
    }
    if (place < 0) return;
    around.media = bitfieldInsert(around.media, medium, place, 8);
    around.counts = bitfieldInsert(around.counts, bitfieldExtract(around.counts, place, 8) + crossing, place, 8);
}

// Index of the medium that applies, where `solid` is that of the solids around the point.
uint enclosing_current(SceneRef scene, Enclosing around, uint solid) {
    uint found = solid;
    for (int at = 0; at < 32; at += 8) {
        if (bitfieldExtract(around.counts, at, 8) <= 0) continue;
        uint medium = bitfieldExtract(around.media, at, 8);
        uint priority = scene.media[medium].at.priority, of = scene.media[found].at.priority;
        bool is_equal = priority == of && (found == solid ? solid == 0u : medium > found);
        if (priority > of || is_equal) found = medium;
    }
    return found;
}

// On which side of an edge the ray passes, whose edge function is `value`: 1 or -1. A ray through the edge is moved aside.
int boundary_side(float value, vec2 from, vec2 to) {
    if (value != 0.0) return value > 0.0 ? 1 : -1;
    if (to.y != from.y) return to.y > from.y ? 1 : -1;
    return to.x == from.x ? 0 : to.x < from.x ? 1 : -1;
}

// How a ray crosses a triangle: 1 from the front, -1 from the back, 0 if that counts for a neighbour.
int boundary_crossing(Tested tested, Sheared s) {
    int u = boundary_side(tested.edges.x, tested.b, tested.c);
    int v = boundary_side(tested.edges.y, tested.c, tested.a);
    int w = boundary_side(tested.edges.z, tested.a, tested.b);
    if (u != v || v != w) return 0;
    return s.shear.z < 0.0 ? -u : u;
}

// A crossing: its distance, the triangle and its slot, and its direction.
struct Crossing {
    float t;
    uint triangle;
    uint slot;
    int crossing;
};

const uint NO_TRIANGLE = 0xFFFFFFFFu;

// Visits the crossings of a ray, in units of the boundaries. With `counts`, all of them: what the ray leaves more often than it
// enters it, it starts in. Else finds the nearest one beyond `after`.
void boundaries_walk(SceneRef scene, Ray ray, const bool counts, Crossing after, inout Enclosing around, out Crossing next) {
    next = Crossing(ray.t_max, NO_TRIANGLE, 0u, 0);
    Walk walk;
    bool under_way = walk_new(ray, 0u, walk);
    walk.nodes = scene.boundaries.nodes;
    walk.corners = scene.boundaries.corners;
    while (under_way) {
        uvec2 triangles = walk_node(walk);
        while (triangles.x != 0u) {
            uint slot = triangles.y + uint(findLSB(triangles.x));
            triangles.x &= triangles.x - 1u;
            vec4 first = walk.corners[slot].a;
            vec4 second = walk.corners[slot].b;
            Tested tested;
            if (!triangle_meets(first, second, walk.corners[slot].c, walk.sheared, tested)) continue;
            int crossing = tested.t >= 0.0 ? boundary_crossing(tested, walk.sheared) : 0;
            if (crossing == 0) continue;
            if (counts) {
                enclosing_add(around, floatBitsToUint(second.w), -crossing);
                continue;
            }
            bool is_beyond = tested.t > after.t || tested.t == after.t && tested.primitive > after.triangle;
            bool is_nearer = tested.t < next.t || tested.t == next.t && tested.primitive < next.triangle;
            if (is_beyond && is_nearer) {
                next = Crossing(tested.t, tested.primitive, slot, crossing);
                walk.best.t = tested.t;
            }
        }
        under_way = walk_on(walk);
    }
}

// Media around the start of a ray.
Enclosing enclosing_at(SceneRef scene, Ray ray) {
    Enclosing around = Enclosing(0u, 0);
    Crossing none = Crossing(0.0, NO_TRIANGLE, 0u, 0);
    boundaries_walk(scene, ray, true, none, around, none);
    return around;
}

// The nearest crossing of a ray beyond `after`; NO_TRIANGLE if there is none before ray.t_max.
Crossing crossing_next(SceneRef scene, Ray ray, Crossing after) {
    Enclosing unused = Enclosing(0u, 0);
    Crossing next;
    boundaries_walk(scene, ray, false, after, unused, next);
    return next;
}

// Unit normal of a triangle, along `direction`.
vec3 boundary_normal(SceneRef scene, uint slot, vec3 direction) {
    vec3 a = scene.boundaries.corners[slot].a.xyz;
    vec3 normal = cross(scene.boundaries.corners[slot].b.xyz - a, scene.boundaries.corners[slot].c.xyz - a);
    normal = normalize_or(normal, direction);
    return dot3(normal, direction) < 0.0 ? -normal : normal;
}

#endif

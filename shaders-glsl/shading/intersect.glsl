// Twin of photon-scene's `bvh::compressed`: the nearest triangle along a ray, and occlusion.
//
// Nodes with eight children in the layout of Ylitie, Karras and Laine 2017, 80 bytes each; the watertight
// triangle test of Woop, Benthin and Wald 2013. Included by scene.glsl, which defines the records.
#ifndef INTERSECT_GLSL
#define INTERSECT_GLSL

#extension GL_EXT_control_flow_attributes : enable

// A ray-triangle hit, at the point (1 - u - v) a + u b + v c.
struct Hit {
    float t;
    uint primitive;
    float u;
    float v;
    // Index of the triangle in the BVH's corner table.
    uint slot;
};

const uint NO_PRIMITIVE = 0xFFFFFFFFu;

// Minimum magnitude of a direction component before its inverse is taken: avoids infinities, and in a scene of
// unit size displaces the ray by a negligible distance. Boxes are padded by more than that.
const float MIN_COMPONENT = 5.4210109e-20;

// Far sides of boxes are moved by this factor, so that rounding never culls a triangle on the face of its box
// (after Ize 2013).
const float WIDER = 1.0000019;

// 2^-22, and 255 steps times 2^-23.
const float START_SLACK = 2.3841858e-7;
const float STEPS_SLACK = 3.0398369e-5;

// A ray in the frame of the test: sheared so that it runs along its largest axis.
struct Sheared {
    vec3 origin;
    vec3 shear;
    uint axis;
};

// Moves the largest axis of the direction to the last component. Unlike on the CPU the other two are never
// swapped: that only changes the sign of all edge functions.
vec3 turned(uint axis, vec3 v) {
    return axis == 2u ? v : axis == 1u ? v.zxy : v.yzx;
}

// Returns false for a ray with a zero direction or with numbers that are not finite.
bool sheared(Ray ray, out Sheared s) {
    vec3 size = abs(ray.direction);
    uint axis = size.x > size.y ? (size.x > size.z ? 0u : 2u) : (size.y > size.z ? 1u : 2u);
    vec3 d = turned(axis, ray.direction);
    s.origin = ray.origin;
    s.axis = axis;
    s.shear = vec3(0.0);
    // Tested by the bits, since infinity and NaN are to be detected.
    bool sane = is_finite(ray.origin.x) && is_finite(ray.origin.y) && is_finite(ray.origin.z)
        && is_finite(ray.direction.x) && is_finite(ray.direction.y) && is_finite(ray.direction.z) && d.z != 0.0
        && !is_nan(ray.t_max) && ray.t_max >= 0.0;
    if (!sane) return false;
    precise vec3 shear = vec3(d.x / d.z, d.y / d.z, 1.0 / d.z);
    s.shear = shear;
    return true;
}

// Rounding error of a product (Dekker 1971), by splitting into halves of 12 bits.
float product_error(float a, float b, float product) {
    precise float ca = 4097.0 * a;
    precise float a_high = ca - (ca - a);
    precise float a_low = a - a_high;
    precise float cb = 4097.0 * b;
    precise float b_high = cb - (cb - b);
    precise float b_low = b - b_high;
    precise float error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    return error;
}

// The edge function of two corners. Triangles that share an edge compute the same two products, and their
// differences have opposite signs: rounding cannot put a ray outside of both. Hence `precise`.
float edge(vec2 from, vec2 to) {
    precise float left = to.x * from.y;
    precise float right = to.y * from.x;
    precise float difference = left - right;
    return difference;
}

// Re-evaluates an edge function that is zero, using the rounding errors of its products.
float edge_again(vec2 from, vec2 to) {
    precise float left = to.x * from.y;
    precise float right = to.y * from.x;
    precise float difference = product_error(to.x, from.y, left) - product_error(to.y, from.x, right);
    return difference;
}

// ab − cd, with only one rounding error of that difference.
float difference(float a, float b, float c, float d) {
    precise float left = a * b;
    precise float right = c * d;
    precise float result = (left - right) + (product_error(a, b, left) - product_error(c, d, right));
    return result;
}

// Distance to the plane through these points, or `other` if the ray is parallel to it. Uses a normal that has
// full precision however thin the triangle is.
float plane_distance(vec3 a, vec3 b, vec3 c, vec3 shear, float other) {
    precise vec3 p = b - a;
    precise vec3 q = c - a;
    float x = difference(p.y, q.z, p.z, q.y);
    float y = difference(p.z, q.x, p.x, q.z);
    float z = difference(p.x, q.y, p.y, q.x);
    precise float along = x * shear.x + y * shear.y + z;
    precise float away = shear.z * (x * a.x + y * a.y + z * a.z);
    return along != 0.0 ? away / along : other;
}

// A triangle that a ray may meet.
struct Tested {
    // Its corners, in the plane across the ray.
    vec2 a;
    vec2 b;
    vec2 c;
    // Edge functions: each is the weight of the opposite corner times their sum.
    vec3 edges;
    float determinant;
    float t;
    uint primitive;
};

// The watertight test; both sides are hit, and edges and vertices belong to every triangle that has them.
//
// Distances to triangles around the origin are computed from their planes: as weighted means of the vertices'
// distances, those of slivers would have errors larger than the offset of rays from surfaces, so that a ray
// would hit the triangle that it just left.
bool triangle_meets(vec4 first, vec4 second, vec4 third, Sheared s, out Tested tested) {
    precise vec3 a = turned(s.axis, first.xyz - s.origin);
    precise vec3 b = turned(s.axis, second.xyz - s.origin);
    precise vec3 c = turned(s.axis, third.xyz - s.origin);
    precise vec2 pa = a.xy - s.shear.xy * a.z;
    precise vec2 pb = b.xy - s.shear.xy * b.z;
    precise vec2 pc = c.xy - s.shear.xy * c.z;
    float u = edge(pb, pc);
    float v = edge(pc, pa);
    float w = edge(pa, pb);
    if (u == 0.0 || v == 0.0 || w == 0.0) {
        u = u == 0.0 ? edge_again(pb, pc) : u;
        v = v == 0.0 ? edge_again(pc, pa) : v;
        w = w == 0.0 ? edge_again(pa, pb) : w;
    }
    if (min(min(u, v), w) < 0.0 && max(max(u, v), w) > 0.0) return false;
    precise float determinant = u + v + w;
    if (determinant == 0.0) return false;
    precise vec3 z = s.shear.z * vec3(a.z, b.z, c.z);
    precise float scaled = u * z.x + v * z.y + w * z.z;
    precise float t = scaled / determinant;
    // A weighted mean of numbers of the same sign has that sign.
    if (min(min(z.x, z.y), z.z) <= BVH_PLANE_TOLERANCE && max(max(z.x, z.y), z.z) >= -BVH_PLANE_TOLERANCE) {
        t = plane_distance(a, b, c, s.shear, t);
    }
    tested = Tested(pa, pb, pc, vec3(u, v, w), determinant, t, floatBitsToUint(first.w));
    return true;
}

// In a function, since a `precise` variable computed from members of a record makes the compiler hang.
vec2 weights_of(vec3 edges, float determinant) {
    precise vec2 weights = edges.yz / determinant;
    return weights;
}

// Replaces `best` if the triangle is nearer, or at the same distance with a lower index, and if it is there for the
// random word `word` (see alpha.glsl).
void test_triangle(SceneRef scene, Corners table, uint slot, Sheared s, uint word, inout Hit best) {
    Corners corners = table[slot];
    vec4 first = corners.a;
    vec4 second = corners.b;
    vec4 third = corners.c;
    Tested at;
    if (!triangle_meets(first, second, third, s, at)) return;
    if (at.t >= 0.0 && (at.t < best.t || at.t == best.t && at.primitive < best.primitive)) {
        vec2 weights = weights_of(at.edges, at.determinant);
        if (ALPHA && floatBitsToUint(third.w) != 0u && !alpha_is_there(scene, slot, at.primitive, weights, word)) return;
        best = Hit(at.t, at.primitive, weights.x, weights.y, slot);
    }
}

// Tests four children: for those whose boxes the ray enters before `t_max`, sets the bits that `meta` encodes,
// at the positions that `meta` encodes. Each byte of a word belongs to one child.
uint test_boxes(
    uint meta4, uint octant4, uvec3 near4, uvec3 far4, vec3 stride, vec3 near_start, vec3 far_start, float t_max
) {
    // The byte of an internal node is 001 11sss; that of a leaf is a unary count above the index of its first
    // triangle.
    uint nodes4 = meta4 & (meta4 << 1) & 0x10101010u;
    uint mask4 = (nodes4 >> 4) * 0xFFu;
    uint place4 = (meta4 ^ (octant4 & mask4)) & 0x1F1F1F1Fu;
    uint bits4 = (meta4 >> 5) & 0x07070707u;
    uint hits = 0u;
    [[unroll]] for (int child = 0; child < 4; ++child) {
        int at = 8 * child;
        vec3 near = vec3(uvec3(near4 >> at) & 0xFFu) * stride + near_start;
        vec3 far = vec3(uvec3(far4 >> at) & 0xFFu) * stride + far_start;
        float enter = max(max(near.x, near.y), max(near.z, 0.0));
        float leave = min(min(far.x, far.y), far.z) * WIDER;
        if (enter <= min(leave, t_max)) hits |= bitfieldExtract(bits4, at, 8) << bitfieldExtract(place4, at, 8);
    }
    return hits;
}

// State of a ray's traversal of the BVH.
struct Walk {
    // The table addresses, so that they are not read again at every node.
    WideNodes nodes;
    Corners corners;
    Sheared sheared;
    vec3 inverse;
    // Children are assigned to slots by octant: relative to the ray's octant, the nearest come first.
    uint octant;
    // Index of a node's first child; mask of the children to be visited, in the upper 8 bits in order of
    // distance; mask of those that are nodes, in the lower 8 bits by slot.
    uvec2 group;
    // Number of groups on the stack.
    uint waiting;
    // The ray's random word for surfaces with alpha.
    uint word;
    Hit best;
};

// The first groups of the stack are in shared memory, the others wherever the compiler puts them.
layout(constant_id = 10) const uint SHARED_GROUPS = 0u;
shared uvec2 shared_groups[SHARED_GROUPS * gl_WorkGroupSize.x + 1u];
// Each level of the BVH leaves at most one group of nodes on the stack.
uvec2 groups[BVH_MAX_DEPTH];

void push_group(inout Walk walk) {
    if (walk.waiting < SHARED_GROUPS) {
        shared_groups[walk.waiting * gl_WorkGroupSize.x + gl_LocalInvocationID.x] = walk.group;
    } else if (walk.waiting < BVH_MAX_DEPTH) {
        groups[walk.waiting] = walk.group;
    }
    ++walk.waiting;
}

void pop_group(inout Walk walk) {
    --walk.waiting;
    if (walk.waiting < SHARED_GROUPS) {
        walk.group = shared_groups[walk.waiting * gl_WorkGroupSize.x + gl_LocalInvocationID.x];
    } else {
        walk.group = groups[min(walk.waiting, BVH_MAX_DEPTH - 1u)];
    }
}

// The traversal of a tree at its root, without the addresses of the tree. Returns false for a ray that hits nothing.
bool walk_new(Ray ray, uint word, out Walk walk) {
    walk.best = Hit(min(ray.t_max, NO_LIMIT), NO_PRIMITIVE, 0.0, 0.0, 0u);
    bvec3 negative = lessThan(ray.direction, vec3(0.0));
    vec3 size = max(abs(ray.direction), vec3(MIN_COMPONENT));
    walk.inverse = mix(1.0 / size, -1.0 / size, negative);
    walk.octant = (negative.x ? 0u : 4u) | (negative.y ? 0u : 2u) | (negative.z ? 0u : 1u);
    // The root is alone in its group.
    walk.group = uvec2(0u, 0x80000000u);
    walk.waiting = 0u;
    walk.word = word;
    return sheared(ray, walk.sheared);
}

// Initializes the traversal at the root. Returns false if there is nothing that the ray can hit. `word` is the ray's
// random word for surfaces with alpha.
bool walk_begin(SceneRef scene, Ray ray, uint word, out Walk walk) {
    bool is_sane = walk_new(ray, word, walk);
    walk.nodes = scene.nodes;
    walk.corners = scene.corners;
    return is_sane && scene.triangles != 0u;
}

// Visits a node. Returns its triangles: a mask, and the slot of the first.
uvec2 walk_node(inout Walk walk) {
    uint bit = uint(findMSB(walk.group.y));
    walk.group.y &= ~(1u << bit);
    uint slot = (bit - 24u) ^ walk.octant;
    uint index = walk.group.x + uint(bitCount(walk.group.y & ((1u << slot) - 1u)));
    if (walk.group.y > 0x00FFFFFFu) push_group(walk);

    WideNodes node = walk.nodes[index];
    uvec4 head = node.words[0];
    uvec4 first = node.words[1];
    uvec4 low_xy = node.words[2];
    uvec4 low_z_high_x = node.words[3];
    uvec4 high_yz = node.words[4];
    bvec3 negative = lessThan(walk.inverse, vec3(0.0));
    uint octant4 = walk.octant * 0x01010101u;
    vec3 scale = uintBitsToFloat(uvec3(head.w & 0xFFu, head.w >> 8 & 0xFFu, head.w >> 16 & 0xFFu) << 23);
    vec3 stride = scale * walk.inverse;
    vec3 start = (uintBitsToFloat(head.xyz) - walk.sheared.origin) * walk.inverse;
    // Bound on the rounding error of a side computed in steps, which can be as large as its distance: two
    // rounding errors of the start, one of the steps, and a safety factor of two.
    vec3 slack = abs(start) * START_SLACK + abs(stride) * STEPS_SLACK;
    vec3 near_start = start - slack;
    vec3 far_start = start + slack;
    uvec3 low = uvec3(low_xy.x, low_xy.z, low_z_high_x.x);
    uvec3 high = uvec3(low_z_high_x.z, high_yz.x, high_yz.z);
    uvec3 near = mix(low, high, negative);
    uvec3 far = mix(high, low, negative);
    uint hits = test_boxes(first.z, octant4, near, far, stride, near_start, far_start, walk.best.t);
    low = uvec3(low_xy.y, low_xy.w, low_z_high_x.y);
    high = uvec3(low_z_high_x.w, high_yz.y, high_yz.w);
    near = mix(low, high, negative);
    far = mix(high, low, negative);
    hits |= test_boxes(first.w, octant4, near, far, stride, near_start, far_start, walk.best.t);

    walk.group = uvec2(first.x, (hits & 0xFF000000u) | head.w >> 24);
    return uvec2(hits & 0x00FFFFFFu, first.y);
}

// Goes on to the next node. Returns false if there is none.
bool walk_on(inout Walk walk) {
    if (walk.group.y > 0x00FFFFFFu) return true;
    if (walk.waiting == 0u) return false;
    pop_group(walk);
    return true;
}

// Visits a node and its triangles. Returns false if that was the last one; with `shadow`, any hit suffices, and
// the first one found ends the traversal.
bool walk_step(SceneRef scene, inout Walk walk, const bool shadow) {
    uvec2 triangles = walk_node(walk);
    while (triangles.x != 0u) {
        uint lowest = uint(findLSB(triangles.x));
        triangles.x &= triangles.x - 1u;
        test_triangle(scene, walk.corners, triangles.y + lowest, walk.sheared, walk.word, walk.best);
        if (shadow && walk.best.primitive != NO_PRIMITIVE) return false;
    }
    return walk_on(walk);
}

// The nearest hit up to `ray.t_max`, on either side of a triangle; of several at the same distance, the one
// with the lowest index. `word` is a random word, for surfaces with alpha.
bool nearest(SceneRef scene, Ray ray, uint word, out Hit hit) {
    Walk walk;
    bool under_way = walk_begin(scene, ray, word, walk);
    while (under_way) under_way = walk_step(scene, walk, false);
    hit = walk.best;
    return hit.primitive != NO_PRIMITIVE;
}

// Whether anything is hit up to `ray.t_max`; `word` as for `nearest`.
bool occluded(SceneRef scene, Ray ray, uint word) {
    Walk walk;
    bool under_way = walk_begin(scene, ray, word, walk);
    while (under_way) under_way = walk_step(scene, walk, true);
    return walk.best.primitive != NO_PRIMITIVE;
}

#endif

// Twin of photon-scene's `wide`: the nearest triangle along a ray, and whether there is one.
//
// Nodes of eight children as Ylitie, Karras and Laine 2017 lay them out, 80 bytes each; the
// watertight test of Woop, Benthin and Wald 2013. Included by scene.glsl, which has the records.
#ifndef INTERSECT_GLSL
#define INTERSECT_GLSL

#extension GL_EXT_control_flow_attributes : enable

// Where a ray meets a triangle: point (1 - u - v) a + u b + v c of it.
struct Hit {
    float t;
    uint primitive;
    float u;
    float v;
    // Where the tree has the triangle: the index of its corners.
    uint slot;
};

// Deepest tree that the host gives us; each level leaves at most one group of nodes waiting.
const uint TREE_DEPTH = 32u;

const uint NO_PRIMITIVE = 0xFFFFFFFFu;

// Smallest component of a direction whose inverse is taken: no infinity comes up, and within a
// scene of unit size the ray is off by less than can be seen. Boxes are padded by more than that.
const float MIN_COMPONENT = 5.4210109e-20;

// Far sides of boxes are moved by this factor, so that rounding never closes a box before a triangle
// on its face (after Ize 2013).
const float WIDER = 1.0000019;

// 2^-22, and 255 steps times 2^-23.
const float START_SLACK = 2.3841858e-7;
const float STEPS_SLACK = 3.0398369e-5;

// Vertices so near to the plane through the origin, across the ray's axis, are on either side of it.
const float BESIDE = 1.0 / 2097152.0;

// A ray in the test's own frame: sheared so that it runs along its largest axis.
struct Sheared {
    vec3 origin;
    vec3 shear;
    uint axis;
};

// Brings the largest axis of the direction to the last place. Unlike on the CPU the other two are
// never swapped: that changes the sign of all edge functions, and nothing else.
vec3 turned(uint axis, vec3 v) {
    return axis == 2u ? v : axis == 1u ? v.zxy : v.yzx;
}

// False for a ray without a direction or with numbers that are not finite.
bool sheared(Ray ray, out Sheared s) {
    vec3 size = abs(ray.direction);
    uint axis = size.x > size.y ? (size.x > size.z ? 0u : 2u) : (size.y > size.z ? 1u : 2u);
    vec3 d = turned(axis, ray.direction);
    s.origin = ray.origin;
    s.axis = axis;
    s.shear = vec3(0.0);
    // By the bits, since infinite and NaN are what is looked for.
    bool sane = is_finite(ray.origin.x) && is_finite(ray.origin.y) && is_finite(ray.origin.z)
        && is_finite(ray.direction.x) && is_finite(ray.direction.y) && is_finite(ray.direction.z) && d.z != 0.0
        && !is_nan(ray.t_max) && ray.t_max >= 0.0;
    if (!sane) return false;
    precise vec3 shear = vec3(d.x / d.z, d.y / d.z, 1.0 / d.z);
    s.shear = shear;
    return true;
}

// What rounding took from a product (Dekker 1971), by halves of 12 bits.
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

// The edge function of two corners. Triangles that share an edge get the same two products, and
// their difference with opposite sign: rounding cannot put a ray outside of both. Hence `precise`.
float edge(vec2 from, vec2 to) {
    precise float left = to.x * from.y;
    precise float right = to.y * from.x;
    precise float difference = left - right;
    return difference;
}

// An edge function that vanished, from what rounding took from its products.
float edge_again(vec2 from, vec2 to) {
    precise float left = to.x * from.y;
    precise float right = to.y * from.x;
    precise float difference = product_error(to.x, from.y, left) - product_error(to.y, from.x, right);
    return difference;
}

// ab − cd, but for one rounding of it.
float difference(float a, float b, float c, float d) {
    precise float left = a * b;
    precise float right = c * d;
    precise float result = (left - right) + (product_error(a, b, left) - product_error(c, d, right));
    return result;
}

// The distance of the plane through these points, or `other` if the ray runs along it. By a normal that has all its
// digits however thin the triangle is.
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

// Replaces `best` if the triangle is nearer, or as near and of lower index. Both sides count; edges
// and vertices belong to every triangle that has them.
//
// The distances of triangles about the origin come from their planes: as means of the vertices' distances, those of
// slivers are off by more than rays step off surfaces, so that a ray met the triangle that it had just left.
void test_triangle(Corners table, uint slot, Sheared s, inout Hit best) {
    Corners corners = table[slot];
    vec4 first = corners.a;
    vec4 second = corners.b;
    vec4 third = corners.c;
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
    if (min(min(u, v), w) < 0.0 && max(max(u, v), w) > 0.0) return;
    precise float determinant = u + v + w;
    if (determinant == 0.0) return;
    precise vec3 z = s.shear.z * vec3(a.z, b.z, c.z);
    precise float scaled = u * z.x + v * z.y + w * z.z;
    precise float t = scaled / determinant;
    // A mean of numbers of one sign has that sign.
    if (min(min(z.x, z.y), z.z) <= BESIDE && max(max(z.x, z.y), z.z) >= -BESIDE) {
        t = plane_distance(a, b, c, s.shear, t);
    }
    uint primitive = floatBitsToUint(first.w);
    if (t >= 0.0 && (t < best.t || t == best.t && primitive < best.primitive)) {
        precise vec2 weights = vec2(v, w) / determinant;
        best = Hit(t, primitive, weights.x, weights.y, slot);
    }
}

// Of four children, those whose boxes the ray enters before `t_max`: for each, the bits that `meta`
// gives it at the place that `meta` says. A byte of each word belongs to one child.
uint test_boxes(
    uint meta4, uint octant4, uvec3 near4, uvec3 far4, vec3 stride, vec3 near_start, vec3 far_start, float t_max
) {
    // A node's byte is 001 11sss, a leaf's a unary count above the number of its first triangle.
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

// A ray on its way through the tree.
struct Walk {
    // The tables, so that their addresses are not read again at every node.
    WideNodes nodes;
    Corners corners;
    Sheared sheared;
    vec3 inverse;
    // Children stand in the slots of octants: counted from the ray's own, the nearest come first.
    uint octant;
    // Index of a node's first child; which children are to be visited, in the upper 8 bits in order of
    // nearness; which are nodes, in the lower 8 by slot.
    uvec2 group;
    // Groups that wait, the last first.
    uint waiting;
    Hit best;
};

// The first groups that wait stand in shared memory, the rest where the compiler puts them.
layout(constant_id = 10) const uint SHARED_GROUPS = 0u;
shared uvec2 shared_groups[SHARED_GROUPS * gl_WorkGroupSize.x + 1u];
uvec2 groups[TREE_DEPTH];

void push_group(inout Walk walk) {
    if (walk.waiting < SHARED_GROUPS) {
        shared_groups[walk.waiting * gl_WorkGroupSize.x + gl_LocalInvocationID.x] = walk.group;
    } else if (walk.waiting < TREE_DEPTH) {
        groups[walk.waiting] = walk.group;
    }
    ++walk.waiting;
}

void pop_group(inout Walk walk) {
    --walk.waiting;
    if (walk.waiting < SHARED_GROUPS) {
        walk.group = shared_groups[walk.waiting * gl_WorkGroupSize.x + gl_LocalInvocationID.x];
    } else {
        walk.group = groups[min(walk.waiting, TREE_DEPTH - 1u)];
    }
}

// Puts a ray before the root. False if there is nothing that it can hit.
bool walk_begin(SceneRef scene, Ray ray, out Walk walk) {
    walk.nodes = scene.nodes;
    walk.corners = scene.corners;
    walk.best = Hit(min(ray.t_max, NO_LIMIT), NO_PRIMITIVE, 0.0, 0.0, 0u);
    bvec3 negative = lessThan(ray.direction, vec3(0.0));
    vec3 size = max(abs(ray.direction), vec3(MIN_COMPONENT));
    walk.inverse = mix(1.0 / size, -1.0 / size, negative);
    walk.octant = (negative.x ? 0u : 4u) | (negative.y ? 0u : 2u) | (negative.z ? 0u : 1u);
    // The root is alone in its group.
    walk.group = uvec2(0u, 0x80000000u);
    walk.waiting = 0u;
    return sheared(ray, walk.sheared) && scene.triangles != 0u;
}

// Visits a node and its triangles. False if that was the last; if `shadow` lets any hit do, the first
// that is found ends it.
bool walk_step(inout Walk walk, const bool shadow) {
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
    // What rounding may take from a side counted in steps, which can be all of its distance: two roundings
    // of the start, one of the steps, and twice that to be safe.
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

    uint triangles = hits & 0x00FFFFFFu;
    while (triangles != 0u) {
        uint lowest = uint(findLSB(triangles));
        triangles &= triangles - 1u;
        test_triangle(walk.corners, first.y + lowest, walk.sheared, walk.best);
        if (shadow && walk.best.primitive != NO_PRIMITIVE) return false;
    }
    walk.group = uvec2(first.x, (hits & 0xFF000000u) | head.w >> 24);
    if (walk.group.y > 0x00FFFFFFu) return true;
    if (walk.waiting == 0u) return false;
    pop_group(walk);
    return true;
}

// The nearest hit up to `ray.t_max`, whichever side of the triangle it is on; of several at the same
// distance, the one of lowest index.
bool nearest(SceneRef scene, Ray ray, out Hit hit) {
    Walk walk;
    bool under_way = walk_begin(scene, ray, walk);
    while (under_way) under_way = walk_step(walk, false);
    hit = walk.best;
    return hit.primitive != NO_PRIMITIVE;
}

// Whether anything is hit up to `ray.t_max`.
bool occluded(SceneRef scene, Ray ray) {
    Walk walk;
    bool under_way = walk_begin(scene, ray, walk);
    while (under_way) under_way = walk_step(walk, true);
    return walk.best.primitive != NO_PRIMITIVE;
}

#endif

// Estimates from the nearest photon of each query: twin of backend-cpu's estimate.rs, `Search::NearestPhoton`.
// One invocation per query, since only a few leaves are read and there is little to share. On devices that end
// long loops it gives up after examining some 60 000 photons that face another way.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

// Whether queries are processed in the order of `push.order`.
layout(constant_id = 2) const uint ORDERED = 0;
// Which parts of a photon the map stores.
layout(constant_id = 3) const uint FORMAT = 2;

#include "shading/constants.glsl"
#include "device/grid.glsl"
#include "shading/photon_format.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/octahedral.glsl"
#include "search/map_nodes.glsl"
#include "search/search_distance.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    BoxNodes nodes;
    Slots positions;
    Fluxes power;
    Words ids;
    Queries queries;
    Words query_count;
    Estimates results;
    Words result_count;
    Words order;
    // Number of points in the map.
    uint points;
    // Index of the first query of this dispatch.
    uint first;
    uint capacity;
    float radius;
    float min_cosine;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

const uint NONE = 0xFFFFFFFFu;

// Parameters that every node or photon needs.
BoxNodes nodes;
Slots positions;
float min_cosine;

vec3 at, normal;
// The nearest photon so far: bits of its squared distance, initially of the squared radius; its slot.
uint best;
uint nearest_slot;

void look(uint first, uint count) {
    for (uint slot = first; slot < first + count; slot++) {
        uvec4 point = positions[slot].at;
        uint bits = floatBitsToUint(point_distance(at, uintBitsToFloat(point.xyz)));
        bool same = min_cosine <= -1.0 || dot3(octahedral_unpack(point.w), normal) >= min_cosine;
        if (bits > best || !same) continue;
        if (bits == best && nearest_slot != NONE && push.ids[nearest_slot].at <= push.ids[slot].at) continue;
        best = bits;
        nearest_slot = slot;
    }
}

uint bits_to(uint node) {
    vec3 low = uintBitsToFloat(nodes[node].low.xyz), high = uintBitsToFloat(nodes[node].high.xyz);
    return floatBitsToUint(box_distance(at, low, high));
}

// Traversal stack of groups of children: the first child, and a mask of those to be visited.
uvec2 groups[KD_TREE_MAX_DEPTH];

void walk() {
    uint node = 0, waiting = 0;
    uvec2 group = uvec2(0);
    bool more = true;
    while (more) {
        uint count = nodes[node].high.w, first = nodes[node].low.w;
        more = false;
        if ((count & KD_TREE_LEAF) != 0) {
            look(first, count & ~KD_TREE_LEAF);
        } else {
            // Visits the nearest child first, the others later.
            uint mask = 0, nearest = 0, least = NONE;
            for (uint child = 0; child < count; child++) {
                uint bits = bits_to(first + child);
                if (bits > best) continue;
                mask |= 1u << child;
                if (bits < least) {
                    least = bits;
                    nearest = child;
                }
            }
            if (mask != 0) {
                if (group.y != 0) groups[min(waiting++, KD_TREE_MAX_DEPTH - 1)] = group;
                group = uvec2(first, mask & ~(1u << nearest));
                node = first + nearest;
                more = true;
            }
        }
        while (!more && (group.y != 0 || waiting > 0)) {
            if (group.y == 0) group = groups[min(--waiting, KD_TREE_MAX_DEPTH - 1)];
            node = group.x + uint(findLSB(group.y));
            group.y &= group.y - 1;
            more = bits_to(node) <= best;
        }
    }
}

void main() {
    uint i = push.first + thread();
    uint count = min(push.query_count[0].at, push.query_count[1].at);
    if (i == 0) push.result_count[0].at = count;
    if (i >= count) return;
    uint index = ORDERED != 0 ? push.order[i].at : i;
    if (index >= push.capacity) return;
    nodes = push.nodes;
    positions = push.positions;
    min_cosine = push.min_cosine;
    at = push.queries[index].at.position;
    normal = push.queries[index].at.normal;
    precise float radius = push.queries[index].at.radius * push.radius;
    precise float squared_radius = radius * radius;
    best = floatBitsToUint(squared_radius);
    nearest_slot = NONE;
    bool sound = !is_nan(squared_radius) && !is_nan(at.x) && !is_nan(at.y) && !is_nan(at.z);
    if (push.points > 0 && sound) {
        walk();
    }
    // Minimum squared radius that an estimate divides by: (2^-20 of the scene) squared.
    float reach = uintBitsToFloat(best);
    vec3 flux = vec3(0.0);
    if (nearest_slot != NONE) flux = uintBitsToFloat(flux_at(FORMAT, push.power, nearest_slot).xyz);
    push.results[index].at = Estimate(flux, max(reach, NEIGHBOUR_MIN_RADIUS_SQUARED), nearest_slot != NONE ? 1u : 0u,
        reach < NEIGHBOUR_MIN_RADIUS_SQUARED ? ESTIMATE_SINGULAR : 0u, vec2(0.0));
}

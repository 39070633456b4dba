// A photon map as searches see it, what they are asked, and how queries are shared out.
//
// A tile is as many queries as a subgroup has invocations, one to each; the subgroup walks the tree
// once for all of them, and is done: several tiles in sequence could learn from each other, but where
// photons lie densely the last subgroups then kept everybody waiting.
#ifndef SEARCH_MAP_GLSL
#define SEARCH_MAP_GLSL

#include "device/grid.glsl"
#include "shading/photon_format.glsl"
#include "shading/layout.glsl"
#include "search/map_nodes.glsl"

// Subgroups of a workgroup that have shared memory; any more stand idle.
layout(constant_id = 2) const uint TILES = 4;

// Points of two leaves.
const uint TILE_POINTS = 32;

// Calls f(p) for eight places from `place` on. Written out, since a loop's turn costs as much as a point.
#define EIGHT(f, place) \
    f((place)); f((place) + 1); f((place) + 2); f((place) + 3); \
    f((place) + 4); f((place) + 5); f((place) + 6); f((place) + 7)

layout(push_constant, scalar) uniform Push {
    BoxNodes nodes;
    Words totals;
    Slots positions;
    Fluxes power;
    Words ids;
    Queries queries;
    Words query_count;
    // Estimates, rows of keys, or words: as the kernel says.
    uvec2 results;
    Words result_count;
    // Number of each query in the order in which they are taken.
    Words order;
    // Where walks that pause are written down: search_pause.glsl.
    Words pauses;
    // Points in the map.
    uint points;
    // Queries of this dispatch begin here and end there.
    uint first;
    uint end;
    uint k;
    // Of k-NN rows and counts: the radius; otherwise a factor on each query's.
    float radius;
    float min_cosine;
    // The cone's slope, or the paper's factor.
    float parameter;
    uint threshold;
    // Results that fit.
    uint capacity;
    // Of photons from a query's plane, in radii.
    float max_plane_distance;
} push;

// How much the map keeps of a photon.
layout(constant_id = 9) const uint FORMAT = FORMAT_FULL;

// Whether queries are taken in the order of `push.order`.
layout(constant_id = 3) const uint ORDERED = 0;

// The subgroup's number among those of the dispatch.
uint tile_number() {
    return workgroup() * min(gl_NumSubgroups, TILES) + gl_SubgroupID;
}

// Whether this subgroup has queries: its own are those from x on, before y.
bool own_queries(out uvec2 own) {
    uint end = min(min(push.end, push.query_count[0].at), push.query_count[1].at);
    uint begin = push.first + tile_number() * gl_SubgroupSize;
    own = uvec2(begin, min(end, begin + gl_SubgroupSize));
    return gl_SubgroupID < TILES && begin < end;
}

#endif

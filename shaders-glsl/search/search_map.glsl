// A photon map for searches, the parameters of searches, and the assignment of queries to invocations.
//
// A tile has as many queries as a subgroup has invocations, one for each; the subgroup traverses the tree once
// for all of them. It processes only one tile: several tiles in sequence could reuse information, but where
// photons are dense, all others waited for the last subgroups.
#ifndef SEARCH_MAP_GLSL
#define SEARCH_MAP_GLSL

#include "device/grid.glsl"
#include "shading/photon_format.glsl"
#include "shading/layout.glsl"
#include "search/map_nodes.glsl"

// Subgroups per workgroup for which shared memory is allocated; any more are idle.
layout(constant_id = 2) const uint TILES = 4;

// Points of two leaves.
const uint TILE_POINTS = 32;

// Calls f(p) for eight positions from `place` on. Unrolled by hand, since a loop iteration costs as much as a
// point.
#define EIGHT(f, place) \
    f((place)); f((place) + 1); f((place) + 2); f((place) + 3); \
    f((place) + 4); f((place) + 5); f((place) + 6); f((place) + 7)

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    BoxNodes nodes;
    Words totals;
    Slots positions;
    Fluxes power;
    Words ids;
    // Where `ErrorMoments` are written with each estimate, if at all.
    ErrorMomentsBuffer error_moments;
    Queries queries;
    Words query_count;
    // Estimates, rows of keys, or words, depending on the kernel.
    uvec2 results;
    Words result_count;
    // Query indices in processing order.
    Words order;
    // Saved state of paused traversals: search_pause.glsl.
    Words pauses;
    // With reflections: the table of albedos, `Albedos`. Along segments: the scene, `SceneRef`.
    uvec2 albedos;
    // Number of points in the map.
    uint points;
    // Range of queries of this dispatch.
    uint first;
    uint end;
    uint k;
    // For k-NN rows and counts: the radius; otherwise a factor on each query's radius.
    float radius;
    float min_cosine;
    // Factor of the paper's filter.
    float parameter;
    // Of the paper's estimate: the minimum number of photons.
    uint threshold;
    // Capacity of the results.
    uint capacity;
    // Maximum distance of photons from a query's plane, in radii.
    float max_plane_distance;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Which parts of a photon the map stores.
layout(constant_id = 9) const uint FORMAT = FORMAT_FULL;

// Whether queries are processed in the order of `push.order`.
layout(constant_id = 3) const uint ORDERED = 0;

// Index of the subgroup within the dispatch.
uint tile_number() {
    return workgroup() * min(gl_NumSubgroups, TILES) + gl_SubgroupID;
}

// Whether this subgroup has queries: those in [x, y).
bool own_queries(out uvec2 own) {
    uint end = min(min(push.end, push.query_count[0].at), push.query_count[1].at);
    uint begin = push.first + tile_number() * gl_SubgroupSize;
    own = uvec2(begin, min(end, begin + gl_SubgroupSize));
    return gl_SubgroupID < TILES && begin < end;
}

#endif

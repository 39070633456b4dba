// Adds up what the rays of each query found in one photon map. One invocation per query.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "grid.glsl"
#include "layout.glsl"
#include "two_float.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Values { vec3 at; };

layout(push_constant, scalar) uniform Push {
    Queries landings;
    Estimates estimates;
    Values values;
    uint count_rays;
    uint start_query;
    uint count_queries;
    // 1 over π times the paths times the rays of a query.
    float scale;
} push;

void main() {
    uint local = thread();
    if (local >= push.count_queries) return;
    Values value = push.values + (push.start_query + local);
    vec3 sum = value.at;
    vec3 low = vec3(0.0);
    for (uint ray = 0; ray < push.count_rays; ray++) {
        uint i = local * push.count_rays + ray;
        if (push.estimates[i].at.photons == 0) continue;
        float density = push.scale / push.estimates[i].at.radius_squared;
        two_add(sum, low, push.landings[i].at.weight * (push.estimates[i].at.flux * density));
    }
    value.at = sum;
}

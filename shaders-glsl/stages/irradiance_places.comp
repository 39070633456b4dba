// Queries at every n-th photon, in map order. Twin of backend-cpu's irradiance.rs.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "shading/layout.glsl"
#include "search/map_nodes.glsl"
#include "shading/octahedral.glsl"

layout(push_constant, scalar) uniform Push {
    Slots positions;
    Queries queries;
    // Number of queries already written; number of queries to write.
    uint first;
    uint count;
    uint every;
} push;

void main() {
    uint i = thread();
    if (i >= push.count) return;
    uvec4 point = push.positions[i * push.every].at;
    uint place = push.first + i;
    push.queries[place].at = Query(
        uintBitsToFloat(point.xyz), 1.0, octahedral_unpack(point.w), 0u, vec3(0.0), 0u, 0u, place, 0u, 0u);
}

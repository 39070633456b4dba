// Queries at a sample of the photons, evenly spaced in the order in which they were stored.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "shading/layout.glsl"
#include "search/map_records.glsl"
#include "shading/octahedral.glsl"

layout(push_constant, scalar) uniform Push {
    PhotonRows photons;
    Queries queries;
    uint points;
    uint count;
    float radius;
} push;

void main() {
    uint i = thread();
    if (i >= push.count) return;
    uvec4 place = photon_place(push.photons, uint(uint64_t(i) * push.points / push.count));
    push.queries[i].at = Query(uintBitsToFloat(place.xyz), push.radius, octahedral_unpack(place.w), i, vec3(0.0), 0u, 0u,
        i, 0u, 0u);
}

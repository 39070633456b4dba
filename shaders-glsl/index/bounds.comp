// The bounding box of all photons, and the first photon that is not finite.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "index/group_box.glsl"
#include "search/map_records.glsl"

layout(local_size_x_id = 1) in;

layout(push_constant, scalar) uniform Push {
    PhotonRows photons;
    MapState state;
    PhotonCount photon_count;
    uint count;
    // Number of invocations in the dispatch.
    uint stride;
} push;

bool finite3(uvec3 bits) {
    return finite_bits(bits.x) && finite_bits(bits.y) && finite_bits(bits.z);
}

void main() {
    uvec3 least = uvec3(0xffffffffu);
    uvec3 most = uvec3(0);
    for (uint i = thread(); i < push.count; i += push.stride) {
        uvec3 position = photon_position(push.photons, i);
        if (!finite3(position)) atomicMax(push.photon_count.bad_position, ~i);
        if (!finite3(photon_flux(push.photons, push.photon_count.capacity, i).xyz)) atomicMax(push.photon_count.bad_power, ~i);
        uvec3 key = ordered3(position);
        least = min(least, key);
        most = max(most, key);
    }
    group_box(least, most);
    if (gl_LocalInvocationIndex < 3) {
        atomicMin(push.state.low[gl_LocalInvocationIndex], least[gl_LocalInvocationIndex]);
        atomicMax(push.state.high[gl_LocalInvocationIndex], most[gl_LocalInvocationIndex]);
    }
}

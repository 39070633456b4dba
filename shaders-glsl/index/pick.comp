// Gathers photons by index into a buffer of full records.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "search/map_records.glsl"
#include "device/words.glsl"

layout(local_size_x_id = 1) in;

layout(push_constant, scalar) uniform Push {
    PhotonRows photons;
    Words ids;
    // Two rows per photon.
    Rows picked;
    uint count;
    // Capacity of the source buffer.
    uint capacity;
} push;

void main() {
    uint i = thread();
    if (i >= push.count) return;
    uint id = push.ids[i].word;
    push.picked[2 * i].row = photon_place(push.photons, id);
    push.picked[2 * i + 1].row = photon_flux(push.photons, push.capacity, id);
}

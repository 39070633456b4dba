// Photons by their numbers, as a set of their own, of whole records.
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
    // Two rows for each.
    Rows picked;
    uint count;
    // Photons that fit where they come from.
    uint capacity;
} push;

void main() {
    uint i = thread();
    if (i >= push.count) return;
    uint id = push.ids[i].word;
    push.picked[2 * i].row = photon_place(push.photons, id);
    push.picked[2 * i + 1].row = photon_flux(push.photons, push.capacity, id);
}

// Copies photons, stored in any order, into the order of their paths and bounces, in the format of their map.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;
// Photon format of each map, on surfaces and in media, two bits each.
layout(constant_id = 2) const uint FORMAT = 2730;

#include "shading/constants.glsl"
#include "device/grid.glsl"
#include "shading/photon_format.glsl"
#include "shading/layout.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Places { uvec4 row; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Owners { uvec2 at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Offsets { uint at; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Cursors { uint place; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Fill {
    uint needed;
    uint capacity;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Photons photons;
    Owners owners;
    // An array of `count` words for each map: number of photons before those of each path.
    Offsets offsets;
    Cursors cursors;
    Photons to[2 * MAP_COUNT];
    Fill fills[2 * MAP_COUNT];
    uint count;
    uint places;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    uint stored = min(push.cursors.place, push.places);
    uint threads = gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_WorkGroupSize.x;
    for (uint i = thread(); i < stored; i += threads) {
        uvec2 owner = push.owners[i].at;
        uint map = owner.y & (1u << MAP_BITS) - 1u;
        Fill fill = push.fills[map];
        Photons to = push.to[map];
        uint place = fill.needed + push.offsets[map * push.count + owner.x].at + (owner.y >> MAP_BITS);
        // Photons beyond the capacity are counted but not stored; the pass is then repeated.
        if (place >= fill.capacity) continue;
        Photon photon = push.photons[i].at;
        uint format = FORMAT >> 2u * map & 3u;
        if (format == FORMAT_FULL) {
            to[place].at = photon;
        } else {
            Places(to)[place].row = uvec4(floatBitsToUint(photon.position), photon.normal);
            uvec4 flux = uvec4(floatBitsToUint(photon.power), photon.direction);
            flux_put(format, Fluxes(Places(to) + fill.capacity), place, flux);
        }
    }
}

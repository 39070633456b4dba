// Copies photons into slot order and builds the leaves, of sixteen slots each.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "search/map_records.glsl"
#include "device/words.glsl"

layout(local_size_x_id = 1) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    PhotonRows photons;
    // Photon index by slot.
    Words order;
    Rows positions;
    Fluxes power;
    Words ids;
    // Address of the first leaf.
    BoxNodes nodes;
    Words totals;
    uint count;
    // Capacity of the photon buffer.
    uint capacity;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Coordinates as ordered integers; padded by a word per leaf to avoid bank conflicts.
shared uint keys[3][gl_WorkGroupSize.x / 16 * 17];

void main() {
    uint slot = thread();
    uint local = gl_LocalInvocationIndex;
    if (slot < push.count) {
        uint id = push.order[slot].word;
        uvec3 position = photon_position(push.photons, id);
        push.positions[slot].row = uvec4(position, photon_place(push.photons, id).w);
        flux_put(FORMAT, push.power, slot, photon_flux(push.photons, push.capacity, id));
        push.ids[slot].word = id;
        uvec3 key = ordered3(position);
        for (uint axis = 0; axis < 3; axis++) keys[axis][local / 16 * 17 + local % 16] = key[axis];
    }
    barrier();
    if (local * 16 >= gl_WorkGroupSize.x) return;
    uint first = workgroup() * gl_WorkGroupSize.x + local * 16;
    if (first >= push.count) return;
    uint size = min(push.count - first, 16);
    uvec3 low = uvec3(0xffffffffu);
    uvec3 high = uvec3(0);
    for (uint i = 0; i < size; i++) {
        uint at = local * 17 + i;
        uvec3 key = uvec3(keys[0][at], keys[1][at], keys[2][at]);
        low = min(low, key);
        high = max(high, key);
    }
    uint leaf = first / 16;
    push.nodes[leaf].low = uvec4(from_ordered3(low), first);
    push.nodes[leaf].high = uvec4(from_ordered3(high), size | KD_TREE_LEAF);
    push.totals[leaf].word = size;
}

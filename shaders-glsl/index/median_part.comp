// One level of the median tree, third of three kernels: partitions every segment of every list.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "search/list_part.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Words lists;
    Words parted;
    // Number of photons that go left, by list, then by tile.
    Words counts;
    uint count;
    uint tiles;
    uint size;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    if (workgroup() >= 3 * push.tiles) return;
    uint offset = workgroup() / push.tiles * push.count;
    uint tile = workgroup() % push.tiles;
    uint base = tile * LIST_TILE;
    uint first = base / push.size * push.size;
    uint skipped = workgroup() - (base - first) / LIST_TILE;
    uint before = list_before(push.counts, skipped, workgroup());
    uint end = min(base + LIST_TILE, push.count);
    // In segments that are not split, no photon goes right.
    uint next_right = first + push.size / 2 + (base - first) - before;
    list_part(push.lists + offset, push.parted + offset, base, end, first + before, next_right);
}

// One level of a regular tree: each node has sixteen consecutive children on the level below.
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
    BoxNodes nodes;
    Words totals;
    // First node of this level, and of the one below.
    uint first;
    uint count;
    uint first_below;
    uint count_below;
} push;

void main() {
    uint number = thread();
    if (number >= push.count) return;
    uint child = push.first_below + number * KD_TREE_WIDTH;
    uint size = min(push.count_below - number * KD_TREE_WIDTH, KD_TREE_WIDTH);
    uvec3 low = uvec3(0xffffffffu);
    uvec3 high = uvec3(0);
    uint total = 0;
    for (uint i = 0; i < size; i++) {
        low = min(low, ordered3(push.nodes[child + i].low.xyz));
        high = max(high, ordered3(push.nodes[child + i].high.xyz));
        total += push.totals[child + i].word;
    }
    push.nodes[push.first + number].low = uvec4(from_ordered3(low), child);
    push.nodes[push.first + number].high = uvec4(from_ordered3(high), size);
    push.totals[push.first + number].word = total;
}

// Bounding boxes of one level of nodes of the VVH tree, from those of their children.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "search/map_records.glsl"
#include "index/vvh_nodes.glsl"
#include "device/words.glsl"

layout(local_size_x_id = 1) in;

layout(push_constant, scalar) uniform Push {
    VvhDepth depth;
    VvhNodes pending;
    BoxNodes nodes;
    Words totals;
} push;

void main() {
    uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint at = gl_GlobalInvocationID.x; at < push.depth.count; at += stride) {
        uint number = push.pending[push.depth.first + at].number;
        uint first = push.nodes[number].low.w;
        uint count = push.nodes[number].high.w;
        // A tree that consists of one leaf.
        if ((count & KD_TREE_LEAF) != 0) return;
        uvec3 low = uvec3(0xffffffffu);
        uvec3 high = uvec3(0);
        uint total = 0;
        for (uint child = first; child < first + count; child++) {
            low = min(low, ordered3(push.nodes[child].low.xyz));
            high = max(high, ordered3(push.nodes[child].high.xyz));
            total += push.totals[child].word;
        }
        push.nodes[number].low = uvec4(from_ordered3(low), first);
        push.nodes[number].high = uvec4(from_ordered3(high), count);
        push.totals[number].word = total;
    }
}

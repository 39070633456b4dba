// One level of nodes of the VVH tree: collapses the splits of the binary tree into nodes of up to sixteen
// children, by opening the largest child until there are sixteen.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "search/map_records.glsl"
#include "index/vvh_nodes.glsl"
#include "device/words.glsl"

layout(local_size_x_id = 1) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    VvhDepth depth;
    VvhDepth next_depth;
    VvhNodes pending;
    Words splits;
    // By block: its box and number of photons.
    BoxNodes leaves;
    BoxNodes nodes;
    Words totals;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void leaf(uint number, uint block) {
    push.nodes[number].low = push.leaves[block].low;
    push.nodes[number].high = push.leaves[block].high;
    push.totals[number].word = push.leaves[block].high.w & ~KD_TREE_LEAF;
}

void main() {
    uint next = push.depth.first + push.depth.count;
    if (gl_GlobalInvocationID.x == 0) push.next_depth.first = next;
    uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint at = gl_GlobalInvocationID.x; at < push.depth.count; at += stride) {
        uint own = push.depth.first + at;
        uint number = push.pending[own].number;
        uint below = push.pending[own].below;
        uvec3 children[KD_TREE_WIDTH];
        children[0] = uvec3(push.pending[own].first, push.pending[own].blocks, push.pending[own].splits);
        if (children[0].y == 1) {
            leaf(number, children[0].x);
            continue;
        }
        uint count = 1;
        while (count < KD_TREE_WIDTH) {
            uint largest = 0;
            for (uint child = 1; child < count; child++) {
                if (children[child].y > children[largest].y) largest = child;
            }
            uvec3 parent = children[largest];
            if (parent.y == 1) break;
            uint left = push.splits[parent.z].word;
            for (uint child = count; child > largest + 1; child--) children[child] = children[child - 1];
            children[largest] = uvec3(parent.x, left, parent.z + 1);
            children[largest + 1] = uvec3(parent.x + left, parent.y - left, parent.z + left);
            count++;
        }
        // The boxes are computed later, bottom-up.
        push.nodes[number].low.w = below;
        push.nodes[number].high.w = count;
        uint further = below + count;
        for (uint child = 0; child < count; child++) {
            if (children[child].y == 1) {
                leaf(below + child, children[child].x);
                continue;
            }
            uint place = atomicAdd(push.next_depth.count, 1);
            atomicMax(push.next_depth.groups[0], min(place / gl_WorkGroupSize.x + 1, 4096));
            uint to = next + place;
            push.pending[to].number = below + child;
            push.pending[to].first = children[child].x;
            push.pending[to].blocks = children[child].y;
            push.pending[to].splits = children[child].z;
            push.pending[to].below = further;
            further += 2 * children[child].y - 2;
        }
    }
}

// Prefix sums by one workgroup: of a short input, or of the sums of the tiles of a long one.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "scan/scan_tile.glsl"

layout(local_size_x_id = 1) in;

layout(push_constant, scalar) uniform Push {
    Words from;
    Words to;
    Words total;
    uint count;
    uint has_total;
} push;

void main() {
    uint carry = 0;
    uint tile = gl_WorkGroupSize.x * SCAN_ITEMS;
    for (uint base = 0; base < push.count; base += tile) {
        carry += scan_tile(push.from, push.to, base, push.count, carry);
    }
    if (push.has_total != 0 && group_rank() == 0) push.total.word = carry;
}

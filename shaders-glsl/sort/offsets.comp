// Radix sort, second of three kernels per digit: prefix sums over tiles of each digit's counts, one workgroup
// per digit; of few tiles, one invocation per digit.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "scan/scan_tile.glsl"

layout(push_constant, scalar) uniform Push {
    Words counts;
    // By digit.
    Words totals;
    uint tiles;
    // Whether an invocation has a digit of its own.
    uint alone;
} push;

void sum_alone() {
    uint digit = thread();
    if (digit >= SORT_DIGITS) return;
    Words own = push.counts + digit * push.tiles;
    uint sum = 0;
    for (uint tile = 0; tile < push.tiles; tile++) {
        uint count = own[tile].word;
        own[tile].word = sum;
        sum += count;
    }
    push.totals[digit].word = sum;
}

void main() {
    if (push.alone != 0) {
        sum_alone();
        return;
    }
    uint digit = workgroup();
    if (digit >= SORT_DIGITS) return;
    Words own = push.counts + digit * push.tiles;
    uint carry = 0;
    for (uint base = 0; base < push.tiles; base += gl_WorkGroupSize.x * SCAN_ITEMS) {
        carry += scan_tile(own, own, base, push.tiles, carry);
    }
    if (group_rank() == 0) push.totals[digit].word = carry;
}

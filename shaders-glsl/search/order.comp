// Sorts rows of keys (bits of d², id), nearest first, and writes their ids, with Batcher's bitonic network
// (1968): in shared memory, as many rows per workgroup as fit; or one row per workgroup in global memory, if a
// row does not fit.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "device/grid.glsl"

// Number of keys that fit in shared memory: a power of two.
layout(constant_id = 2) const uint ROOM = 512;
// Whether queries were processed in the order of `push.order`.
layout(constant_id = 3) const uint ORDERED = 0;

layout(buffer_reference, scalar, buffer_reference_align = 8) coherent buffer Rows { uvec2 key; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Rows rows;
    Words ids;
    Words order;
    // Number of queries before that of the first row.
    uint first;
    uint count;
    uint k;
    // The smallest power of two not below k.
    uint room;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

shared uvec2 keys[ROOM];

bool greater(uvec2 a, uvec2 b) {
    return a.x > b.x || (a.x == b.x && a.y > b.y);
}

void main() {
    uint local = gl_LocalInvocationIndex;
    bool in_shared = push.room <= ROOM;
    uint own = in_shared ? ROOM / push.room : 1;
    uint row = workgroup() * own;
    // Uniform in the workgroup.
    if (row >= push.count) return;
    own = min(own, push.count - row);
    uint all = own * push.room;
    Rows rows = push.rows + row * push.k;
    if (in_shared) {
        for (uint i = local; i < all; i += gl_WorkGroupSize.x) {
            uint column = i & (push.room - 1);
            keys[i] = column < push.k ? rows[i / push.room * push.k + column].key : uvec2(0xFFFFFFFFu);
        }
    }
    barrier();
    for (uint size = 2; size <= push.room; size <<= 1) {
        for (uint stride = size >> 1; stride > 0; stride >>= 1) {
            for (uint pair = local; pair < all / 2; pair += gl_WorkGroupSize.x) {
                uint low = 2 * pair - (pair & (stride - 1));
                // The first step of each size compares mirrored elements, so that all comparisons are
                // ascending, and elements past the end of a row can be treated as greater than all others.
                uint base = low & ~(size - 1);
                bool mirror = stride == size >> 1;
                uint high = mirror ? base + size - 1 - (low - base) : low + stride;
                if (in_shared) {
                    uvec2 a = keys[low], b = keys[high];
                    if (greater(a, b)) {
                        keys[low] = b;
                        keys[high] = a;
                    }
                } else if (high < push.k) {
                    uvec2 a = rows[low].key, b = rows[high].key;
                    if (greater(a, b)) {
                        rows[low].key = b;
                        rows[high].key = a;
                    }
                }
            }
            if (!in_shared) memoryBarrierBuffer();
            barrier();
        }
    }
    for (uint i = local; i < own * push.k; i += gl_WorkGroupSize.x) {
        uint id = in_shared ? keys[i / push.k * push.room + i % push.k].y : rows[i].key.y;
        uint query = push.first + row + i / push.k;
        if (ORDERED != 0) query = push.order[query].at;
        push.ids[query * push.k + i % push.k].at = id;
    }
}

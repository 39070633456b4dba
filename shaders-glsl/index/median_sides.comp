// One level of the median tree, first of three kernels: marks the photons that go right. All segments begin at
// multiples of one size; those longer than half of it are split there.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "search/lists.glsl"

layout(local_size_x_id = 1) in;

layout(push_constant, scalar) uniform Push {
    PhotonRows photons;
    Words lists;
    // One bit per photon, initially zero.
    Words right;
    uint count;
    uint size;
} push;

void main() {
    uint base = workgroup() * LIST_TILE;
    if (base >= push.count) return;
    uint first = base / push.size * push.size;
    uint length = min(push.size, push.count - first);
    uint left = push.size / 2;
    uint end = min(base + LIST_TILE, push.count);
    if (length <= left || end <= first + left) return;
    uvec3 low, high;
    list_box(push.photons, push.lists, push.count, first, length, low, high);
    uint extent;
    Words list = push.lists + longest_axis(low, high, extent) * push.count;
    for (uint at = max(base, first + left) + gl_LocalInvocationIndex; at < end; at += gl_WorkGroupSize.x) {
        uint photon = list[at].word;
        atomicOr(push.right[photon / 32].word, 1u << photon % 32);
    }
}

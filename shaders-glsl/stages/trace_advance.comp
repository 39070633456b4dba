// Updates the number of photons after they were appended.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require

layout(local_size_x_id = 1) in;
layout(constant_id = 3) const uint WANTED = 7;

#include "shading/constants.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Word { uint at; };

layout(push_constant, scalar) uniform Push {
    Word totals;
    Word needed[MAP_COUNT];
} push;

void main() {
    uint map = gl_LocalInvocationID.x;
    if (map >= MAP_COUNT || (WANTED >> map & 1u) == 0u) return;
    // With constant indices, since some drivers do not support others for push constants.
    Word needed = push.needed[0];
    [[unroll]] for (uint m = 1u; m < MAP_COUNT; ++m) {
        if (map == m) needed = push.needed[m];
    }
    needed.at += push.totals[map].at;
}

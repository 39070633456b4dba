// Updates the number of photons after they were appended.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;
layout(constant_id = 3) const uint WANTED = 7;

#include "shading/constants.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Word { uint at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Word totals;
    Word needed[2 * MAP_COUNT];
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    uint map = gl_LocalInvocationID.x;
    if (map >= 2 * MAP_COUNT || (WANTED >> map & 1u) == 0u) return;
    push.needed[map].at += push.totals[map].at;
}

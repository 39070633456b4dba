// After photons were appended: how many there are now.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;
layout(constant_id = 3) const uint WANTED = 7;

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Word { uint at; };

layout(push_constant, scalar) uniform Push {
    Word totals;
    Word needed[3];
} push;

void main() {
    uint map = gl_LocalInvocationID.x;
    if (map >= 3u || (WANTED >> map & 1u) == 0u) return;
    Word needed = map == 0u ? push.needed[0] : map == 1u ? push.needed[1] : push.needed[2];
    needed.at += push.totals[map].at;
}

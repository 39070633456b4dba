// Finds, among sorted Morton codes, the runs of one code that are longer than a leaf.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "grid.glsl"
#include "runs.glsl"

layout(local_size_x_id = 1) in;

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Codes { uvec2 code; };

layout(push_constant, scalar) uniform Push {
    Codes codes;
    Round round;
    Runs runs;
    uint count;
} push;

void main() {
    uint i = thread();
    if (i >= push.count || push.count - i <= 16) return;
    uvec2 code = push.codes[i].code;
    if (push.codes[i + 16].code != code || (i > 0 && push.codes[i - 1].code == code)) return;
    // The first place with another code, by doubling, then by halving.
    uint inside = i + 16;
    uint step = 16;
    while (push.count - inside > step && push.codes[inside + step].code == code) {
        inside += step;
        step *= 2;
    }
    uint outside = push.count - inside > step ? inside + step : push.count;
    while (outside - inside > 1) {
        uint middle = inside + (outside - inside) / 2;
        if (push.codes[middle].code == code) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    add_run(push.round, push.runs, i, outside - i);
}

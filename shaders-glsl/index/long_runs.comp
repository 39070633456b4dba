// Finds, among sorted Morton codes, the runs of equal codes that are longer than a leaf.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "index/runs.glsl"
#include "device/words.glsl"

layout(local_size_x_id = 1) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    // Photon index by slot, and the higher words of the codes in that order.
    Words order;
    Words sorted_high;
    // The lower words by photon index.
    Words low;
    Round round;
    Runs runs;
    uint count;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Whether two slots have the same code.
bool same_code(uint a, uint b) {
    return push.sorted_high[a].word == push.sorted_high[b].word
        && push.low[push.order[a].word].word == push.low[push.order[b].word].word;
}

void main() {
    uint i = thread();
    if (i >= push.count || push.count - i <= 16) return;
    if (!same_code(i, i + 16) || (i > 0 && same_code(i, i - 1))) return;
    // The first slot with another code, by exponential and then binary search.
    uint inside = i + 16;
    uint step = 16;
    while (push.count - inside > step && same_code(i, inside + step)) {
        inside += step;
        step *= 2;
    }
    uint outside = push.count - inside > step ? inside + step : push.count;
    while (outside - inside > 1) {
        uint middle = inside + (outside - inside) / 2;
        if (same_code(i, middle)) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    add_run(push.round, push.runs, i, outside - i);
}

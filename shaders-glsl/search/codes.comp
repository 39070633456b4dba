// A 24-bit Morton code for every query, within the bounding box of a map: queries close to each other read the
// same photons.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "shading/layout.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer BoxNodes {
    vec3 low;
    uint first;
    vec3 high;
    uint count;
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    BoxNodes nodes;
    Queries queries;
    Words query_count;
    Words codes;
    // Number of codes to write: those of queries, then padding that sorts last.
    uint count;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Inserts two zeros after each of eight bits.
uint spread_bits(uint bits) {
    bits = (bits | bits << 8) & 0x00F00Fu;
    bits = (bits | bits << 4) & 0x0C30C3u;
    return (bits | bits << 2) & 0x249249u;
}

void main() {
    uint i = thread();
    if (i >= push.count) return;
    uint code = 0xFFFFFFu;
    if (i < min(push.query_count[0].at, push.query_count[1].at)) {
        vec3 low = push.nodes.low;
        vec3 size = push.nodes.high - low;
        vec3 scale = 255.99 / max(size, vec3(1.0e-30));
        vec3 cell = (push.queries[i].at.position - low) * scale;
        // Non-finite positions are clamped to a bound.
        cell = clamp(cell, vec3(0.0), vec3(255.0));
        code = spread_bits(uint(cell.x)) | spread_bits(uint(cell.y)) << 1 | spread_bits(uint(cell.z)) << 2;
    }
    push.codes[i].at = code & 0xFFFFFFu;
}

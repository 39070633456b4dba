// Queries close ranks: from a fixed number of places for each pixel to one after another, in order of
// pixel, then as they were found. One invocation per place.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

// Places of a pixel, in powers of two.
layout(constant_id = 2) const uint PLACES_LOG2 = 2;

#include "grid.glsl"
#include "layout.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint at; };

layout(push_constant, scalar) uniform Push {
    Queries found;
    Words counts;
    // How many stand before each pixel of this dispatch, and in it altogether.
    Words offsets;
    Words total;
    // How many stand before this dispatch; the next word is for the one after it.
    Words before;
    Queries queries;
    uint capacity;
    uint pixels;
} push;

void main() {
    uint place = thread();
    if (place == 0) push.before[1].at = push.before[0].at + push.total.at;
    uint pixel = place >> PLACES_LOG2;
    if (pixel >= push.pixels) return;
    uint ordinal = place & ((1u << PLACES_LOG2) - 1);
    if (ordinal >= push.counts[pixel].at) return;
    uint to = push.before[0].at + push.offsets[pixel].at + ordinal;
    if (to < push.capacity) push.queries[to].at = push.found[place].at;
}

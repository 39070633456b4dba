// Compacts queries: from a fixed number of slots per pixel to consecutive elements, in pixel order, then in the
// order in which they were found. One invocation per slot.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

// Log2 of the number of slots per pixel.
layout(constant_id = 2) const uint PLACES_LOG2 = 2;

#include "device/grid.glsl"
#include "shading/layout.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Words { uint at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    // As the camera pass stored them.
    Queries found;
    Words counts;
    // Number of queries before each pixel.
    Words offsets;
    // Destination of the first query of pixel `start`.
    Queries to;
    uint capacity;
    uint start;
    uint count;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    uint place = thread();
    uint pixel = push.start + (place >> PLACES_LOG2);
    if (place >> PLACES_LOG2 >= push.count) return;
    uint ordinal = place & ((1u << PLACES_LOG2) - 1);
    if (ordinal >= push.counts[pixel].at) return;
    uint to = push.offsets[pixel].at - push.offsets[push.start].at + ordinal;
    if (to < push.capacity) push.to[to].at = push.found[(pixel << PLACES_LOG2) + ordinal].at;
}

// Adds the error statistics of the current pass to the sums and clears them. One invocation per pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
layout(local_size_x_id = 1) in;

// Bit mask of the maps that exist.
layout(constant_id = 2) const uint MAPS = 7;

#include "shading/constants.glsl"
#include "film/film.glsl"
#include "device/grid.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Planes pass;
    Planes sum;
    Planes pass_shapes[MAP_COUNT];
    Planes sum_shapes[MAP_COUNT];
    uint pixels;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Returns a number of the current pass and clears it.
float take(Planes planes, uint plane, uint pixel) {
    Planes place = film_place(planes, plane, push.pixels, pixel);
    float x = place.at;
    if (x != 0.0) place.at = 0.0;
    return x;
}

void end_shape(uint map, uint pixel) {
    for (uint plane = 0; plane < MOMENTS_LOW; plane++) {
        float x = take(push.pass_shapes[map], plane, pixel);
        if (x != 0.0) film_add(push.sum_shapes[map], plane, MOMENTS_LOW, push.pixels, pixel, x);
    }
}

void end_number(uint plane, uint sum, uint square_sum, uint pixel) {
    float x = take(push.pass, plane, pixel);
    if (x == 0.0) return;
    float square, rest;
    two_square(x, 0.0, square, rest);
    film_add(push.sum, sum, ERROR_LOW, push.pixels, pixel, x);
    film_add(push.sum, square_sum, ERROR_LOW, push.pixels, pixel, square);
    film_add(push.sum, square_sum, ERROR_LOW, push.pixels, pixel, rest);
}

void main() {
    uint pixel = thread();
    if (pixel >= push.pixels) return;
    end_number(0, ERROR_BIAS, ERROR_BIAS_SQUARE, pixel);
    end_number(1, ERROR_NARROW, ERROR_NARROW_SQUARE, pixel);
    [[unroll]] for (uint map = 0u; map < MAP_COUNT; ++map) {
        if ((MAPS >> map & 1u) != 0u) end_shape(map, pixel);
    }
}

// Adds the current pass to the sums and clears it. One invocation per pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

// Bit mask of the layers that exist.
layout(constant_id = 2) const uint LAYERS = 15;

#include "film/film.glsl"
#include "device/grid.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Planes passes[4];
    Planes sums[4];
    FirstPass first_pass;
    Planes first_sum;
    uint pixels;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void add(Planes sums, uint plane, uint low, uint pixel, float x) {
    film_add(sums, plane, low, push.pixels, pixel, x);
}

// Adds one layer to its sums, and its radiance to the pixel's. Black pixels cause no memory traffic.
void end_layer(uint layer, uint pixel, inout float high, inout float low) {
    vec3 radiance;
    for (uint c = 0; c < 3; c++) radiance[c] = film_place(push.passes[layer], c, push.pixels, pixel).at;
    if (radiance == vec3(0.0)) return;
    for (uint c = 0; c < 3; c++) {
        film_place(push.passes[layer], c, push.pixels, pixel).at = 0.0;
        add(push.sums[layer], c, 3, pixel, radiance[c]);
        two_add(high, low, radiance[c]);
    }
}

void main() {
    uint pixel = thread();
    if (pixel >= push.pixels) return;
    float high = 0.0;
    float low = 0.0;
    if ((LAYERS & 1) != 0) end_layer(0, pixel, high, low);
    if ((LAYERS & 2) != 0) end_layer(1, pixel, high, low);
    if ((LAYERS & 4) != 0) end_layer(2, pixel, high, low);
    if ((LAYERS & 8) != 0) end_layer(3, pixel, high, low);
    if (high != 0.0) {
        // The square of the sum of the channels; the mean of the channels is a third of the sum, so that the
        // reader divides by 9.
        float square;
        float rest;
        two_square(high, low, square, rest);
        add(push.first_sum, FIRST_SQUARE, FIRST_LOW, pixel, square);
        add(push.first_sum, FIRST_SQUARE, FIRST_LOW, pixel, rest);
    }
    FirstPass pass = push.first_pass + pixel;
    uint hits = pass.hits;
    if (hits == 0) return;
    vec3 normal = pass.normal;
    vec3 albedo = pass.albedo;
    add(push.first_sum, FIRST_DEPTH, FIRST_LOW, pixel, pass.depth);
    for (uint axis = 0; axis < 3; axis++) {
        add(push.first_sum, FIRST_NORMAL + axis, FIRST_LOW, pixel, normal[axis]);
        add(push.first_sum, FIRST_ALBEDO + axis, FIRST_LOW, pixel, albedo[axis]);
    }
    Hits(film_place(push.first_sum, FIRST_HITS, push.pixels, pixel)).at += hits;
    pass.hits = 0;
}

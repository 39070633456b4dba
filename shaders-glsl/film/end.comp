// The present pass is added to the sums, and begins anew. One invocation per pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

// Bit by bit, the layers that there are.
layout(constant_id = 2) const uint LAYERS = 15;

#include "film.glsl"
#include "grid.glsl"
#include "two_float.glsl"

layout(push_constant, scalar) uniform Push {
    LayerPass passes[4];
    LayerSum sums[4];
    FirstPass first_pass;
    FirstSum first_sum;
    uint pixels;
} push;

// Adds one layer, and its radiance to that of the pixel.
void end_layer(uint layer, uint pixel, inout float high, inout float low) {
    LayerPass pass = push.passes[layer] + pixel;
    LayerSum sum = push.sums[layer] + pixel;
    vec3 radiance = pass.radiance;
    pass.radiance = vec3(0.0);
    vec3 sum_high = sum.high;
    vec3 sum_low = sum.low;
    two_add(sum_high, sum_low, radiance);
    sum.high = sum_high;
    sum.low = sum_low;
    for (int channel = 0; channel < 3; channel++) two_add(high, low, radiance[channel]);
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

    FirstPass pass = push.first_pass + pixel;
    FirstSum sum = push.first_sum + pixel;
    // The mean of the channels would be a third of it; its square, a ninth, is left to the reader.
    if (LAYERS != 0) {
        float square;
        float rest;
        two_square(high, low, square, rest);
        float square_high = sum.square;
        float square_low = sum.square_low;
        two_add(square_high, square_low, square);
        two_add(square_high, square_low, rest);
        sum.square = square_high;
        sum.square_low = square_low;
    }
    if (pass.hits == 0) return;
    vec3 normal = sum.normal;
    vec3 normal_low = sum.normal_low;
    two_add(normal, normal_low, pass.normal);
    vec3 albedo = sum.albedo;
    vec3 albedo_low = sum.albedo_low;
    two_add(albedo, albedo_low, pass.albedo);
    float depth = sum.depth;
    float depth_low = sum.depth_low;
    two_add(depth, depth_low, pass.depth);
    sum.normal = normal;
    sum.normal_low = normal_low;
    sum.albedo = albedo;
    sum.albedo_low = albedo_low;
    sum.depth = depth;
    sum.depth_low = depth_low;
    sum.hits += pass.hits;
    pass.hits = 0;
}

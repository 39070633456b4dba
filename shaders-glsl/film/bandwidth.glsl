// Radii of pixels from the noise and the bias of earlier passes. Twin of photon-core's bandwidth.rs, in f32. Three kernels, one
// invocation per pixel each: what the passes since the last update tell, the change of each pixel, and the factors.
#ifndef BANDWIDTH_GLSL
#define BANDWIDTH_GLSL

#include "shading/constants.glsl"
#include "shading/math.glsl"
#include "film/film.glsl"
#include "device/grid.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Factors { float at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    // Sums of all layers, and of the layer of each map.
    Planes sums[4];
    Planes lights[MAP_COUNT];
    Planes photon_moments[MAP_COUNT];
    Planes errors;
    Planes radii;
    // On the radius of each pixel.
    Factors factors;
    uint pixels;
    uint width;
    // Passes in the film, and since the last update.
    float passes;
    float since;
    // `RadiusUpdate::bias` and `RadiusUpdate::noise`.
    float bias;
    float noise;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Planes of `radii`: bias and its square at the last update, a high and a low part each; the squared mean of the bias since
// then, and the variance of that mean; the logarithm of the change of r².
const uint BEFORE_BIAS = 0u;
const uint BEFORE_BIAS_SQUARE = 2u;
const uint BIAS_SQUARED = 4u;
const uint BIAS_VARIANCE = 5u;
const uint CHANGE = 6u;

float radii_read(uint plane, uint pixel) {
    return film_place(push.radii, plane, push.pixels, pixel).at;
}

void radii_write(uint plane, uint pixel, float x) {
    film_place(push.radii, plane, push.pixels, pixel).at = x;
}

// A sum over passes, its high part.
float error_sum(uint plane, uint pixel) {
    return film_place(push.errors, plane, push.pixels, pixel).at;
}

#endif

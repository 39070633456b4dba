// The film: the current pass, and sums over passes. Values of one kind are stored pixel by pixel in planes, so
// that neighbouring invocations access neighbouring words.
#ifndef FILM_GLSL
#define FILM_GLSL

#include "device/constants.glsl"
#include "shading/two_float.glsl"

// The current pass of a layer: planes of red, green and blue radiance. Its sum over finished passes: three
// planes of high parts, then three of low parts.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Planes { float at; };

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Hits { uint at; };

// The first surface that the current pass saw; no hits if it saw none.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer FirstPass {
    vec3 normal;
    float depth;
    vec3 albedo;
    uint hits;
};

// The same, summed over finished passes, with the squares of their radiance: high parts in the planes FIRST_*,
// then as many planes of low parts, then one of hits, which are words.
//
// Error statistics of a pixel, summed over passes: high parts in the planes ERROR_*, then as many planes of low
// parts. The current pass: bias and narrow. The photon moments of one map around the pixel are stored in planes
// of their own, MOMENTS_*: the members of `ErrorMoments` from `power` on.

// Address of a pixel in a plane. Computed in steps, since planes times pixels may exceed a word.
Planes film_place(Planes planes, uint plane, uint pixels, uint pixel) {
    for (uint i = 0; i < plane; i++) planes = planes + pixels;
    return planes + pixel;
}

// Adds to one number's sum, whose low part is in the plane `low` planes further on.
void film_add(Planes sums, uint plane, uint low, uint pixels, uint pixel, float x) {
    Planes high_place = film_place(sums, plane, pixels, pixel);
    Planes low_place = film_place(sums, plane + low, pixels, pixel);
    float high = high_place.at;
    float rest = low_place.at;
    two_add(high, rest, x);
    high_place.at = high;
    low_place.at = rest;
}

#endif

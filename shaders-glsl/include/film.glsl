// The picture in progress, pixel by pixel: what the present pass has given, and sums over passes.
#ifndef FILM_GLSL
#define FILM_GLSL

// One layer of the present pass: radiance.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LayerPass { vec3 radiance; };

// One layer's sum over finished passes, in two floats each.
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer LayerSum {
    vec3 high;
    vec3 low;
};

// The first surface that the present pass saw; no hits if it saw none.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer FirstPass {
    vec3 normal;
    float depth;
    vec3 albedo;
    uint hits;
};

// The same, summed over finished passes, with the squares of their radiance.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer FirstSum {
    vec3 normal;
    float depth;
    vec3 normal_low;
    float depth_low;
    vec3 albedo;
    float square;
    vec3 albedo_low;
    float square_low;
    uint hits;
};

#endif

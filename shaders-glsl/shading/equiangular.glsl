// Places on a segment for light from a point. Twin of photon-core's equiangular.rs.
#ifndef EQUIANGULAR_GLSL
#define EQUIANGULAR_GLSL

#include "shading/math.glsl"

// Angles under which a point sees a segment.
struct Equiangular {
    // Distance of the point from the line.
    float height;
    // Position of the start of the segment relative to the foot of the point.
    float start;
    // Angle between both ends, in turns.
    float turns;
};

Equiangular equiangular_new(vec3 origin, vec3 direction, float end, vec3 point) {
    precise vec3 gap = point - origin;
    float foot = dot3(gap, direction);
    precise vec3 beside = gap - direction * foot;
    // A point on the line sees a line beside it.
    float height = max(sqrt(dot3(beside, beside)), 1e-6);
    float start = -foot;
    precise float across = height * end;
    precise float along = height * height + start * (start + end);
    return Equiangular(height, start, turns_of(across, along));
}

// Distance from the start of the segment for `u` in [0, 1).
float equiangular_sample(Equiangular angles, float u) {
    float height = angles.height, start = angles.start, turns = angles.turns;
    precise float turned = u * turns;
    vec2 sin_cos = sin_cos_turns(turned);
    precise float squared = height * height + start * start;
    precise float divisor = height * sin_cos.y - start * sin_cos.x;
    precise float far = sin_cos.x * squared / max(divisor, 1.17549435e-38);
    return max(far, 0.0);
}

// Density of a distance.
float equiangular_density(Equiangular angles, float far) {
    float height = angles.height, start = angles.start, turns = angles.turns;
    precise float along = start + far;
    precise float density = height / (6.2831855 * turns * (height * height + along * along));
    return density;
}

// Distance along a segment of length `end`, in proportion to the transmittance for the coefficient `extinction`.
float exponential_sample(float extinction, float end, float u) {
    precise float depth = extinction * end;
    float collides = one_minus_exp(depth);
    precise float even = u * end;
    precise float within = u * collides;
    precise float drawn = minus_ln_one_minus(within) / extinction;
    return collides > 1e-20 ? min(drawn, end) : even;
}

// Density of such a distance.
float exponential_density(float extinction, float end, float far) {
    precise float depth = extinction * end;
    precise float passed = extinction * far;
    float collides = one_minus_exp(depth);
    precise float density = extinction * exp_neg(passed) / collides;
    precise float even = 1.0 / end;
    return collides > 1e-20 ? density : even;
}

#endif

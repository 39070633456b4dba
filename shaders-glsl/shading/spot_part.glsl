// The part of a segment in the cone of a spot light. Twin of photon-core's spot_part.rs.
#ifndef SPOT_PART_GLSL
#define SPOT_PART_GLSL

#include "shading/math.glsl"

// Sine squared of the half angle, and part of it that the leading coefficient is, below which rounding decides what is inside;
// then the whole segment counts.
const float SPOT_NARROW = 1e-5;
// Rounding of the discriminant, relative to its terms, and room at both ends, relative to the part.
const float SPOT_ROUNDING = 1e-6;
const float SPOT_ROOM = 1e-3;

// Distances from `origin`, at most `end` along `direction`, between which lie all points in the cone from `apex` around `axis`;
// false if there are none.
bool spot_part(
    vec3 origin, vec3 direction, float end, vec3 apex, vec3 axis, float versine_outer, out float first, out float last
) {
    first = 0.0;
    last = end;
    float cosine = 1.0 - versine_outer;
    precise float sine_squared = versine_outer * (2.0 - versine_outer);
    precise float cosine_squared = cosine * cosine;
    if (cosine <= 0.0 || sine_squared < SPOT_NARROW) return true;
    // Points inside have a positive height along the axis, and (height * sine)^2 >= (distance from the axis * cosine)^2, which
    // is a t^2 + 2 b t + c >= 0.
    // Distances t are from the foot of the apex, so that nothing cancels if the line all but meets it.
    vec3 to_apex = apex - origin;
    float foot = dot3(to_apex, direction);
    precise vec3 gap = direction * foot - to_apex;
    float rise = dot3(direction, axis), height = dot3(gap, axis);
    precise vec3 across = direction - axis * rise;
    precise vec3 beside = gap - axis * height;
    precise float a = sine_squared * (rise * rise) - cosine_squared * dot3(across, across);
    precise float b = sine_squared * (rise * height) - cosine_squared * dot3(across, beside);
    precise float c = sine_squared * (height * height) - cosine_squared * dot3(beside, beside);
    if (abs(a) < SPOT_NARROW * sine_squared) return true;
    // Rounded so that the part grows: for a > 0 it is outside of the roots.
    precise float rounding = SPOT_ROUNDING * (b * b + abs(a * c));
    precise float discriminant = b * b - a * c - (a < 0.0 ? -rounding : rounding);
    if (discriminant <= 0.0) return a > 0.0;
    float root = sqrt(discriminant);
    precise float sum = -(b + (b < 0.0 ? -root : root));
    precise float one = sum / a;
    float other = 0.0;
    if (sum != 0.0) other = c / sum;
    float low = min(one, other), high = max(one, other);
    if (a < 0.0) {
        // Both ends are on the cone, or on its mirror image behind the apex.
        precise float middle = height + rise * (0.5 * (low + high));
        if (middle < 0.0) return false;
        first = foot + low;
        last = foot + high;
    } else if (rise > 0.0) {
        first = foot + high;
    } else {
        first = 0.0;
        last = foot + low;
    }
    precise float room = SPOT_ROOM * abs(min(last, end) - max(first, 0.0));
    precise float earlier = first - room, later = last + room;
    first = max(earlier, 0.0);
    last = min(later, end);
    return first < last;
}

#endif

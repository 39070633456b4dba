// Cosines to shading normals: twin of photon-core's shading_normal.rs.
#ifndef SHADING_NORMAL_GLSL
#define SHADING_NORMAL_GLSL

#include "shading/constants.glsl"
#include "shading/math.glsl"

float shading_cosine(vec3 direction, vec3 geometric, vec3 shading) {
    return min(max(dot3(direction, shading), 0.0), SHADING_MAX_RATIO * max(dot3(direction, geometric), 0.0));
}

float shading_cosine_ratio(vec3 direction, vec3 geometric, vec3 shading) {
    float below = dot3(direction, geometric);
    float above = dot3(direction, shading);
    return below > 0.0 && above > 0.0 ? min(above / below, SHADING_MAX_RATIO) : 0.0;
}

vec3 shading_bend(vec3 normal, vec3 axis) {
    float cosine = dot3(normal, axis);
    if (cosine >= SHADING_MIN_COSINE) return normal;
    precise vec3 bent = normal + axis * (SHADING_MIN_COSINE - cosine);
    return normalize_or(bent, axis);
}

// `direction`, reflected in the triangle's plane if it is on the wrong side.
vec3 shading_on_side(bool transmits, vec3 direction, vec3 geometric) {
    float height = dot3(direction, geometric);
    if (transmits ? height <= 0.0 : height >= 0.0) return direction;
    precise vec3 mirrored = direction - geometric * (2.0 * height);
    return mirrored;
}

// Factor on the power of a photon that is scattered by a specular lobe.
float shading_specular_factor(vec3 incoming, vec3 outgoing, vec3 geometric, vec3 shading) {
    precise float leaves = abs(dot3(outgoing, geometric) * dot3(incoming, shading));
    precise float arrives = abs(dot3(incoming, geometric) * dot3(outgoing, shading));
    precise float limit = SHADING_MAX_RATIO * arrives;
    return leaves < limit ? leaves / arrives : SHADING_MAX_RATIO;
}

#endif

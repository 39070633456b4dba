// The GGX distribution of microfacet normals: twin of photon-core's ggx.rs. Directions are in a frame whose z axis is the
// surface normal.
#ifndef GGX_GLSL
#define GGX_GLSL

#include "shading/constants.glsl"
#include "shading/math.glsl"

float ggx_distribution(float alpha, vec3 h) {
    precise float squared = alpha * alpha;
    precise float root = h.x * h.x + h.y * h.y + squared * (h.z * h.z);
    precise float density = squared / (3.14159265 * (root * root));
    return density;
}

float ggx_spread(float alpha, float cosine) {
    precise float squared = alpha * alpha;
    precise float spread = squared + (1.0 - squared) * (cosine * cosine);
    return sqrt(spread);
}

float ggx_visibility(float alpha, float cos_o, float cos_i) {
    precise float visibility = 0.5 / (cos_o * ggx_spread(alpha, cos_i) + cos_i * ggx_spread(alpha, cos_o));
    return visibility;
}

float ggx_bound(float alpha, vec3 o) {
    precise float squared = alpha * alpha;
    precise float sine = o.x * o.x + o.y * o.y;
    precise float s = 1.0 + sqrt(sine);
    precise float stretched = s * s;
    precise float bound = (1.0 - squared) * stretched / (stretched + squared * (o.z * o.z));
    return bound;
}

// A microfacet normal from a point of a spherical cap, which reaches `bound` times as far down as that of all visible
// normals.
vec3 ggx_normal_on_cap(float alpha, vec3 o, float bound, float u, float v) {
    precise float x = alpha * o.x;
    precise float y = alpha * o.y;
    precise float square = x * x + y * y + o.z * o.z;
    precise float inverse = 1.0 / sqrt(square);
    precise float top = o.z * inverse;
    precise float b = bound * top;
    precise float versine = u * (1.0 + b);
    precise float square_of_sine = versine * (2.0 - versine);
    float sine = sqrt(max(square_of_sine, 0.0));
    precise float z = 1.0 - versine;
    vec2 sin_cos = sin_cos_turns(v);
    precise vec3 h = vec3(alpha * (sine * sin_cos.y + x * inverse), alpha * (sine * sin_cos.x + y * inverse), z + top);
    return normalize_or(h, vec3(0.0, 0.0, 1.0));
}

// The reflection of `o` at a visible normal.
vec3 ggx_sample(float alpha, vec3 o, float u, float v) {
    vec3 h = ggx_normal_on_cap(alpha, o, ggx_bound(alpha, o), u, v);
    precise vec3 reflected = h * (2.0 * dot3(o, h)) - o;
    return reflected;
}

// A microfacet normal as seen from `o`.
vec3 ggx_visible_normal(float alpha, vec3 o, float u, float v) { return ggx_normal_on_cap(alpha, o, 1.0, u, v); }

float ggx_pdf(float alpha, vec3 o, vec3 h) {
    precise float pdf = ggx_distribution(alpha, h) / (2.0 * (ggx_bound(alpha, o) * o.z + ggx_spread(alpha, o.z)));
    return pdf;
}

#endif

// Twin of photon-core's cosine_warp.rs: directions to a triangle in proportion to the cosine, approximately.
#ifndef COSINE_WARP_GLSL
#define COSINE_WARP_GLSL

#include "shading/constants.glsl"

float cosine_warp_linear(float x, float a, float b) {
    precise float square = a * a + x * ((b - a) * (b + a));
    precise float warped = x * (a + b) / (a + sqrt(max(square, 0.0)));
    return min(warped, 0.99999994);
}

// Warped numbers, and the reciprocal of their density.
vec3 cosine_warp(float start, float pole, float finish, float u, float v) {
    start = max(start, 0.0);
    pole = max(pole, 0.0);
    finish = max(finish, 0.0);
    precise float even = COSINE_WARP_EVEN_SHARE * (start + pole + finish);
    if (!(even > COSINE_WARP_MIN_EVEN)) return vec3(u, v, 1.0);
    start += even;
    pole += even;
    finish += even;
    float warped_v = cosine_warp_linear(v, 2.0 * pole, start + finish);
    precise float low = pole + warped_v * (start - pole);
    precise float high = pole + warped_v * (finish - pole);
    float warped_u = cosine_warp_linear(u, low, high);
    precise float value = low + warped_u * (high - low);
    precise float reciprocal = 0.25 * (2.0 * pole + start + finish) / value;
    return vec3(warped_u, warped_v, reciprocal);
}

#endif

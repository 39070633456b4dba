// Twin of photon-core's cosine_warp.rs: directions to a triangle in proportion to the cosine, approximately.
#ifndef COSINE_WARP_GLSL
#define COSINE_WARP_GLSL

#include "shading/constants.glsl"

// A number, what is missing from it to 1, and the interpolated value there.
vec3 cosine_warp_linear(float x, float a, float b) {
    precise float left = 1.0 - x;
    precise float value = sqrt(a * a * left + b * b * x);
    precise float sum = a + b;
    precise float warped = x * sum / (a + value);
    precise float rest = left * sum / (b + value);
    return vec3(min(warped, 0.99999994), rest, value);
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
    vec3 second = cosine_warp_linear(v, 2.0 * pole, start + finish);
    precise float low = pole * second.y + start * second.x;
    precise float high = pole * second.y + finish * second.x;
    vec3 first = cosine_warp_linear(u, low, high);
    precise float reciprocal = 0.25 * (2.0 * pole + start + finish) / first.z;
    return vec3(first.x, second.x, reciprocal);
}

#endif

// Twin of photon-core's sampling.rs: points and directions from uniform random numbers.
#ifndef SAMPLING_GLSL
#define SAMPLING_GLSL

#include "shading/math.glsl"

// Two unit vectors that complete `n` to a right-handed orthonormal basis.
void sampling_basis(vec3 n, out vec3 tangent, out vec3 bitangent) {
    float side = copysign(1.0, n.z);
    precise float a = -1.0 / (side + n.z);
    precise float b = n.x * n.y * a;
    precise vec3 t = vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
    precise vec3 s = vec3(b, side + n.y * n.y * a, -n.y);
    tangent = t;
    bitangent = s;
}

vec3 sampling_around(vec3 axis, float sin_theta, float cos_theta, float turns) {
    vec2 sin_cos = sin_cos_turns(turns);
    vec3 tangent, bitangent;
    sampling_basis(axis, tangent, bitangent);
    precise vec3 sum = tangent * (sin_theta * sin_cos.y) + bitangent * (sin_theta * sin_cos.x) + axis * cos_theta;
    return normalize_or(sum, axis);
}

// The direction at the angle θ from `axis`, with `versine` = 1 - cos θ, rotated by `turns` around it.
vec3 sampling_about(vec3 axis, float versine, float turns) {
    precise float square = versine * (2.0 - versine);
    precise float cos_theta = 1.0 - versine;
    return sampling_around(axis, sqrt(max(square, 0.0)), cos_theta, turns);
}

// 1 - cos of the angle between two unit vectors.
float sampling_versine(vec3 a, vec3 b) {
    precise vec3 gap = a - b;
    precise float half_square = 0.5 * dot3(gap, gap);
    return half_square;
}

// A direction about `n` with density cos θ/π; never exactly in the tangent plane.
vec3 cosine_hemisphere(vec3 n, float u, float v) {
    precise float square = 1.0 - u;
    return sampling_around(n, sqrt(u), sqrt(square), v);
}

// A direction with density 1/4π; `u` is used modulo 1.
vec3 uniform_sphere(float u, float v) {
    float h = abs(u);
    precise float square = h * (1.0 - h);
    precise float cos_theta = 1.0 - 2.0 * h;
    return sampling_around(vec3(0.0, 0.0, 1.0), 2.0 * sqrt(square), u < 0.0 ? -cos_theta : cos_theta, v);
}

// Barycentric weights of the second and third vertex for a uniformly distributed point of a triangle.
vec2 sampling_triangle(float u, float v) {
    float root = sqrt(u);
    precise vec2 weights = vec2(root * (1.0 - v), root * v);
    return weights;
}

// A uniformly distributed point of the unit disc.
vec2 sampling_disc(float u, float v) {
    vec2 sin_cos = sin_cos_turns(v);
    precise vec2 point = sqrt(u) * sin_cos.yx;
    return point;
}

// A spot light's intensity relative to that on its axis; all angles as 1 - cos.
float spot_falloff(float versine, float inner, float outer) {
    if (versine <= inner) return 1.0;
    if (versine >= outer) return 0.0;
    precise float x = (outer - versine) / (outer - inner);
    precise float square = x * x;
    return square;
}

// Integral of the falloff over solid angle, in single precision.
float spot_solid_angle(float inner, float outer) {
    precise float angle = 6.2831853 * (inner + (outer - inner) * 0.33333333);
    return angle;
}

// 1 - cos of the angle from the axis of a spot light, with density proportional to its intensity.
float spot_versine(float inner, float outer, float u) {
    precise float rim = (outer - inner) * 0.33333333;
    precise float depth = u * (inner + rim);
    if (depth < inner) return depth;
    precise float cube = (1.0 - u) * ((inner + rim) / rim);
    precise float between = outer - min(cube_root(cube), 1.0) * (outer - inner);
    return between;
}

// 1 - cos of the angle from the axis of a direction within a cone, with density proportional to the cosine.
float sun_versine(float outer, float u) {
    precise float squared_sine = u * (outer * (2.0 - outer));
    precise float rest = 1.0 - squared_sine;
    precise float divisor = 1.0 + sqrt(rest);
    return squared_sine / divisor;
}

#endif

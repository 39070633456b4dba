// Twin of photon-core's solid_angle.rs: triangles as seen from a nearby point. All corners are relative to the
// eye.
#ifndef SOLID_ANGLE_GLSL
#define SOLID_ANGLE_GLSL

#include "shading/constants.glsl"
#include "shading/cosine_warp.glsl"
#include "shading/math.glsl"

// Whether a triangle is nearer than four times its radius.
bool solid_angle_is_near(vec3 a, vec3 b, vec3 c) {
    precise vec3 sum = a + b + c;
    precise float away = dot3(sum, sum) * 0.33333334;
    precise float spread = (dot3(a, a) + dot3(b, b) + dot3(c, c)) - away;
    precise float limit = SOLID_ANGLE_NEAR * spread;
    return away < limit;
}

// The solid angle of a triangle.
float solid_angle_of(vec3 a, vec3 b, vec3 c, float height, float area) {
    float x = sqrt(dot3(a, a));
    float y = sqrt(dot3(b, b));
    float z = sqrt(dot3(c, c));
    precise float rest = x * y * z + dot3(a, b) * z + dot3(b, c) * x + dot3(c, a) * y;
    precise float volume = 2.0 * area * height;
    precise float angle = 12.566371 * turns_of(volume, rest);
    return angle;
}

// The first of two lengths divided by their sum, 0 if both are 0.
float solid_angle_share(float first, float second) {
    precise float both = first + second;
    return both > 0.0 ? min(first / both, 1.0) : 0.0;
}

// Barycentric weights of the second and the third corner for a direction uniform in the solid angle, or, unless the normal is 0,
// roughly in proportion to the cosine to it; and the reciprocal of its density per solid angle. Returns false if the triangle is
// too thin for it.
bool solid_angle_sample(
    vec3 a, vec3 b, vec3 c, float height, float area, vec3 normal, float u, float v, out vec2 weights, out float per_pdf
) {
    weights = vec2(0.0);
    per_pdf = 0.0;
    float x = sqrt(dot3(a, a));
    float y = sqrt(dot3(b, b));
    float z = sqrt(dot3(c, c));
    if (!(min(min(x, y), z) > 0.0)) return false;
    precise vec3 from = a * (1.0 / x);
    precise vec3 pole = b * (1.0 / y);
    precise vec3 to = c * (1.0 / z);
    float xy = dot3(from, pole);
    float yz = dot3(pole, to);
    float zx = dot3(to, from);
    precise float volume = (height / x) * (2.0 * area / (y * z));
    precise float rest = 1.0 + xy + yz + zx;
    float half_turns = turns_of(volume, rest);
    // The pole is the corner opposite the widest side.
    uint first = zx <= min(xy, yz) ? 0u : (xy <= yz ? 1u : 2u);
    vec3 start = a, finish = c;
    float start_length = x, pole_length = y, finish_length = z;
    if (first == 1u) {
        vec3 unit = from;
        from = pole; pole = to; to = unit;
        start = b; finish = a;
        start_length = y; pole_length = z; finish_length = x;
    } else if (first == 2u) {
        vec3 unit = to;
        to = pole; pole = from; from = unit;
        start = c; finish = b;
        start_length = z; pole_length = x; finish_length = y;
    }
    precise vec3 side = finish - start;
    precise vec3 across = side - from * dot3(side, from);
    float breadth = sqrt(dot3(across, across));
    if (!(half_turns > 0.0 && volume > 0.0 && breadth > 0.0)) return false;
    precise vec3 tangent = across * (1.0 / breadth);
    float per_density = 1.0;
    if (normal != vec3(0.0)) {
        vec3 warped = cosine_warp(dot3(normal, from), dot3(normal, pole), dot3(normal, to), u, v);
        u = warped.x;
        v = warped.y;
        per_density = warped.z;
    }
    precise float turns = u * half_turns;
    vec2 sin_cos = sin_cos_turns(turns);
    precise float rise = sin_cos.x * max(1.0 + dot3(from, pole), 0.0);
    precise float fall = sin_cos.y * (volume * (finish_length / breadth)) - sin_cos.x * dot3(pole, tangent);
    precise float run = max(fall, 0.0);
    precise float square = rise * rise + run * run;
    if (!(square > 0.0)) return false;
    precise float sin_theta = 2.0 * rise * run / square;
    precise float cos_theta = (run - rise) * (run + rise) / square;
    precise float before = start_length * sin_theta;
    precise float after = breadth * cos_theta - finish_length * dot3(to, from) * sin_theta;
    precise float along = solid_angle_share(before, max(after, 0.0));
    precise vec3 end = from * cos_theta + tangent * sin_theta;
    precise vec3 gap = pole - end;
    precise float versine = min(0.5 * dot3(gap, gap), 2.0);
    precise float part = v * versine;
    precise float sines = sqrt(v * (2.0 - part) / max(2.0 - versine, 1e-12));
    precise vec3 there = start + side * along;
    precise float reach = sqrt(dot3(there, there));
    precise float here = pole_length * sines;
    precise float rest_of_arc = (1.0 - part) - (1.0 - versine) * sines;
    precise float left = reach * max(rest_of_arc, 0.0);
    precise float transmitted = solid_angle_share(here, left);
    precise vec3 three = vec3(transmitted * (1.0 - along), 1.0 - transmitted, transmitted * along);
    weights = first == 0u ? three.yz : (first == 1u ? three.xy : three.zx);
    precise float angle = 12.566371 * half_turns * per_density;
    per_pdf = angle;
    return true;
}

#endif

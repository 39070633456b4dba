// Origins of shadow rays on coarse meshes with vertex normals: twin of photon-core's shadow_terminator.rs.
#ifndef SHADOW_TERMINATOR_GLSL
#define SHADOW_TERMINATOR_GLSL

#include "shading/constants.glsl"
#include "shading/math.glsl"
#include "shading/octahedral.glsl"
#include "shading/scene.glsl"

// What the plane of a vertex adds.
vec3 shadow_terminator_lift(vec3 vertex, vec3 normal, float weight, vec3 point) {
    precise vec3 across = point - vertex;
    float below = -dot3(across, normal);
    precise vec3 lift = normal * (weight * below);
    return lift;
}

// The vector from `point` to where shadow rays start; 0 if that is less than a step above the triangle, or too far.
vec3 shadow_terminator_offset(
    vec3 a, vec3 b, vec3 c, vec3 normal_a, vec3 normal_b, vec3 normal_c, vec3 weights, vec3 point, vec3 geometric
) {
    vec3 lift_a = shadow_terminator_lift(a, normal_a, weights.x, point);
    vec3 lift_b = shadow_terminator_lift(b, normal_b, weights.y, point);
    vec3 lift_c = shadow_terminator_lift(c, normal_c, weights.z, point);
    precise vec3 sum = lift_a + lift_b + lift_c;
    vec3 size = abs(sum);
    bool is_small = max(max(size.x, size.y), size.z) < 1.0;
    return dot3(sum, geometric) >= OFFSET_STEP && is_small ? sum : vec3(0.0);
}

uint shadow_terminator_bits(float coordinate, float scale) {
    precise float scaled = coordinate * scale + 256.5;
    return uint(clamp(int(scaled), 1, 511));
}

// `offset` in 32 bits.
uint shadow_terminator_pack(vec3 offset) {
    vec3 size = abs(offset);
    float largest = max(max(size.x, size.y), size.z);
    int exponent = min(int(floatBitsToUint(largest) >> 23) - 126, 0);
    if (exponent < -30) return 0u;
    float scale = uintBitsToFloat(uint(135 - exponent) << 23);
    return uint(exponent + 31) << 27 | shadow_terminator_bits(offset.z, scale) << 18
        | shadow_terminator_bits(offset.y, scale) << 9 | shadow_terminator_bits(offset.x, scale);
}

// The inverse.
vec3 shadow_terminator_unpack(uint bits) {
    if (bits == 0u) return vec3(0.0);
    float scale = uintBitsToFloat(((bits >> 27) + 88u) << 23);
    precise vec3 offset = (vec3(bits & 511u, bits >> 9 & 511u, bits >> 18 & 511u) - 256.0) * scale;
    return offset;
}

// The offset at a hit, 0 without vertex normals.
vec3 shadow_terminator_of(SceneRef scene, Hit hit, Surface at) {
    CornerWords packed = scene.shading.normals + int(hit.slot);
    if (packed.a == FLAT_TRIANGLE) return vec3(0.0);
    Corners corners = scene.corners[hit.slot];
    vec4 a = corners.a;
    vec4 b = corners.b;
    vec4 c = corners.c;
    return shadow_terminator_offset(
        a.xyz, b.xyz, c.xyz, octahedral_unpack(packed.a), octahedral_unpack(packed.b), octahedral_unpack(packed.c),
        texel_weights(hit.u, hit.v), at.start, at.normal);
}

// As `shadow_terminator_of`, but 0 if something is in between, for the random word `word`.
vec3 shadow_terminator_at(SceneRef scene, Hit hit, Surface at, uint word) {
    vec3 offset = shadow_terminator_of(scene, hit, at);
    if (offset == vec3(0.0)) return offset;
    float far = sqrt(dot3(offset, offset));
    Ray ray = Ray(off_surface(at.start, at.normal), offset / far, far);
    if (occluded(scene, ray, word)) return vec3(0.0);
    return offset;
}

#endif

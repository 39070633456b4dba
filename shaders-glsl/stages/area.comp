// Divides estimates by the fraction of their disc that lies on the surface. Twin of backend-cpu's area.rs, with
// the same random numbers. One invocation per query and spoke.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

layout(constant_id = 0) const uint FEATURES = 511;
layout(constant_id = 2) const uint KERNEL = 0;
// Whether photons off the query's plane are rejected, and surfaces likewise.
layout(constant_id = 3) const uint FLAT = 0;
// Whether error moments are computed: then the fractions for the second radii are estimated too, and divided
// out.
layout(constant_id = 4) const uint SECOND = 0;
// Whether photons are those for the reflection of glossy surfaces.
layout(constant_id = 5) const bool REFLECTIONS = false;

// Probes find all surfaces that may be there: the photons stored on those that are there with a probability stand for all
// that arrive.
#define ALPHA_EXTENT

#include "shading/area.glsl"
#include "shading/constants.glsl"
#include "device/grid.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/offset.glsl"
#include "shading/random.glsl"
#include "shading/sampling.glsl"
#include "shading/scene.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Count { uint needed; uint capacity; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    SceneRef scene;
    Queries queries;
    Count count;
    Estimates estimates;
    ErrorMomentsBuffer error_moments;
    uvec2 seed;
    uint pass;
    uint start;
    float min_cosine;
    // Maximum distance of photons from a query's plane, in radii.
    float max_plane_distance;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// The nearest surface that is not glass, and not farther above query `i` than `most`; its `t` is relative to the ray's origin.
bool opaque_below(Ray ray, uint i, float most, out Surface found) {
    float passed = 0.0;
    for (uint sheet = 0; sheet <= AREA_SHEETS; sheet++) {
        if (!surface(push.scene, ray, 0u, found)) return false;
        float gone = found.t;
        found.t += passed;
        bool passes = FLAT != 0 && dot3(found.point - push.queries[i].at.position, push.queries[i].at.normal) > most;
        if ((FEATURES & (FEATURE_DIELECTRIC | FEATURE_THIN)) != 0) {
            uint kind = push.scene.materials[found.material].at.kind;
            passes = passes || kind == MATERIAL_DIELECTRIC || kind == MATERIAL_THIN;
        }
        if (!passes) return true;
        passed = found.t;
        float left = ray.t_max - gone;
        ray = surface_pass(found, ray.direction);
        ray.t_max = left;
    }
    return false;
}

bool opaque(Ray ray, out Surface found) { return opaque_below(ray, 0u, NO_LIMIT, found); }

// Height above query `i` from which probes start: half that of a ceiling, if it is low.
float height_over(uint i, float radius) {
    vec3 normal = push.queries[i].at.normal;
    Surface at;
    float height = AREA_HEIGHT * radius;
    return opaque(Ray(off_surface(push.queries[i].at.position, normal), normal, height), at) ? 0.5 * at.t : height;
}

// The ray that is traced next: along the spoke, from the apex down to the surface at a probe, or up from that surface.
const uint ALONG = 0u;
const uint DOWN = 1u;
const uint UP = 2u;

// Weights of the probes of one spoke of query `i`: of those on the surface, and of all, for the first radius, √2 of it and
// 1/√2 of it. All rays of a spoke are traced at one place in the code: at three it would take three times as long to compile.
void probe_spoke(uint i, uint spoke, float radius, float height, inout vec3 found, inout vec3 all) {
    vec3 normal = push.queries[i].at.normal;
    vec3 tangent, bitangent;
    sampling_basis(normal, tangent, bitangent);
    uint key = push.queries[i].at.path;
    // The word for the path may have the anisotropy, which is that of many queries.
    if (REFLECTIONS && (FEATURES & FEATURE_ANISOTROPY) != 0u && key >> 31 != 0u) key = push.queries[i].at.pixel;
    uvec4 words = philox4x32(uvec4(key, 0u, push.pass, DOMAIN_AREA), push.seed);
    float turn = unit_f32(words.x), shift = unit_f32(words.y);
    vec3 from = off_surface(push.queries[i].at.position, normal);
    vec3 apex = from + normal * height;
    float far = SECOND != 0 ? 1.41421356 * radius : radius;
    vec2 sin_cos = sin_cos_turns(area_spoke_turns(spoke, turn));
    vec3 direction = tangent * sin_cos.y + bitangent * sin_cos.x;
    float most_above = push.max_plane_distance * radius;
    // Obstacles above half the plane distance may keep photons from the surface, or have photons on top that do not count.
    Ray ray = Ray(from + normal * (FLAT != 0 ? min(height, 0.5 * most_above) : height), direction, far);
    uint next = ALONG;
    float free = far, away = 0.0;
    vec3 weights = vec3(0.0);
    Surface at;
    uint ring = AREA_RINGS + SECOND;
    // From the outermost probe inwards: if it lies on the surface and nothing is in the way, so do all inner ones.
    bool whole = false;
    // Whether the last probe is near enough to the plane.
    bool is_level = true;
    while (true) {
        Surface met;
        // Those farther above do not hide the surface: whether something stands in between is seen along the spoke.
        bool meets = opaque_below(ray, i, next == DOWN ? most_above : NO_LIMIT, met);
        bool counts = false;
        if (next == ALONG) {
            if (meets) free = met.t;
        } else if (next == DOWN) {
            at = met;
            if (meets) {
                Material material = push.scene.materials[at.material].at;
                bool keeps = REFLECTIONS ? material.kind == MATERIAL_GLOSSY : material_stores_photons(material);
                counts = keeps && !(dot3(at.normal, normal) < push.min_cosine);
            }
            if (FLAT != 0 && counts) {
                float off = abs(dot3(at.point - push.queries[i].at.position, normal));
                is_level = off <= most_above;
                vec3 most = push.max_plane_distance * (vec3(1.0, 1.41421356, 0.70710678) * radius);
                weights *= vec3(lessThanEqual(vec3(off), most));
                counts = weights != vec3(0.0);
            }
        } else {
            counts = !meets || met.front;
        }
        // Behind an occluder, the point may be inside a solid, where no photon is stored.
        if (counts && next == DOWN && !(away <= free)) {
            ray = Ray(off_surface(at.point, at.normal), at.normal, NO_LIMIT);
            next = UP;
            continue;
        }
        if (counts) {
            found += weights;
            // The outer probe is skipped if no error moments are computed, and the image must not depend on it.
            whole = ring < AREA_RINGS && next == DOWN && is_level && away <= free;
        }
        float distance;
        do {
            if (ring == 0u) return;
            --ring;
            bool outer = ring == AREA_RINGS;
            distance = outer ? area_outer_distance(spoke, shift) : area_probe(KERNEL, spoke, ring, shift);
            weights = vec3(outer ? 0.0 : 1.0, 0.0, 0.0);
            if (SECOND != 0) weights.yz = area_second_weights(KERNEL, distance);
            all += weights;
            if (whole) found += weights;
        } while (whole);
        away = distance * radius;
        ray = Ray(apex + direction * away, -normal, 2.0 * height);
        next = DOWN;
    }
}

// Sums of each spoke of the workgroup's queries. The size of a workgroup is a multiple of the number of spokes.
shared vec3 found_by[128];
shared vec3 all_by[128];
shared float heights[128 / AREA_SPOKES];

void main() {
    uint i = push.start + thread() / AREA_SPOKES;
    uint spoke = thread() % AREA_SPOKES;
    float squared = 0.0;
    if (i < min(push.count.needed, push.count.capacity)) {
        uint photons = SECOND != 0 ? push.error_moments[i].at.photons : push.estimates[i].at.photons;
        if (photons != 0) squared = push.estimates[i].at.radius_squared;
    }
    float radius = sqrt(squared);
    bool is_wide = radius >= AREA_MIN_RADIUS;
    uint own = gl_LocalInvocationIndex;
    if (is_wide && spoke == 0) heights[own / AREA_SPOKES] = height_over(i, radius);
    barrier();
    vec3 found = vec3(0.0), all = vec3(0.0);
    if (is_wide) probe_spoke(i, spoke, radius, heights[own / AREA_SPOKES], found, all);
    found_by[own] = found;
    all_by[own] = all;
    barrier();
    if (!is_wide || spoke != 0) return;
    for (uint other = 1; other < AREA_SPOKES; other++) {
        found += found_by[own + other];
        all += all_by[own + other];
    }
    float share = area_share(found.x, all.x);
    push.estimates[i].at.radius_squared = squared * share;
    if (SECOND != 0) {
        push.error_moments[i].at.wide *= share / area_share(found.y, all.y);
        push.error_moments[i].at.narrow *= share / area_share(found.z, all.z);
    }
}

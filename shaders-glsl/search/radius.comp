// Estimates from all photons within a radius. Twin of backend-cpu's estimate.rs, `Search::Radius`.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_memory_scope_semantics : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_arithmetic : require
layout(local_size_x_id = 1) in;

#include "shading/constants.glsl"
#include "shading/kernel.glsl"
#include "shading/octahedral.glsl"
#include "search/search_map.glsl"
#include "search/search_distance.glsl"
#include "search/search_sum.glsl"

// Whether photons off the query's plane are rejected.
layout(constant_id = 7) const uint FLAT = 0;

#include "search/search_error_moments.glsl"
#include "shading/gloss_caustics.glsl"
#include "shading/reflection_lobe.glsl"
#include "shading/shading_normal.glsl"

layout(constant_id = 4) const uint KERNEL = 0;
// Whether photons are filtered by normal.
layout(constant_id = 5) const uint FILTER = 1;
// Whether `ErrorMoments` are written with each estimate.
layout(constant_id = 6) const uint ERROR_MOMENTS = 0;

// What photons are weighted by: nothing, the cosine to the query's shading normal, or the reflection of the query.
layout(constant_id = 10) const uint SHADING = 0;
const uint REFLECTED = 2;
// The same, which may be anisotropic.
const uint ANISOTROPIC = 3;
// The same, which may be that of a sheen.
const uint SHEEN_OR_OTHER = 4;

// Whether photons count for some queries only; REFLECTED or a higher one.
layout(constant_id = 11) const bool MARKED = false;

// Positions with packed normals, normals, powers: if MARKED, negative ones of photons that only marked queries count.
shared uvec4 staged[TILES * TILE_POINTS];
shared vec3 normals[TILES * TILE_POINTS];
shared vec3 powers[TILES * TILE_POINTS];
// Directions that photons came from, if `SHADING`.
shared vec3 directions[SHADING != 0 ? TILES * TILE_POINTS : 1];

// Parameters that every photon needs.
Slots positions;
Fluxes fluxes;
float min_cosine;

vec3 at, normal;
// The shading normal, if `SHADING`.
vec3 shading;
// From `REFLECTED` on.
ReflectionLobe lobe;
// Its packed direction towards the viewer, if MARKED.
uint query_mark;
// From `ANISOTROPIC` on.
vec2 widths;
// If `SHEEN_OR_OTHER`.
Charlie sheen;
bool is_sheen;
uint limit;
float scale;
// Maximum distance of a photon from the query's plane, if `FLAT`.
float flat_most;
Sum flux;
uint photons;

void stage(uint mode, uint place, uint slot) {
    uvec4 point = positions[slot].at;
    staged[place] = point;
    uvec4 flux = flux_at(FORMAT, fluxes, slot);
    powers[place] = uintBitsToFloat(flux.xyz);
    if (MARKED && !gloss_caustics_counts(flux.w, 0u)) powers[place] = -powers[place];
    if (SHADING != 0) directions[place] = octahedral_unpack(flux.w);
    if (FILTER != 0 || SHADING != 0) normals[place] = octahedral_unpack(point.w);
}

Albedos albedos() { return Albedos(push.albedos); }

// The power of a photon as it counts for the query.
vec3 power_of(uint place) {
    if (SHADING == 0) return powers[place];
    vec3 power = powers[place];
    if (MARKED) {
        bool is_unmarked = min(min(power.x, power.y), power.z) < 0.0;
        if (is_unmarked && !gloss_caustics_counts(0u, query_mark)) return vec3(0.0);
        power = abs(power);
    }
    if (SHADING == REFLECTED) return power * lobe_weight(albedos(), lobe, directions[place], normals[place]);
    if (SHADING == SHEEN_OR_OTHER && is_sheen) {
        return power * lobe_weight_sheen(albedos(), lobe, sheen, directions[place], normals[place]);
    }
    if (SHADING >= ANISOTROPIC) {
        return power * lobe_weight_anisotropic(albedos(), lobe, widths, directions[place], normals[place]);
    }
    return power * shading_cosine_ratio(directions[place], normals[place], shading);
}

void add(uint place, inout vec3 sum) {
    vec3 point = uintBitsToFloat(staged[place].xyz);
    float d2 = point_distance(at, point);
    float off = FLAT != 0 ? abs(dot3(point - at, normal)) : 0.0;
    if (ERROR_MOMENTS != 0) {
        bool near = floatBitsToUint(d2) < limit;
        bool same = FILTER == 0 || dot3(normals[place], normal) >= min_cosine;
        if (FLAT != 0) same = same && !(off > 1.41421356 * flat_most);
        bvec2 flat_enough = FLAT != 0 ? bvec2(!(off > flat_most), !(off > 0.70710678 * flat_most)) : bvec2(true);
        if (near) {
            error_moments_add(
                KERNEL, point - at, normal, power_of(place), d2, d2 * scale, same, flat_enough, sum, photons);
        }
    } else if (floatBitsToUint(d2) < limit && (FILTER == 0 || dot3(normals[place], normal) >= min_cosine)
        && (FLAT == 0 || !(off > flat_most))) {
        sum += power_of(place) * kernel_weight(KERNEL, min(d2 * scale, 1.0));
        photons++;
    }
}

#define ADD(place) add(place, sum)

void visit(uint mode, uvec2 firsts) {
    uint end = (gl_SubgroupID + 1) * TILE_POINTS;
    for (uint place = end - TILE_POINTS; place < end; place += 8) {
        vec3 sum = vec3(0.0);
        if (ERROR_MOMENTS != 0) error_moments_eight_begin();
        // Eight copies of a reflection take long to compile and gain nothing.
        if (SHADING >= REFLECTED) {
            for (uint i = 0; i < 8; i++) ADD(place + i);
        } else {
            EIGHT(ADD, place);
        }
        sum_add(flux, sum);
        if (ERROR_MOMENTS != 0) error_moments_eight_end();
    }
}

const uint VISIT_TURNS = TILE_POINTS / 8 * (SHADING >= REFLECTED ? 10 : 1) + 1;
#include "search/search_walk.glsl"

void query_keep() {
    pause_begin(PAUSE_KERNEL);
    sum_keep(flux);
    keep(photons);
    if (ERROR_MOMENTS != 0) error_moments_keep();
}

void main() {
    if (gl_LocalInvocationIndex == 0 && workgroup() == 0 && push.first == 0) {
        push.result_count[0].at = min(push.query_count[0].at, push.query_count[1].at);
    }
    positions = push.positions;
    fluxes = push.power;
    min_cosine = push.min_cosine;
    uvec2 own;
    if (!own_queries(own) || (TURNS != 0 && !pause_open())) return;
    uint place = own.x + gl_SubgroupInvocationID;
    bool asked = place < own.y;
    uint index = asked && ORDERED != 0 ? push.order[place].at : place;
    precise float squared_radius = 0.0;
    limit = 0;
    at = vec3(0.0);
    normal = vec3(0.0);
    shading = vec3(0.0);
    flat_most = 0.0;
    query_mark = 0u;
    if (asked) {
        at = push.queries[index].at.position;
        normal = push.queries[index].at.normal;
        if (SHADING != 0) shading = octahedral_unpack(push.queries[index].at.shading_normal);
        if (MARKED) query_mark = push.queries[index].at.offset_or_wo;
        if (SHADING == REFLECTED) {
            uvec2 words = uvec2(push.queries[index].at.media, push.queries[index].at.coat);
            lobe = lobe_new(albedos(), words, octahedral_unpack(push.queries[index].at.offset_or_wo), shading);
        }
        if (SHADING >= ANISOTROPIC) {
            uvec2 words = uvec2(push.queries[index].at.media, push.queries[index].at.coat);
            lobe = lobe_anisotropic(albedos(), words, push.queries[index].at.path,
                octahedral_unpack(push.queries[index].at.offset_or_wo), shading, widths);
            if (SHADING == SHEEN_OR_OTHER) {
                is_sheen = lobe_is_sheen(words);
                if (is_sheen) sheen = lobe_sheen(albedos(), words, lobe.wo);
            }
        }
        precise float radius = push.queries[index].at.radius * push.radius;
        squared_radius = radius * radius;
        if (FLAT != 0) flat_most = push.max_plane_distance * radius;
        if (push.points > 0 && !is_nan(squared_radius) && !is_nan(at.x) && !is_nan(at.y) && !is_nan(at.z)) {
            precise float reach = ERROR_MOMENTS != 0 ? 2.0 * squared_radius : squared_radius;
            limit = floatBitsToUint(reach) + 1;
            // The map is too far from all queries of the tile.
            vec3 low = uintBitsToFloat(push.nodes[0].low.xyz), high = uintBitsToFloat(push.nodes[0].high.xyz);
            if (floatBitsToUint(box_distance(at, low, high)) >= limit) limit = 0;
        }
    }
    float divisor = squared_radius >= NEIGHBOUR_MIN_RADIUS_SQUARED ? squared_radius : NEIGHBOUR_MIN_RADIUS_SQUARED;
    scale = 1.0 / divisor;
    flux = NOTHING;
    photons = 0;
    if (ERROR_MOMENTS != 0) error_moments_begin(normal, squared_radius, divisor);
    if (resumed) query_keep();
    walk(0);
    if (paused) {
        query_keep();
    } else if (asked && index < push.capacity) {
        Estimates(push.results)[index].at = Estimate(
            flux.total - flux.excess, divisor, photons, squared_radius < NEIGHBOUR_MIN_RADIUS_SQUARED ? ESTIMATE_SINGULAR : 0u, vec2(0.0));
        if (ERROR_MOMENTS != 0) push.error_moments[index].at = error_moments_found();
    }
    if (TURNS != 0) pause_close();
}

// Beam radiance estimates: light that the photons of a medium around a segment scatter along it. Twin of backend-cpu's
// beam_estimate.rs.
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

const uint FEATURES = 0u;
layout(constant_id = 4) const uint KERNEL = 0;
layout(constant_id = 5) const uint MEDIA = 4;
layout(constant_id = 6) const uint ERROR_MOMENTS = 0;

// Walks through grids are loops too, which `turns` has to count.
#define GRID_TURNS

#include "shading/constants.glsl"
#include "shading/kernel.glsl"
#include "shading/stretches.glsl"
#include "shading/octahedral.glsl"
#include "shading/phase.glsl"
#include "shading/segment.glsl"
#include "search/search_map.glsl"
#include "search/search_distance.glsl"
#include "search/search_sum.glsl"
#include "search/search_error_moments.glsl"

// Positions with the index of the medium, powers, directions that photons came from.
shared uvec4 staged[TILES * TILE_POINTS];
shared vec3 powers[TILES * TILE_POINTS];
shared vec3 directions[TILES * TILE_POINTS];

// Parameters that every photon needs.
Slots positions;
Fluxes fluxes;

// Start of the segment, and one more than the bits of the squared radius; 0 without one.
vec3 at;
uint limit;
Segment segment;
// Its medium.
uint index_of_medium;
vec3 extinction;
Phase phase;
// Whether it has a grid of densities, and then the columns along the segment.
bool grid_is_there;
Columns columns;
// A constant where no medium has a grid.
bool sees_grid() { return GRIDS && grid_is_there; }
float scale;
// Feet on its line that count: by several radii beyond its ends, which are oblique planes. For the estimate itself, if
// photons within a wider radius are found for `ERROR_MOMENTS`, the inner range.
vec2 range, inner_range;
// For boxes: reciprocals of its direction, and the radius with room for rounding.
vec3 inverse;
float margin;
Sum flux;
uint photons;
vec2 power_sums;

void stage(uint mode, uint place, uint slot) {
    uvec4 flux = flux_at(FORMAT, fluxes, slot);
    staged[place] = positions[slot].at;
    powers[place] = uintBitsToFloat(flux.xyz);
    directions[place] = octahedral_unpack(flux.w);
}

void add(uint place, inout vec3 sum) {
    precise vec3 gap = uintBitsToFloat(staged[place].xyz) - at;
    float foot = dot3(gap, segment.direction);
    precise vec3 beside = gap - foot * segment.direction;
    float d2 = squared(beside);
    if (floatBitsToUint(d2) >= limit || foot < range.x || foot > range.y) return;
    if (staged[place].w != index_of_medium) return;
    float column = segment_distance(segment, gap);
    if (column < 0.0) return;
    float scattered = phase_value(phase, directions[place], segment.direction);
    if (sees_grid()) column = columns_to(columns, column);
    vec3 power = powers[place] * scattered * exp_neg3(extinction * column);
    uint before = photons;
    if (ERROR_MOMENTS != 0) {
        bool is_inner = foot >= inner_range.x && foot <= inner_range.y;
        error_moments_add(
            KERNEL, beside, segment.direction, power, d2, d2 * scale, true, bvec2(is_inner, true), sum, photons);
    } else {
        sum += power * kernel_weight(KERNEL, min(d2 * scale, 1.0));
        photons++;
    }
    float mean = (power.x + power.y + power.z) * (1.0 / 3.0);
    if (photons != before) power_sums += vec2(mean, mean * mean);
}

void visit(uint mode, uvec2 firsts) {
    uint end = (gl_SubgroupID + 1) * TILE_POINTS;
    for (uint place = end - TILE_POINTS; place < end; place += 8) {
        vec3 sum = vec3(0.0);
        if (ERROR_MOMENTS != 0) error_moments_eight_begin();
        // Not unrolled: a photon takes many instructions.
        for (uint k = 0; k < 8; ++k) {
            grid_turns = 0u;
            add(place + k, sum);
            if (TURNS != 0) turns += 1 + (GRIDS ? subgroupMax(grid_turns) : 0u);
        }
        sum_add(flux, sum);
        if (ERROR_MOMENTS != 0) error_moments_eight_end();
    }
}

// Whether the line meets a box within its range and the margin.
bool touches(vec3 low, vec3 high) {
    vec3 one = (low - margin - at) * inverse, other = (high + margin - at) * inverse;
    vec3 first = min(one, other), last = max(one, other);
    float near = max(max(first.x, first.y), max(first.z, range.x - margin));
    float far = min(min(last.x, last.y), min(last.z, range.y + margin));
    // Rounding of the quotients may make a thin box end before it begins.
    return near - far <= 1e-6 * (abs(near) + abs(far));
}

void bounds(inout vec3 low, inout vec3 high) {
    vec3 one = at + range.x * segment.direction, other = at + range.y * segment.direction;
    low = min(one, other) - margin;
    high = max(one, other) + margin;
}

const uint VISIT_TURNS = TILE_POINTS / 8 + 1;
#define SEARCH_SEGMENT
#include "search/search_walk.glsl"

void query_keep() {
    pause_begin(PAUSE_KERNEL);
    sum_keep(flux);
    keep(photons);
    keep(power_sums.x);
    keep(power_sums.y);
    if (ERROR_MOMENTS != 0) error_moments_keep();
}

float reciprocal(float component) {
    // Without infinities, which give NaN for boxes in the plane of the origin.
    return abs(component) < 1e-12 ? copysign(1e12, component) : 1.0 / component;
}

void main() {
    if (gl_LocalInvocationIndex == 0 && workgroup() == 0 && push.first == 0) {
        push.result_count[0].at = min(push.query_count[0].at, push.query_count[1].at);
    }
    positions = push.positions;
    fluxes = push.power;
    uvec2 own;
    if (!own_queries(own) || (TURNS != 0 && !pause_open())) return;
    uint index = own.x + gl_SubgroupInvocationID;
    bool asked = index < own.y;
    precise float squared_radius = 0.0;
    at = vec3(0.0);
    limit = 0;
    flux = NOTHING;
    photons = 0;
    power_sums = vec2(0.0);
    grid_is_there = false;
    if (asked) {
        SceneRef scene = SceneRef(push.albedos);
        segment = segment_of(push.queries[index].at);
        at = segment.origin;
        index_of_medium = media_current(scene, segment.media);
        Medium medium = scene.media[index_of_medium].at;
        extinction = medium_extinction(medium);
        grid_is_there = has_grid(scene, index_of_medium);
        if (sees_grid()) {
            GridTables tables = scene.grids;
            Grid grid = tables.grids[index_of_medium].at;
            columns = columns_new(tables, grid, at, segment.direction, segment.far);
        }
        phase = phase_of(medium);
        precise float wanted = push.queries[index].at.radius * push.radius;
        // In dense media photons are closer together than a mean free path, or are noise.
        precise float most = 0.5 / max(max(extinction.x, extinction.y), extinction.z);
        float radius = min(wanted, most);
        squared_radius = radius * radius;
        scale = 1.0 / squared_radius;
        precise float wide = ERROR_MOMENTS != 0 ? 1.41421356 * radius : radius;
        precise vec2 inner_ends = vec2(-8.0 * radius, segment.far + 8.0 * radius);
        precise vec2 ends = vec2(-8.0 * wide, segment.far + 8.0 * wide);
        inner_range = inner_ends;
        range = ends;
        vec3 direction = segment.direction;
        inverse = vec3(reciprocal(direction.x), reciprocal(direction.y), reciprocal(direction.z));
        // Feet and distances are rounded relative to the largest of all numbers.
        float largest = max(max(abs(at.x), abs(at.y)), max(abs(at.z), abs(range.y)));
        margin = wide * 1.001 + 1e-6 * largest;
        precise float reach = ERROR_MOMENTS != 0 ? 2.0 * squared_radius : squared_radius;
        if (push.points > 0 && is_positive_finite(squared_radius)) limit = floatBitsToUint(reach) + 1;
        if (ERROR_MOMENTS != 0) error_moments_begin(direction, squared_radius, squared_radius);
    }
    // Those of the columns, of which lanes may make more in different parts.
    if (GRIDS && TURNS != 0) turns += GRID_KNOTS + subgroupAdd(grid_turns);
    if (resumed) query_keep();
    walk(0);
    if (paused) {
        query_keep();
    } else if (asked && index < push.capacity) {
        Estimates(push.results)[index].at =
            Estimate(flux.total - flux.excess, squared_radius, photons, 0u, power_sums);
        if (ERROR_MOMENTS != 0) push.error_moments[index].at = error_moments_found();
    }
    if (TURNS != 0) pause_close();
}

// Counts the photons within a radius of each query.
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

#include "shading/math.glsl"
#include "search/search_map.glsl"
#include "search/search_distance.glsl"

shared uvec4 staged[TILES * TILE_POINTS];

vec3 at;
uint limit, found;

void stage(uint mode, uint place, uint slot) {
    staged[place] = push.positions[slot].at;
}

void add(uint place) {
    float d2 = point_distance(at, uintBitsToFloat(staged[place].xyz));
    found += floatBitsToUint(d2) < limit ? 1 : 0;
}

void visit(uint mode, uvec2 firsts) {
    uint end = (gl_SubgroupID + 1) * TILE_POINTS;
    for (uint place = end - TILE_POINTS; place < end; place += 8) {
        EIGHT(add, place);
    }
}

const uint VISIT_TURNS = TILE_POINTS / 8 + 1;
#define SEARCH_COUNT
#include "search/search_walk.glsl"

void query_keep() {
    pause_begin(PAUSE_KERNEL);
    keep(found);
}

void main() {
    uvec2 own;
    if (!own_queries(own) || (TURNS != 0 && !pause_open())) return;
    uint index = own.x + gl_SubgroupInvocationID;
    bool asked = index < own.y;
    limit = 0;
    found = 0;
    at = vec3(0.0);
    if (asked) {
        at = push.queries[index].at.position;
        precise float most = push.radius * push.radius;
        bool a_number = !is_nan(at.x) && !is_nan(at.y) && !is_nan(at.z) && !is_nan(most);
        if (push.points > 0 && a_number) limit = floatBitsToUint(most) + 1;
    }
    if (resumed) query_keep();
    if (subgroupAny(limit > 0)) walk(0);
    if (paused) query_keep();
    else if (asked && index < push.capacity) Words(push.results)[index].at = found;
    if (TURNS != 0) pause_close();
}

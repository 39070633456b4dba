// The nearest hit of each ray of a list, or whether there is one: for tests, and to benchmark ray traversal in
// isolation.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require

layout(local_size_x_id = 1) in;
// Of no scene: every surface counts as there.
const uint FEATURES = 0u;

#include "device/counter.glsl"
#include "device/grid.glsl"
#include "shading/scene.glsl"

// Whether any hit suffices (shadow rays).
layout(constant_id = 2) const bool SHADOW = false;
// 0: one ray per invocation. Otherwise invocations whose rays have ended fetch new ones as soon as fewer than
// this many of a subgroup are tracing.
layout(constant_id = 3) const uint BUSY = 0u;

struct Line {
    vec3 origin;
    float t_max;
    vec3 direction;
    uint reserved;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Lines { Line at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) writeonly buffer Hits { uvec4 at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    SceneRef scene;
    Lines lines;
    Hits hits;
    Counter counter;
    uint count;
    // Maximum number of rays per invocation. On a CPU, where few invocations run at a time, the first ones
    // would otherwise take all rays.
    uint quota;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

bool begin(uint index, out Walk walk) {
    Line line = push.lines[index].at;
    return walk_begin(push.scene, Ray(line.origin, line.direction, line.t_max), 0u, walk);
}

void end(uint index, Hit hit) {
    bool found = hit.primitive != NO_PRIMITIVE;
    push.hits[index].at = uvec4(
        found ? floatBitsToUint(hit.t) : NO_PRIMITIVE, hit.primitive, floatBitsToUint(hit.u), floatBitsToUint(hit.v));
}

void main() {
    SceneRef scene = push.scene;
    Walk walk;
    if (BUSY == 0u) {
        uint index = thread();
        if (index >= push.count) return;
        bool under_way = begin(index, walk);
        while (under_way) under_way = walk_step(scene, walk, SHADOW);
        end(index, walk.best);
        return;
    }
    uint index = 0u;
    bool under_way = false;
    uint taken = 0u;
    while (true) {
        if (!under_way) {
            if (taken == push.quota) break;
            ++taken;
            index = counter_take(push.counter);
            if (index >= push.count) break;
            under_way = begin(index, walk);
            if (!under_way) end(index, walk.best);
        }
        while (under_way) {
            under_way = walk_step(scene, walk, SHADOW);
            if (!under_way) {
                end(index, walk.best);
            } else if (subgroupBallotBitCount(subgroupBallot(true)) < BUSY) {
                break;
            }
        }
    }
}

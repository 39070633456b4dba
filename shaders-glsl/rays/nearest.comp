// The nearest hit of each ray of a list: for tests, and to measure the traversal by itself.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "grid.glsl"
#include "scene.glsl"

layout(local_size_x_id = 1) in;

// 0: the nearest hit; 1: whether there is one.
layout(constant_id = 2) const uint SHADOW = 0u;

struct Line {
    vec3 origin;
    float t_max;
    vec3 direction;
    uint reserved;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Lines { Line at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) writeonly buffer Hits { uvec4 at; };

layout(push_constant, scalar) uniform Push {
    SceneRef scene;
    Lines lines;
    Hits hits;
    uint count;
} push;

void main() {
    uint index = thread();
    if (index >= push.count) return;
    Line line = push.lines[index].at;
    Ray ray = Ray(line.origin, line.direction, line.t_max);
    uvec4 found = uvec4(NO_PRIMITIVE);
    if (SHADOW != 0u) {
        if (occluded(push.scene, ray)) found.y = 0u;
    } else {
        Hit hit;
        if (nearest(push.scene, ray, hit)) {
            found = uvec4(floatBitsToUint(hit.t), hit.primitive, floatBitsToUint(hit.u), floatBitsToUint(hit.v));
        }
    }
    push.hits[index].at = found;
}

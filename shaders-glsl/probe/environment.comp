// Evaluates the functions of environment.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shading/constants.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 0) const uint FEATURES = FEATURE_ALL;

#include "probe/probe.glsl"
#include "shading/environment.glsl"

// Coordinates or a direction; two random words; address of the scene.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    SceneRef scene = SceneRef(words.c.zw);
    switch (FUNCTION) {
        case 0u: return floats(vec4(environment_bilinear(scene, a.x, a.y), 0.0), vec4(0.0));
        case 1u: return floats(vec4(environment_radiance(scene, a.xyz), 0.0), vec4(0.0));
        case 2u: {
            EnvironmentInterval row = environment_interval(scene, 0u, scene.environment.rows_count, words.b.x);
            uint columns = scene.environment.columns;
            uint first = scene.environment.rows_count + row.index * columns;
            EnvironmentInterval column = environment_interval(scene, first, columns, words.b.y);
            return floats(vec4(float(row.index), row.within, row.probability, 0.0),
                vec4(float(column.index), column.within, column.probability, 0.0));
        }
        case 6u: return floats(vec4(environment_pdf(scene, a.xyz), 0.0, 0.0, 0.0), vec4(0.0));
    }
    EnvironmentSample found = environment_sample(scene, words.b.xy);
    if (FUNCTION == 5u) return floats(vec4(found.pdf, 0.0, 0.0, 0.0), vec4(0.0));
    return floats(vec4(FUNCTION == 3u ? found.direction : found.weight, 0.0), vec4(0.0));
}

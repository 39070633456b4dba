// Evaluates the functions of grid.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shading/constants.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 0) const uint FEATURES = FEATURE_ALL;
const bool GRIDS = true;

#include "probe/probe.glsl"
#include "shading/grid.glsl"

// The product, rounded as on the host.
float product(float a, float b) {
    precise float rounded = a * b;
    return rounded;
}

// Origin and the start of a part of a ray, direction and its end, a share and the address of the scene. The grid is that of the
// second medium.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    GridTables tables = SceneRef(words.c.zw).grids;
    Grid grid = tables.grids[1].at;
    GridLine line = grid_line(grid, a.xyz, b.xyz);
    float column = grid_walk(tables, grid, line, a.w, b.w, GRID_NO_LIMIT).x;
    if (FUNCTION == 0u) return floats(vec4(column, grid_density(tables, grid, a.xyz), 0.0, 0.0), vec4(0.0));
    if (FUNCTION == 1u) {
        float place = grid_walk(tables, grid, line, a.w, b.w, product(column, c.x)).y;
        return floats(vec4(grid_walk(tables, grid, line, a.w, place, GRID_NO_LIMIT).x, 0.0, 0.0, 0.0), vec4(0.0));
    }
    Columns columns = columns_new(tables, grid, a.xyz, b.xyz, b.w);
    float part = columns_to(columns, columns_place(columns, product(columns_total(), c.x)));
    return floats(vec4(columns_to(columns, product(b.w, c.x)), part, columns_total(), 0.0), vec4(0.0));
}

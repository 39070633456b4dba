// Media along rays: all that attenuates light is found here. Twin of backend-cpu's stretches.rs.
#ifndef STRETCHES_GLSL
#define STRETCHES_GLSL

#include "shading/media.glsl"
// Needs GRIDS.
#include "shading/grid.glsl"

// Whether rays that start in a stack of media may cross one that absorbs or scatters light.
bool may_attenuate(uint stack) { return (FEATURES & FEATURE_ABSORPTION) != 0u && (AMBIENT || stack != VACUUM); }

// Whether the medium with this index has a grid of densities.
bool has_grid(SceneRef scene, uint medium) { return GRIDS && scene.grids.grids[medium].at.cells.x != 0u; }

// Integral of the density along the part of a ray between two distances: its length, where the medium is homogeneous.
float stretch_column(SceneRef scene, uint medium, Ray ray, float from, float to) {
    if (!has_grid(scene, medium)) return to - from;
    GridTables tables = scene.grids;
    Grid grid = tables.grids[medium].at;
    return grid_walk(tables, grid, grid_line(grid, ray.origin, ray.direction), from, to, GRID_NO_LIMIT).x;
}

// Distance from the origin of a ray within which the part of it between two distances has a column.
float stretch_place(SceneRef scene, uint medium, Ray ray, float from, float to, float column) {
    if (!has_grid(scene, medium)) return from + column;
    GridTables tables = scene.grids;
    Grid grid = tables.grids[medium].at;
    return grid_walk(tables, grid, grid_line(grid, ray.origin, ray.direction), from, to, column).y;
}

// Transmittance per channel of the part of a ray between two distances, in the medium with this index.
vec3 stretch_transmittance(SceneRef scene, uint medium, Ray ray, float from, float to) {
    float column = stretch_column(scene, medium, ray, from, to);
    if (SCATTERING) return medium_transmittance(scene.media[medium].at, column);
    vec3 depth = scene.media[medium].at.absorption * column;
    return vec3(exp_neg(depth.x), exp_neg(depth.y), exp_neg(depth.z));
}

// Transmittance per channel of a ray that starts in a stack of media and meets no surface before the distance `end`.
vec3 transmittance(SceneRef scene, Ray ray, float end, uint stack) {
    return stretch_transmittance(scene, media_current(scene, stack), ray, 0.0, end);
}

#endif

// Media along rays: all that attenuates light is found here. Twin of backend-cpu's stretches.rs.
#ifndef STRETCHES_GLSL
#define STRETCHES_GLSL

#include "shading/boundaries.glsl"
#include "shading/media.glsl"
// Needs GRIDS.
#include "shading/grid.glsl"

// Whether rays that start in a stack of media may cross one that absorbs or scatters light.
bool may_attenuate(uint stack) {
    return (FEATURES & FEATURE_ABSORPTION) != 0u && (AMBIENT || BOUNDARIES || stack != VACUUM);
}

// Part of a ray in one medium.
struct Stretch {
    // Distances of its ends from the origin of the ray.
    float from;
    float to;
    // Index of the medium.
    uint medium;
    // Unit normals of the boundaries at its ends, along the ray; 0 where there is none.
    vec3 start;
    vec3 end;
};

// The parts of a ray, in order.
struct Stretches {
    Ray ray;
    // Distance of its first surface, NO_LIMIT without one.
    float end;
    // Medium of the solids around it, and boundaries around what comes next.
    uint solid;
    Enclosing around;
    Crossing last;
    float from;
    vec3 plane;
    bool is_done;
};

// Index of the medium of the solids in a stack. A segment has the solid below the medium that applies.
uint stretches_solid(SceneRef scene, uint stack) {
    uint current = media_current(scene, stack);
    if (!BOUNDARIES || scene.media[current].at.dispersion != MEDIUM_MATCHED) return current;
    return media_current(scene, media_leave(stack, current));
}

// The parts of a ray that starts in a stack of solids; `end` is the distance of its first surface, NO_LIMIT without one.
Stretches stretches_begin(SceneRef scene, Ray ray, float end, uint stack) {
    Stretches all;
    all.ray = ray;
    all.end = end;
    all.solid = stretches_solid(scene, stack);
    all.from = 0.0;
    all.plane = vec3(0.0);
    all.is_done = false;
    if (BOUNDARIES) {
        float scale = scene.boundaries.scale;
        all.ray = Ray(ray.origin / scale, ray.direction, NO_LIMIT);
        all.around = enclosing_at(scene, all.ray);
        all.ray.t_max = end == NO_LIMIT ? NO_LIMIT : (end - FLIGHT_SHORTEST_STRETCH) / scale;
        all.last = Crossing(-1.0, 0u, 0u, 0);
    }
    return all;
}

// The next part; false if there is none.
bool stretches_next(SceneRef scene, inout Stretches all, out Stretch part) {
    if (all.is_done) return false;
    uint medium = all.solid;
    if (BOUNDARIES) {
        medium = enclosing_current(scene, all.around, all.solid);
        while (true) {
            all.last = crossing_next(scene, all.ray, all.last);
            if (all.last.triangle == NO_TRIANGLE) break;
            enclosing_add(all.around, floatBitsToUint(scene.boundaries.corners[all.last.slot].b.w), all.last.crossing);
            uint beyond = enclosing_current(scene, all.around, all.solid);
            if (beyond == medium) continue;
            vec3 normal = boundary_normal(scene, all.last.slot, all.ray.direction);
            float at = all.last.t * scene.boundaries.scale;
            part = Stretch(all.from, at, medium, all.plane, normal);
            all.plane = normal;
            // Boundaries may coincide.
            if (at > all.from + FLIGHT_SHORTEST_STRETCH) {
                all.from = at;
                return true;
            }
            medium = beyond;
        }
    }
    all.is_done = true;
    part = Stretch(all.from, all.end == NO_LIMIT ? all.from + FLIGHT_FAR : all.end, medium, all.plane, vec3(0.0));
    return true;
}

// Whether the medium with this index has a grid of densities.
bool has_grid(SceneRef scene, uint medium) { return GRIDS && scene.grids.grids[medium].at.cells.x != 0u; }

// Integral of the density along the part of a ray between two distances: its length, where the medium is homogeneous.
float stretch_column(SceneRef scene, uint medium, Ray ray, float from, float to) {
    if (!has_grid(scene, medium)) return to - from;
    GridTables tables = scene.grids;
    Grid grid = tables.grids[medium].at;
    return grid_walk(tables, grid, grid_line(grid, ray.origin, ray.direction), from, to, GRID_NO_LIMIT).x;
}

// Goes along a ray from one distance to another until the column is `limit`: the column, and the distance there; all of it, if that
// is less.
vec2 stretch_until(SceneRef scene, uint medium, Ray ray, float from, float to, float limit) {
    if (!has_grid(scene, medium)) {
        precise float far = to - from;
        precise float there = from + limit;
        return limit < far ? vec2(limit, there) : vec2(far, to);
    }
    GridTables tables = scene.grids;
    Grid grid = tables.grids[medium].at;
    return grid_walk(tables, grid, grid_line(grid, ray.origin, ray.direction), from, to, limit);
}

// Transmittance per channel of the part of a ray between two distances, in the medium with this index.
vec3 stretch_transmittance(SceneRef scene, uint medium, Ray ray, float from, float to) {
    float column = stretch_column(scene, medium, ray, from, to);
    if (SCATTERING) return medium_transmittance(scene.media[medium].at, column);
    vec3 depth = scene.media[medium].at.absorption * column;
    return vec3(exp_neg(depth.x), exp_neg(depth.y), exp_neg(depth.z));
}

// Transmittance per channel of a ray that starts in a stack of solids and meets no surface before the distance `end`.
vec3 transmittance(SceneRef scene, Ray ray, float end, uint stack) {
    if (!BOUNDARIES) return stretch_transmittance(scene, media_current(scene, stack), ray, 0.0, end);
    vec3 product = vec3(1.0);
    Stretches all = stretches_begin(scene, ray, end, stack);
    Stretch part;
    while (stretches_next(scene, all, part)) {
        product *= stretch_transmittance(scene, part.medium, ray, part.from, part.to);
    }
    return product;
}

#endif

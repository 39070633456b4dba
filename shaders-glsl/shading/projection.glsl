// Twin of photon-core's projection map: emission of photons aimed at mirrors and glass.
#ifndef PROJECTION_GLSL
#define PROJECTION_GLSL

struct ProjectionTarget {
    vec3 carried;
    uint light;
    uint first;
    uint count;
    uint point_bits;
    uint direction_bits;
};

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ProjectionTargets { ProjectionTarget at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer AimWords { uint at; };

// The tables of a projection map, and the number of targets.
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer ProjectionRef {
    ProjectionTargets targets;
    AimWords starts;
    AimWords cells;
    uint count;
};

// Random words to be used in place of those that selected the cell.
struct ProjectionSample {
    uint light;
    // Index of the first cell of the light.
    uint first;
    vec3 carried;
    uvec2 point;
    uvec2 direction;
    uint side;
};

// The word whose upper `bits` are `cell` and whose other bits are the upper ones of `random`.
uint aim_within(uint cell, uint bits, uint random) {
    return bits == 0u ? random : cell << (32u - bits) | random >> bits;
}

ProjectionSample projection_sample(ProjectionRef projection, uvec4 light, uvec4 start) {
    uint low = 0u;
    uint high = projection.count;
    while (high - low > 1u) {
        uint middle = low + (high - low) / 2u;
        if (projection.starts[middle].at <= light.x) low = middle;
        else high = middle;
    }
    ProjectionTarget target = projection.targets[low].at;
    uint number, rest;
    umulExtended(start.x, target.count, number, rest);
    uint cell = projection.cells[target.first + number].at;
    uint p = target.point_bits;
    uint q = target.direction_bits;
    uint point_mask = (1u << p) - 1u;
    uint direction_mask = (1u << q) - 1u;
    ProjectionSample projected;
    projected.light = target.light;
    projected.first = target.first;
    projected.carried = target.carried;
    projected.point = uvec2(
        aim_within(cell >> (2u * q + p) & point_mask, p, light.y),
        aim_within(cell >> (2u * q) & point_mask, p, light.z));
    projected.direction = uvec2(
        aim_within(cell >> q & direction_mask, q, rest),
        aim_within(cell & direction_mask, q, start.y));
    projected.side = cell >> (2u * p + 2u * q) << 31 | light.w >> 1;
    return projected;
}

// The disc of the aimed photons of a light that is infinitely far away: centre and radius.
vec4 projection_disc(ProjectionRef projection, ProjectionSample projected) {
    uint first = projected.first - 4u;
    return uintBitsToFloat(uvec4(projection.cells[first].at, projection.cells[first + 1u].at,
        projection.cells[first + 2u].at, projection.cells[first + 3u].at));
}

#endif

// Twin of photon-core's aim.rs: how a photon leaves that is aimed at mirrors and glass.
#ifndef AIM_GLSL
#define AIM_GLSL

struct Target {
    vec3 carried;
    uint light;
    uint first;
    uint count;
    uint point_bits;
    uint direction_bits;
};

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Targets { Target at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer AimWords { uint at; };

// The tables of an aim, and how many targets there are.
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer AimRef {
    Targets targets;
    AimWords starts;
    AimWords cells;
    uint count;
};

// Random words in the places of those that the photon was drawn by.
struct Launch {
    uint light;
    vec3 carried;
    uvec2 point;
    uvec2 direction;
    uint side;
};

// The word whose upper `bits` are `cell` and whose others are the upper ones of `random`.
uint aim_within(uint cell, uint bits, uint random) {
    return bits == 0u ? random : cell << (32u - bits) | random >> bits;
}

Launch aim_launch(AimRef aim, uvec4 light, uvec4 start) {
    uint low = 0u;
    uint high = aim.count;
    while (high - low > 1u) {
        uint middle = low + (high - low) / 2u;
        if (aim.starts[middle].at <= light.x) low = middle;
        else high = middle;
    }
    Target target = aim.targets[low].at;
    uint number, rest;
    umulExtended(start.x, target.count, number, rest);
    uint cell = aim.cells[target.first + number].at;
    uint p = target.point_bits;
    uint q = target.direction_bits;
    uint point_mask = (1u << p) - 1u;
    uint direction_mask = (1u << q) - 1u;
    Launch launch;
    launch.light = target.light;
    launch.carried = target.carried;
    launch.point = uvec2(
        aim_within(cell >> (2u * q + p) & point_mask, p, light.y),
        aim_within(cell >> (2u * q) & point_mask, p, light.z));
    launch.direction = uvec2(
        aim_within(cell >> q & direction_mask, q, rest),
        aim_within(cell & direction_mask, q, start.y));
    launch.side = cell >> (2u * p + 2u * q) << 31 | light.w >> 1;
    return launch;
}

#endif

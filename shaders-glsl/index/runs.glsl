// Runs of photons with equal Morton codes that are longer than a leaf, round by round.
#ifndef RUNS_GLSL
#define RUNS_GLSL

// Number of runs, and number of workgroups that process them.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Round {
    uint groups[3];
    uint count;
};

// First slot and length.
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Runs { uvec2 run; };

// Maximum number of workgroups: more do not use a device any better.
const uint RUN_GROUPS = 8192;

void add_run(Round round, Runs runs, uint first, uint length) {
    uint at = atomicAdd(round.count, 1);
    runs[at].run = uvec2(first, length);
    atomicMax(round.groups[0], min(at + 1, RUN_GROUPS));
}

#endif

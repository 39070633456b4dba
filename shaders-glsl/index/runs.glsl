// Runs of more than a leaf's worth of photons with one Morton code, round by round.
#ifndef RUNS_GLSL
#define RUNS_GLSL

// How many there are, and how many workgroups go through them.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Round {
    uint groups[3];
    uint count;
};

// First slot and length.
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Runs { uvec2 run; };

// More workgroups than this keep no device busier.
const uint RUN_GROUPS = 8192;

void add_run(Round round, Runs runs, uint first, uint length) {
    uint at = atomicAdd(round.count, 1);
    runs[at].run = uvec2(first, length);
    atomicMax(round.groups[0], min(at + 1, RUN_GROUPS));
}

#endif

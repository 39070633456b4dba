// What the builder of the VVH tree keeps between its kernels.
#ifndef VVH_RECORDS_GLSL
#define VVH_RECORDS_GLSL

// A level: workgroups that go through its segments, and how many there are.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhLevel {
    uint groups[3];
    uint count;
};

// The tiles of a level's segments: workgroups that go through one list of them, how many tiles there
// are, and workgroups that go through all four lists.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhJobs {
    uint groups[3];
    uint count;
    uint groups_of_four[3];
    uint unused;
};

// A segment that all workgroups split: where it is, where its own split is noted, how deep it is; how it
// is split; its first tile.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhSegments {
    uint first;
    uint size;
    uint splits;
    uint depth;
    uint left;
    uint axis;
    uint first_job;
    uint unused;
};

// A segment that one workgroup splits to the end; the depth's bit 31 tells in which of the lists.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhShorts {
    uint first;
    uint size;
    uint splits;
    uint depth;
};

// A tile: which segment, which tile of it.
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer VvhTiles {
    uint segment;
    uint tile;
};

// More workgroups than this keep no device busier.
const uint VVH_GROUPS = 8192;

#endif

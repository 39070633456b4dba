// Intermediate records of the VVH builder's kernels.
#ifndef VVH_RECORDS_GLSL
#define VVH_RECORDS_GLSL

// A level: number of workgroups that process its segments, and number of segments.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhLevel {
    uint groups[3];
    uint count;
};

// The tiles of a level's segments: number of workgroups that process one list of them, number of tiles, and
// number of workgroups that process all four lists.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhJobs {
    uint groups[3];
    uint count;
    uint groups_of_four[3];
    uint unused;
};

// A segment that many workgroups split: its photons, the index of its split, and its depth; how it is split;
// its first tile.
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

// A segment that one workgroup splits completely; bit 31 of the depth selects the buffer of lists.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhShorts {
    uint first;
    uint size;
    uint splits;
    uint depth;
};

// A tile: index of the segment, and of the tile within it.
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer VvhTiles {
    uint segment;
    uint tile;
};

// Maximum number of workgroups: more do not use a device any better.
const uint VVH_GROUPS = 8192;

#endif

// Nodes of the VVH tree to be built, level by level.
#ifndef VVH_NODES_GLSL
#define VVH_NODES_GLSL

// A level: number of workgroups that process it, number of nodes, and index of its first node.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhDepth {
    uint groups[3];
    uint count;
    uint first;
    uint unused[3];
};

// A node: its index, its first block, the number of blocks, its first split, and the first index for its
// descendants. A node with m blocks has at most 2m − 2 descendants: that range of indices is reserved for it,
// so that indices do not depend on the order of execution.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhNodes {
    uint number;
    uint first;
    uint blocks;
    uint splits;
    uint below;
    uint unused[3];
};

#endif

// Nodes of the VVH tree that are to be made, level by level.
#ifndef VVH_NODES_GLSL
#define VVH_NODES_GLSL

// A level: workgroups that go through it, how many nodes it has, and its first in the list of all.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhDepth {
    uint groups[3];
    uint count;
    uint first;
    uint unused[3];
};

// A node: its number, its first block, how many, where its splits begin, and where the nodes below it
// may be. A node with m blocks has 2m − 2 below it at most: so much of the numbers is its own, and
// numbers do not depend on who comes first.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VvhNodes {
    uint number;
    uint first;
    uint blocks;
    uint splits;
    uint below;
    uint unused[3];
};

#endif

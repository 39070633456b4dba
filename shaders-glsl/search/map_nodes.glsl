// A photon map's tree. The numbers of a point are the bits of floats, since a slot's fourth is none.
#ifndef MAP_NODES_GLSL
#define MAP_NODES_GLSL

// Bit of a node's count: it is a leaf, and the rest counts points.
const uint LEAF = 0x80000000u;
// Points in a leaf at most, and children of a node.
const uint WIDTH = 16;
// Levels of a tree at most: backend-cpu's MAX_DEPTH.
const uint LEVELS = 64;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer BoxNodes {
    // Lower corner, first child or slot.
    uvec4 low;
    // Upper corner, count.
    uvec4 high;
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Slots { uvec4 at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint at; };

#endif

// The tree of a photon map. Points are stored as the bits of floats, since a slot's fourth component is not a
// float.
#ifndef MAP_NODES_GLSL
#define MAP_NODES_GLSL

// Flag in a node's count: the node is a leaf, and the other bits are its number of points.
const uint LEAF = 0x80000000u;
// Maximum number of points in a leaf, and of children of a node.
const uint WIDTH = 16;
// Maximum depth of a tree: backend-cpu's MAX_DEPTH.
const uint LEVELS = 64;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer BoxNodes {
    // Lower corner; first child or slot.
    uvec4 low;
    // Upper corner; count.
    uvec4 high;
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Slots { uvec4 at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint at; };

#endif

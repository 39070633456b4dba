// The tree of a photon map. Points are stored as the bits of floats, since a slot's fourth component is not a
// float.
#ifndef MAP_NODES_GLSL
#define MAP_NODES_GLSL

#include "shading/constants.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer BoxNodes {
    // Lower corner; first child or slot.
    uvec4 low;
    // Upper corner; count.
    uvec4 high;
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Slots { uvec4 at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint at; };

#endif

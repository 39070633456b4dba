// How a path ended. Twin of photon-core's tally.rs, where the host sums.
#ifndef TALLY_GLSL
#define TALLY_GLSL

#include "shading/constants.glsl"

// The path has not ended.
const uint FATE_NONE = FATE_COUNT;

// Flag beside the fate: the path entered more nested solids than can be stored.
const uint TOO_DEEP = 1u << 27;
const uint SURFACES_MASK = 0x07FFFFFFu;

struct Ending {
    // Power of the path at its end.
    vec3 power;
    // Fate in the upper four bits, then TOO_DEEP; the other bits are the number of surfaces hit.
    uint fate_surfaces;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Endings { Ending at; };

#endif

// How a path ended. Twin of photon-core's tally.rs, where the host sums.
#ifndef TALLY_GLSL
#define TALLY_GLSL

const uint FATE_ABSORBED = 0u;
const uint FATE_ESCAPED = 1u;
const uint FATE_TRUNCATED = 2u;
const uint FATE_DROPPED = 3u;
const uint FATE_TERMINATED = 4u;
const uint FATE_NONE = 5u;

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

// What builders of photon maps read and write.
#ifndef MAP_RECORDS_GLSL
#define MAP_RECORDS_GLSL

#include "float_bits.glsl"

// Points to a leaf, and children of a node, at most.
const uint MAP_WIDTH = 16;
// Set in the count of a node that is a leaf.
const uint MAP_LEAF = 0x80000000u;

// The twin of `Photon`, as two rows: position and direction, power and normal.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer PhotonRows {
    uvec4 place;
    uvec4 carried;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Rows { uvec4 row; };

// Lower corner and first child or slot, upper corner and count.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer BoxNodes {
    uvec4 low;
    uvec4 high;
};

// The box of all photons as ordered integers.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer MapState {
    uint low[3];
    uint high[3];
};

// How many photons there are and fit; of the first whose power or position is not finite, the
// complement of the number, else 0.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer PhotonCount {
    uint needed;
    uint capacity;
    uint bad_power;
    uint bad_position;
};

// Position of a photon, −0 as 0.
uvec3 photon_position(PhotonRows photons, uint id) {
    uvec3 bits = photons[id].place.xyz;
    return uvec3(positive_zero(bits.x), positive_zero(bits.y), positive_zero(bits.z));
}

uvec3 ordered3(uvec3 bits) {
    return uvec3(ordered(bits.x), ordered(bits.y), ordered(bits.z));
}

uvec3 from_ordered3(uvec3 keys) {
    return uvec3(from_ordered(keys.x), from_ordered(keys.y), from_ordered(keys.z));
}

#endif

// Records that builders of photon maps read and write.
#ifndef MAP_RECORDS_GLSL
#define MAP_RECORDS_GLSL

#include "shading/constants.glsl"
#include "shading/float_bits.glsl"
#include "shading/photon_format.glsl"

// Format of the photons that a map is built from.
layout(constant_id = 2) const uint FORMAT = FORMAT_FULL;

// Photons as stored. In the full format each one is two rows, as in `Photon`: position and normal, power and
// direction. Otherwise the rows of position and normal of all photons come first, as many as the capacity,
// followed by the rest.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer PhotonRows { uvec4 place; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer FullPhotons {
    uvec4 place;
    uvec4 flux;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Rows { uvec4 row; };

// Lower corner and first child or slot; upper corner and count.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer BoxNodes {
    uvec4 low;
    uvec4 high;
};

// The bounding box of all photons as ordered integers.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer MapState {
    uint low[3];
    uint high[3];
};

// Number of photons and capacity; the complement of the index of the first photon with non-finite power, and
// with non-finite position, else 0.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer PhotonCount {
    uint needed;
    uint capacity;
    uint bad_power;
    uint bad_position;
};

// Position and normal of a photon.
uvec4 photon_place(PhotonRows photons, uint id) {
    if (FORMAT == FORMAT_FULL) return FullPhotons(photons)[id].place;
    return photons[id].place;
}

// Power and direction of a photon in a buffer of the given capacity.
uvec4 photon_flux(PhotonRows photons, uint capacity, uint id) {
    if (FORMAT == FORMAT_FULL) return FullPhotons(photons)[id].flux;
    return flux_at(FORMAT, Fluxes(photons + capacity), id);
}

// Position of a photon, with −0 as 0.
uvec3 photon_position(PhotonRows photons, uint id) {
    uvec3 bits = photon_place(photons, id).xyz;
    return uvec3(positive_zero(bits.x), positive_zero(bits.y), positive_zero(bits.z));
}

uvec3 ordered3(uvec3 bits) {
    return uvec3(ordered(bits.x), ordered(bits.y), ordered(bits.z));
}

uvec3 from_ordered3(uvec3 keys) {
    return uvec3(from_ordered(keys.x), from_ordered(keys.y), from_ordered(keys.z));
}

#endif

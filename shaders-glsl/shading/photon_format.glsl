// Photon formats: twin of photon-core's photon_format.rs. Rows of position and normal are stored in one array;
// the remaining data in a second one.
#ifndef PHOTON_FORMAT_GLSL
#define PHOTON_FORMAT_GLSL

#include "shading/constants.glsl"

// Power and direction; or power; or one power for all channels.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Fluxes { uvec4 row; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Powers { uvec3 row; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MonoPowers { uint row; };

// Power and direction of a photon; a direction that is not stored is 0.
uvec4 flux_at(uint format, Fluxes fluxes, uint number) {
    if (format == FORMAT_MONO) return uvec4(uvec3(MonoPowers(fluxes)[number].row), 0u);
    if (format == FORMAT_NO_DIRECTION) return uvec4(Powers(fluxes)[number].row, 0u);
    return fluxes[number].row;
}

void flux_put(uint format, Fluxes fluxes, uint number, uvec4 flux) {
    if (format == FORMAT_MONO) MonoPowers(fluxes)[number].row = flux.x;
    else if (format == FORMAT_NO_DIRECTION) Powers(fluxes)[number].row = flux.xyz;
    else fluxes[number].row = flux;
}

#endif

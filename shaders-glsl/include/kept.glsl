// How much is kept of a photon: twin of photon-core's kept.rs. Places are rows of their own, of position and
// normal; what else is kept stands in a second array.
#ifndef KEPT_GLSL
#define KEPT_GLSL

const uint KEPT_GREY = 0, KEPT_POWER = 1, KEPT_WHOLE = 2;

// Power and direction; or power; or one power for all channels.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Fluxes { uvec4 row; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Powers { uvec3 row; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Greys { uint row; };

// Power and direction of a photon; a direction that is not kept is 0.
uvec4 flux_at(uint kept, Fluxes fluxes, uint number) {
    if (kept == KEPT_GREY) return uvec4(uvec3(Greys(fluxes)[number].row), 0u);
    if (kept == KEPT_POWER) return uvec4(Powers(fluxes)[number].row, 0u);
    return fluxes[number].row;
}

void flux_put(uint kept, Fluxes fluxes, uint number, uvec4 flux) {
    if (kept == KEPT_GREY) Greys(fluxes)[number].row = flux.x;
    else if (kept == KEPT_POWER) Powers(fluxes)[number].row = flux.xyz;
    else fluxes[number].row = flux;
}

#endif

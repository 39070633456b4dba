// Wavelengths of light that refraction disperses. Twin of photon-core's spectrum.rs.
#ifndef SPECTRUM_GLSL
#define SPECTRUM_GLSL

#include "shading/constants.glsl"
#include "shading/scene.glsl"

// A wavelength is 0 for none, or 1 + its cell of the spectrum.
const uint NO_WAVELENGTH = 0u;

// The middle of its cell, in micrometres.
float wavelength_micrometres(uint wavelength) {
    return (float(wavelength) - 0.5) * SPECTRUM_STEP + SPECTRUM_FIRST;
}

// Draws the wavelength of light of this power by a uniform number, and multiplies the channels by their share in it.
uint spectrum_draw(SceneRef scene, inout vec3 power, float u) {
    float sum = power.x + power.y + power.z;
    float rest = u * sum;
    uint channel = 0u;
    float of = power.x;
    if (rest >= of) {
        rest -= of;
        channel = 1u;
        of = power.y;
    }
    if (channel == 1u && rest >= of) {
        rest -= of;
        channel = 2u;
        of = power.z;
    }
    // The first cell up to which the channel has more power than `rest`.
    uint low = 0u;
    uint high = SPECTRUM_CELLS - 1u;
    while (low < high) {
        uint middle = (low + high) / 2u;
        vec3 cumulative = scene.spectrum[middle].cumulative;
        float until = (channel == 0u ? cumulative.x : channel == 1u ? cumulative.y : cumulative.z) * of;
        if (until > rest) high = middle;
        else low = middle + 1u;
    }
    vec3 share = scene.spectrum[low].share;
    float mixed = power.x * share.x + power.y * share.y + power.z * share.z;
    // Not for black light, and where rounding has led to a cell without light.
    if (mixed > 0.0) {
        float scale = sum / mixed;
        power = power * (share * scale);
    }
    return low + 1u;
}

#endif

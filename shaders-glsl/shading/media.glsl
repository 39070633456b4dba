// Nested media: the stack of media at a point, and the one that has priority. Twin of photon-core's media.rs.
#ifndef MEDIA_GLSL
#define MEDIA_GLSL

#include "shading/constants.glsl"
#include "shading/flight.glsl"
#include "shading/layout.glsl"
#include "shading/random.glsl"
#include "shading/scene.glsl"
#include "shading/spectrum.glsl"

// The including kernel declares MEDIA, a specialization constant: the bits of MediaFeatures.
const bool NESTED = (MEDIA & MEDIA_NESTED) != 0u;
const bool DISPERSION = (MEDIA & MEDIA_DISPERSION) != 0u;
// Whether some medium scatters light.
const bool SCATTERING = (MEDIA & MEDIA_SCATTERING) != 0u;
// Whether some medium has a grid of densities.
const bool GRIDS = (MEDIA & MEDIA_GRIDS) != 0u;
// Whether space outside of all solids absorbs or scatters light.
const bool AMBIENT = (MEDIA & MEDIA_AMBIENT) != 0u;

// Whether media have boundaries that light passes.
const bool BOUNDARIES = (MEDIA & MEDIA_BOUNDARIES) != 0u;

// A stack of media: one byte each, the most recently entered one lowest. 0: in no medium.
const uint VACUUM = 0u;

bool media_is_full(uint stack) { return stack >> 24 != 0u; }

bool media_contains(uint stack, uint medium) {
    for (; stack != 0u; stack >>= 8) {
        if ((stack & 0xFFu) == medium) return true;
    }
    return false;
}

uint media_enter(uint stack, uint medium) { return media_is_full(stack) ? stack : stack << 8 | medium & 0xFFu; }

uint media_leave(uint stack, uint medium) {
    for (uint shift = 0u; shift < 32u && stack >> shift != 0u; shift += 8u) {
        if ((stack >> shift & 0xFFu) == medium) {
            uint below = stack & ((1u << shift) - 1u);
            // In two steps, since a shift by 32 is undefined.
            return (stack >> shift >> 8) << shift | below;
        }
    }
    return stack;
}

// Index of the current medium: the one with the highest priority; of equals, the last one entered.
uint media_current(SceneRef scene, uint stack) {
    uint found = stack & 0xFFu;
    if (!NESTED) return found;
    for (uint rest = stack >> 8; rest != 0u; rest >>= 8) {
        uint medium = rest & 0xFFu;
        if (scene.media[medium].at.priority > scene.media[found].at.priority) found = medium;
    }
    return found;
}

// In functions, since a `precise` variable computed from members of a record makes the compiler hang.
float index_quotient(float transmitted, float before) {
    precise float eta = transmitted / before;
    return eta;
}

float index_quotient_squared(float transmitted, float before) {
    precise float ratio = transmitted / before;
    precise float squared = ratio * ratio;
    return squared;
}

// A boundary between media, as the path that arrives there sees it.
struct Interface {
    float eta;
    uint before;
    uint transmitted;
    bool is_active;
    bool is_too_deep;
};

Interface media_interface(SceneRef scene, Material material, bool front, uint here) {
    if (material.kind == MATERIAL_THIN) return Interface(material.ior, here, here, true, false);
    if (material.kind != MATERIAL_DIELECTRIC) return Interface(1.0, here, here, true, false);
    if (NESTED) {
        uint before = front || media_contains(here, material.medium) ? here : media_enter(here, material.medium);
        uint transmitted = front ? media_enter(before, material.medium) : media_leave(before, material.medium);
        uint from = media_current(scene, before);
        uint to = media_current(scene, transmitted);
        float eta = index_quotient(scene.media[to].at.ior, scene.media[from].at.ior);
        return Interface(eta, before, transmitted, from != to, front && media_is_full(before));
    }
    uint solid = material.medium & 0xFFu;
    float eta = front ? material.ior : index_quotient(1.0, material.ior);
    return Interface(eta, front ? here : solid, front ? solid : VACUUM, true, false);
}

// Whether the refractive index of either side depends on the wavelength.
bool media_is_dispersive(SceneRef scene, Interface sides) {
    if (sides.before == sides.transmitted || !sides.is_active) return false;
    return scene.media[media_current(scene, sides.before)].at.dispersion != 0u
        || scene.media[media_current(scene, sides.transmitted)].at.dispersion != 0u;
}

// In a function, as the quotients above.
float sellmeier_term(float b, float c, float squared) {
    precise float term = b * squared / (squared - c);
    return term;
}

// Refractive index at a wavelength of the medium that applies.
float media_index(SceneRef scene, uint stack, uint wavelength) {
    Medium medium = scene.media[media_current(scene, stack)].at;
    if (medium.dispersion == 0u || wavelength == NO_WAVELENGTH) return medium.ior;
    float length = wavelength_micrometres(wavelength);
    float squared = length * length;
    if (medium.dispersion == MEDIUM_CAUCHY) return max(medium.terms[0] + medium.terms[1] / squared, 1.0);
    float sum = sellmeier_term(medium.terms[0], medium.terms[3], squared)
        + sellmeier_term(medium.terms[1], medium.terms[4], squared)
        + sellmeier_term(medium.terms[2], medium.terms[5], squared);
    return sqrt(max(1.0 + sum, 1.0));
}

// Makes an interface that of the wavelength of a path, which is drawn by `word` if it has none; `power` is then divided.
void media_disperse(SceneRef scene, inout Interface sides, inout uint wavelength, inout vec3 power, uint word) {
    if (wavelength == NO_WAVELENGTH) wavelength = spectrum_draw(scene, power, unit_f32(word));
    sides.eta = index_quotient(
        media_index(scene, sides.transmitted, wavelength), media_index(scene, sides.before, wavelength));
}

// Factor on radiance in the medium of `at` when light of a wavelength is observed in that of `from`.
float radiance_scale(SceneRef scene, uint from, uint at, uint wavelength) {
    if (from == at) return 1.0;
    if (DISPERSION) {
        return index_quotient_squared(media_index(scene, from, wavelength), media_index(scene, at, wavelength));
    }
    return index_quotient_squared(
        scene.media[media_current(scene, from)].at.ior, scene.media[media_current(scene, at)].at.ior);
}

// The medium that applies.
Medium media_medium(SceneRef scene, uint stack) { return scene.media[media_current(scene, stack)].at; }

#endif

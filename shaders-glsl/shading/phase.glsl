// Phase functions. Twin of photon-core's phase.rs and phase/mie.rs.
#ifndef PHASE_GLSL
#define PHASE_GLSL

#include "shading/constants.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/sampling.glsl"

// The including kernel declares MEDIA. Whether there are other phase functions than Henyey and Greenstein's.
const bool PHASES = (MEDIA & MEDIA_PHASES) != 0u;

// Medium::phase, and its parameters.
struct Phase {
    uint kind;
    float anisotropy;
    float draine;
    float alpha;
    float share;
};

Phase phase_of(Medium medium) {
    return Phase(medium.phase, medium.anisotropy, medium.draine[0], medium.draine[1], medium.draine[2]);
}

// Density of Henyey and Greenstein's for an angle of this versine and a mean cosine g >= 0.
float henyey_greenstein(float g, float versine) {
    // 1 + g^2 - 2g cos, without cancellation.
    precise float base = (1.0 - g) * (1.0 - g) + 2.0 * g * versine;
    precise float density = 0.0795774715 * (1.0 - g) * (1.0 + g) / (base * sqrt(base));
    return density;
}

// Versine of an angle with that density.
float henyey_greenstein_versine(float g, float u) {
    precise float narrow = 1.0 - g;
    precise float below = (1.0 - g) + 2.0 * g * u;
    precise float versine = 2.0 * (1.0 - u) * (1.0 + g * u) * (narrow * narrow / (below * below));
    return min(versine, 2.0);
}

// Versine of an angle whose cosine c has a density proportional to 1 + c^2: the root of c^3 + 3c = 8u - 4.
float rayleigh_versine(float u) {
    // Cardano's formula for the forward half; the other one is its mirror image.
    precise float q = abs(4.0 * u - 2.0);
    precise float square = q * q + 1.0;
    precise float cube = q + sqrt(square);
    float root = cube_root(cube);
    precise float difference = root - 1.0 / root;
    float cosine = min(difference, 1.0);
    precise float versine = u < 0.5 ? 1.0 + cosine : 1.0 - cosine;
    return versine;
}

// Density of droplets for an angle of this versine.
float mie_value(Phase phase, float versine) {
    float g = phase.draine, alpha = phase.alpha;
    precise float cosine = 1.0 - versine;
    precise float factor = (1.0 + alpha * cosine * cosine) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0);
    precise float density = (1.0 - phase.share) * henyey_greenstein(phase.anisotropy, versine)
        + phase.share * (henyey_greenstein(g, versine) * factor);
    return density;
}

const uint MIE_MAX_STEPS = 16u;

// Integral of the density of Draine's lobe from the smallest distance s = sqrt(1 + g^2 - 2g cos), `start`, to d beyond it.
float draine_integral(float start, vec3 terms, float d) {
    precise float s = start + d;
    precise float sum = d * (terms.z / (start * s) - terms.y + terms.x * (s * s + s * start + start * start));
    return sum;
}

// Versine of an angle with the density of Draine's lobe; a share u of the light is scattered by smaller ones.
float draine_versine(float g, float alpha, float u) {
    precise float start = 1.0 - g;
    precise float middle = 1.0 + g * g;
    precise float cubic = alpha / (12.0 * g * g);
    precise float linear = 6.0 * middle * cubic;
    precise float inverse = 1.0 + 3.0 * middle * middle * cubic;
    vec3 terms = vec3(cubic, linear, inverse);
    precise float wanted = u * draine_integral(start, terms, 2.0 * g);
    float low = 0.0, high = 2.0 * g;
    precise float d = high * u * u;
    for (uint i = 0u; i < MIE_MAX_STEPS; ++i) {
        precise float off = draine_integral(start, terms, d) - wanted;
        if (off > 0.0) high = d; else low = d;
        precise float s = start + d;
        precise float cosine = (middle - s * s) / (2.0 * g);
        precise float newton = d - off * (s * s) / (1.0 + alpha * cosine * cosine);
        precise float next = newton >= low && newton <= high ? newton : 0.5 * (low + high);
        precise float change = abs(next - d);
        d = next;
        if (change <= 2e-7 * d) break;
    }
    precise float versine = d * (2.0 * start + d) / (2.0 * g);
    return min(versine, 2.0);
}

float mie_versine(Phase phase, float u) {
    if (u < phase.share) {
        precise float rest = 1.0 - u / phase.share;
        return draine_versine(phase.draine, phase.alpha, rest);
    }
    precise float rest = (u - phase.share) / (1.0 - phase.share);
    return henyey_greenstein_versine(phase.anisotropy, min(rest, 1.0));
}

// Density per solid angle of scattering from one direction of travel into another.
float phase_value(Phase phase, vec3 from, vec3 to) {
    if (PHASES && phase.kind == MEDIUM_RAYLEIGH) {
        float cosine = dot3(from, to);
        precise float density = 0.0596831037 * (1.0 + cosine * cosine);
        return density;
    }
    if (PHASES && phase.kind == MEDIUM_MIE) return mie_value(phase, sampling_versine(from, to));
    return henyey_greenstein(
        abs(phase.anisotropy), sampling_versine(phase.anisotropy < 0.0 ? -from : from, to));
}

// A direction of travel with this density after travel along `from`.
vec3 phase_sample(Phase phase, vec3 from, float u, float v) {
    if (PHASES && phase.kind == MEDIUM_RAYLEIGH) return sampling_about(from, rayleigh_versine(u), v);
    if (PHASES && phase.kind == MEDIUM_MIE) return sampling_about(from, mie_versine(phase, u), v);
    vec3 axis = phase.anisotropy < 0.0 ? -from : from;
    return sampling_about(axis, henyey_greenstein_versine(abs(phase.anisotropy), u), v);
}

#endif

// Conversion of radiance to 8-bit sRGB: exposure, tone curve, sRGB. Twin of photon-core's `tone_map.rs`.
#ifndef TONE_MAP_GLSL
#define TONE_MAP_GLSL

#define TONE_MAP_NONE 0
#define TONE_MAP_REINHARD 1
#define TONE_MAP_ACES 2
#define TONE_MAP_NEUTRAL 3
#define TONE_MAP_AGX 4

// Linear up to 0.8, then a shoulder on the brightest channel (after Khronos' PBR Neutral, 2024).
vec3 tone_map_neutral(vec3 colour) {
    const float START = 0.76;
    const float PALE = 0.15;
    float low = min(colour.r, min(colour.g, colour.b));
    colour -= low < 0.08 ? low - 6.25 * low * low : 0.04;
    float peak = max(max(colour.r, max(colour.g, colour.b)), 0.0);
    if (peak < START) return colour;
    float rest = 1.0 - START;
    float shown = 1.0 - rest * rest / (peak + rest - START);
    float white = 1.0 - 1.0 / (PALE * (peak - shown) + 1.0);
    return colour * (shown / peak) * (1.0 - white) + shown * white;
}

// A logarithmic curve over 16.5 stops on mixed channels (after Sobotka's AgX, 2022). Columns of the matrices are rows here,
// hence the order of the products.
vec3 tone_map_agx(vec3 colour) {
    const mat3 MIX = mat3(0.8425, 0.0784, 0.0791, 0.0423, 0.8786, 0.0791, 0.0423, 0.0784, 0.8793);
    const mat3 UNMIX = mat3(1.1966, -0.0980, -0.0986, -0.0529, 1.1515, -0.0986, -0.0529, -0.0980, 1.1509);
    const float DARKEST = -12.47393;
    const float BRIGHTEST = 4.026069;
    vec3 x = clamp((log2(max(colour * MIX, 1e-10)) - DARKEST) / (BRIGHTEST - DARKEST), 0.0, 1.0);
    vec3 s = x * x * (3.0 - 2.0 * x);
    vec3 shown = clamp(pow(0.35 * x + 0.65 * s, vec3(1.25)) * UNMIX, 0.0, 1.0);
    // The curve gives display values; the sRGB curve is applied later, hence its inverse here.
    return mix(pow((shown + 0.055) / 1.055, vec3(2.4)), shown / 12.92, lessThanEqual(shown, vec3(0.04045)));
}

// The same colour with 0 for NaN. By bits, since compilers may take it that there is none.
vec3 without_nan(vec3 colour) {
    bvec3 bad = greaterThan(floatBitsToUint(colour) & 0x7fffffffu, uvec3(0x7f800000u));
    return mix(colour, vec3(0.0), bad);
}

// Maps a colour without NaN to [0, 1], still linear. `exposure` is finite.
vec3 tone_map(uint curve, float exposure, vec3 colour) {
    colour = clamp(colour * exposure, 0.0, 1e30);
    if (curve == TONE_MAP_REINHARD) {
        colour /= 1.0 + dot(colour, vec3(0.2126, 0.7152, 0.0722));
    } else if (curve == TONE_MAP_ACES) {
        colour = min(colour, 1e6);
        colour = colour * (2.51 * colour + 0.03) / (colour * (2.43 * colour + 0.59) + 0.14);
    } else if (curve == TONE_MAP_NEUTRAL) {
        colour = tone_map_neutral(colour);
    } else if (curve == TONE_MAP_AGX) {
        colour = tone_map_agx(colour);
    }
    return clamp(colour, 0.0, 1.0);
}

// The sRGB curve, quantized to eight bits (IEC 61966-2-1).
uvec3 encode_srgb(vec3 linear) {
    vec3 high = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    return uvec3(mix(high, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308))) * 255.0 + 0.5);
}

#endif

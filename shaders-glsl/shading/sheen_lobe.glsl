// The lobe of a sheen, without layers below: twin of photon-core's sheen_lobe.rs. Does not need a scene: the table is
// passed by its address.
#ifndef SHEEN_LOBE_GLSL
#define SHEEN_LOBE_GLSL

#include "shading/constants.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"

// Distribution and visibility of one roughness, with those of the direction that a path comes from.
struct Charlie {
    float alpha;
    float roughness;
    // Coefficients of lambda.
    float a, b, c, d, e;
    float lambda;
    // Directional albedo.
    float albedo;
};

float sheen_mix(float one, float zero, float weight) {
    precise float mixed = one + (zero - one) * weight;
    return mixed;
}

float sheen_exponent(Charlie fit, float x) {
    precise float power = -fit.c * math_ln(max(x, 1.0e-30));
    precise float exponent = fit.a / (1.0 + fit.b * exp_neg(power)) + fit.d * x + fit.e;
    return exponent;
}

float sheen_exp(float x) {
    precise float inverse = 1.0 / exp_neg(x);
    return x > 0.0 ? inverse : exp_neg(-x);
}

float sheen_lambda(Charlie fit, float cosine) {
    float x = clamp(cosine, SHEEN_MIN_COSINE, 1.0);
    if (x < 0.5) return sheen_exp(sheen_exponent(fit, x));
    precise float exponent = 2.0 * sheen_exponent(fit, 0.5) - sheen_exponent(fit, 1.0 - x);
    return sheen_exp(exponent);
}

float sheen_between(float from, float to, float share) {
    precise float mixed = from * (1.0 - share) + to * share;
    return mixed;
}

// The directional albedo, of a sheen of colour 1.
float sheen_directional(SheenAlbedos table, float cosine, float roughness) {
    precise float scaled = max(roughness - SHEEN_MIN_ROUGHNESS, 0.0) / (1.0 - SHEEN_MIN_ROUGHNESS);
    precise float column = cube_root(clamp(cosine, SHEEN_MIN_COSINE, 1.0)) * float(SHEEN_TABLE_SIZE - 1u);
    precise float row = sqrt(scaled) * float(SHEEN_TABLE_SIZE - 1u);
    uint first_column = min(uint(column), SHEEN_TABLE_SIZE - 2u), first_row = min(uint(row), SHEEN_TABLE_SIZE - 2u);
    precise float across = column - float(first_column), down = row - float(first_row);
    uint first = first_row * SHEEN_TABLE_SIZE + first_column;
    uint below = first + SHEEN_TABLE_SIZE;
    return sheen_between(
        sheen_between(table[first].at, table[first + 1u].at, across),
        sheen_between(table[below].at, table[below + 1u].at, across), down);
}

// The lobe of this roughness for a path that comes from a direction with this cosine.
Charlie charlie_new(SheenAlbedos table, float roughness, float cosine) {
    Charlie lobe;
    lobe.roughness = max(roughness, SHEEN_MIN_ROUGHNESS);
    precise float alpha = lobe.roughness * lobe.roughness;
    precise float weight = (1.0 - alpha) * (1.0 - alpha);
    lobe.alpha = alpha;
    lobe.a = sheen_mix(21.5473, 25.3245, weight);
    lobe.b = sheen_mix(3.82987, 3.32435, weight);
    lobe.c = sheen_mix(0.19823, 0.16801, weight);
    lobe.d = sheen_mix(-1.97760, -1.27393, weight);
    lobe.e = sheen_mix(-4.32054, -4.85967, weight);
    lobe.lambda = sheen_lambda(lobe, cosine);
    lobe.albedo = sheen_directional(table, cosine, lobe.roughness);
    return lobe;
}

// Its value for light from `i` towards `o`, with the half vector `h`, in the frame of the normal, limited.
float charlie_evaluate(SheenAlbedos table, Charlie lobe, vec3 o, vec3 i, vec3 h) {
    precise float sine_squared = clamp(1.0 - h.z * h.z, 1.0e-30, 1.0);
    precise float exponent = 0.5 / lobe.alpha;
    precise float tau = -exponent * math_ln(sine_squared);
    precise float distribution = (2.0 + 2.0 * exponent) * exp_neg(tau) * 0.159154943;
    precise float cosines = max(o.z, SHEEN_MIN_COSINE) * max(i.z, SHEEN_MIN_COSINE);
    precise float visibility = 0.25 / ((1.0 + lobe.lambda + sheen_lambda(lobe, i.z)) * cosines);
    float greatest = max(max(lobe.albedo, sheen_directional(table, i.z, lobe.roughness)), 1.0);
    precise float value = distribution * visibility / greatest;
    return value;
}

#endif

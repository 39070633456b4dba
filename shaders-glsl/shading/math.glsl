// Twin of photon-core's math.rs, and the arithmetic shared by the other twins.
//
// The built-in `dot` and `cross` may add in any order, so they are replaced.
#ifndef MATH_GLSL
#define MATH_GLSL

// The magnitude of `magnitude` with the sign of `sign`, including that of -0.
float copysign(float magnitude, float sign) {
    return uintBitsToFloat((floatBitsToUint(magnitude) & 0x7FFFFFFFu) | (floatBitsToUint(sign) & 0x80000000u));
}

// By the bits: a driver may assume that no number is infinite or NaN.
bool is_finite(float x) {
    return (floatBitsToUint(x) & 0x7F800000u) != 0x7F800000u;
}

bool is_nan(float x) {
    return (floatBitsToUint(x) & 0x7FFFFFFFu) > 0x7F800000u;
}

// Above 0, and neither infinite nor NaN.
bool is_positive_finite(float x) {
    return floatBitsToUint(x) - 1u < 0x7F7FFFFFu;
}

float dot3(vec3 a, vec3 b) {
    precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
    return sum;
}

vec3 cross3(vec3 a, vec3 b) {
    precise vec3 product = vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
    return product;
}

// As glam's: `fallback` for vectors that cannot be normalized.
vec3 normalize_or(vec3 v, vec3 fallback) {
    float square = dot3(v, v);
    if (!is_positive_finite(square)) return fallback;
    precise float reciprocal = 1.0 / sqrt(square);
    precise vec3 unit = v * reciprocal;
    return unit;
}

// (sin 2πt, cos 2πt) for t in [0, 1).
vec2 sin_cos_turns(float t) {
    precise float turns = t * 4.0 + 0.5;
    uint quarter = uint(turns);
    precise float r = t - float(quarter) * 0.25;
    precise float s = r * r;
    precise float sine = r * (6.2831855 + s * (-41.3417 + s * (81.6052 + s * (-76.69787 + s * 41.47289))));
    precise float cosine = 1.0 + s * (-19.739208 + s * (64.939316 + s * (-85.44285 + s * 59.22029)));
    switch (quarter & 3u) {
        case 0u: return vec2(sine, cosine);
        case 1u: return vec2(cosine, -sine);
        case 2u: return vec2(-sine, -cosine);
        default: return vec2(-cosine, sine);
    }
}

// exp(-tau) for tau >= 0; 0 from 87 on, and for NaN.
float exp_neg(float tau) {
    if (tau >= 87.0 || !is_finite(tau)) return 0.0;
    precise float scaled = -tau * 1.44269504 - 0.5;
    int whole = int(scaled);
    float w = float(whole);
    precise float rest = (-tau - w * 0.6933594) + w * 2.1219444e-4;
    precise float f = rest * 1.44269504;
    precise float p = 1.0
        + f * (0.693147181
            + f * (0.2402265
                + f * (0.05550327 + f * (0.009618026 + f * (0.0013400432 + f * 0.00015469732)))));
    precise float power = p * uintBitsToFloat(uint(127 + whole) << 23);
    return power;
}

// 1 - exp(-tau) for tau >= 0; 1 for NaN.
float one_minus_exp(float tau) {
    if (tau < 0.25) {
        precise float series = tau
            * (1.0
                - tau
                    * (0.5
                        - tau
                            * (0.16666667
                                - tau * (0.041666668 - tau * (0.008333334 - tau * 0.0013888889)))));
        return series;
    }
    precise float rest = 1.0 - exp_neg(tau);
    return rest;
}

// ln x for normal positive x.
float math_ln(float x) {
    uint bits = floatBitsToUint(x);
    int exponent = int(bits - 0x3F3504F3u) >> 23;
    precise float m = uintBitsToFloat(bits - (uint(exponent) << 23)) - 1.0;
    precise float q = 0.3333333
        + m * (-0.25000297
            + m * (0.2000147
                + m * (-0.16642248
                    + m * (0.14202174 + m * (-0.12972239 + m * (0.12712308 + m * -0.08101559))))));
    float e = float(exponent);
    precise float sum = (m - 0.5 * m * m + m * m * m * q + e * 1.4286068e-6) + e * 0.69314575;
    return sum;
}

// -ln(1 - y) for y in [0, 1).
float minus_ln_one_minus(float y) {
    if (y < 0.25) {
        precise float tail = 0.16666667 + y * (0.14285715 + y * (0.125 + y * (0.11111111 + y * 0.1)));
        precise float series = y * (1.0 + y * (0.5 + y * (0.33333334 + y * (0.25 + y * (0.2 + y * tail)))));
        return series;
    }
    precise float rest = 1.0 - y;
    return -math_ln(max(rest, 1.17549435e-38));
}

// The angle of (x, y), y >= 0, from the first axis, in turns; 0 for the zero vector.
float turns_of(float y, float x) {
    float along = abs(x);
    bool steep = y > along;
    float low = steep ? along : y;
    float high = steep ? y : along;
    precise float edge = 0.41421356 * high;
    bool diagonal = low > edge;
    precise float opposite = diagonal ? low - high : low;
    precise float adjacent = diagonal ? low + high : high;
    if (!is_positive_finite(adjacent)) return 0.0;
    precise float t = opposite / adjacent;
    precise float s = t * t;
    precise float near =
        t * (0.15915494 + s * (-0.05305078 + s * (0.031789843 + s * (-0.02204153 + s * 0.0126974825))));
    precise float low_turns = diagonal ? near + 0.125 : near;
    precise float turns = steep ? 0.25 - low_turns : low_turns;
    precise float result = x < 0.0 ? 0.5 - turns : turns;
    return result;
}

// Cube root of `x` >= 0, normal or 0.
float cube_root(float x) {
    uint bits = floatBitsToUint(x);
    if (bits - 0x00800000u >= 0x7F000000u) return 0.0;
    precise float r = uintBitsToFloat(0x54A23400u - bits / 3u);
    for (uint i = 0u; i < 3u; ++i) {
        precise float next = r + r * ((1.0 - x * r * r * r) * 0.33333333);
        r = next;
    }
    precise float y = x * r * r;
    precise float root = y + (x - y * y * y) * (r * r * 0.33333333);
    return root;
}

#endif

// Nearly lossless sums: two non-overlapping floats with 48 bits between them.
#ifndef TWO_FLOAT_GLSL
#define TWO_FLOAT_GLSL

// Adds `x` to the sum (Knuth 1969, theorem B of section 4.2.2; then Dekker 1971, who renormalizes the parts).
// No contraction, since that would destroy the error terms.
void two_add(inout float high, inout float low, float x) {
    precise float sum = high + x;
    precise float part = sum - high;
    precise float error = (high - (sum - part)) + (x - part);
    precise float rest = low + error;
    precise float total = sum + rest;
    precise float left = rest - (total - sum);
    high = total;
    low = left;
}

void two_add(inout vec3 high, inout vec3 low, vec3 x) {
    precise vec3 sum = high + x;
    precise vec3 part = sum - high;
    precise vec3 error = (high - (sum - part)) + (x - part);
    precise vec3 rest = low + error;
    precise vec3 total = sum + rest;
    precise vec3 left = rest - (total - sum);
    high = total;
    low = left;
}

// The square of `high + low` as a two-float sum (Dekker 1971, with Veltkamp's split into halves of 12 bits).
// Beyond 2^60 the parts would overflow; then only the rounded product is returned.
void two_square(float high, float low, out float square, out float rest) {
    precise float product = high * high;
    if (abs(high) > 1.0e18) {
        square = product;
        rest = 0.0;
        return;
    }
    precise float scaled = 4097.0 * high;
    precise float upper = scaled - (scaled - high);
    precise float lower = high - upper;
    precise float error = ((upper * upper - product) + 2.0 * upper * lower) + lower * lower;
    precise float left = error + 2.0 * high * low;
    square = product;
    rest = left;
}

#endif

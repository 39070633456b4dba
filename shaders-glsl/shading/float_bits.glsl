// Coordinates as bit patterns. Devices may flush denormals to zero, which would change the order of points
// relative to the CPU: so everything that decides an order is computed with integers, or with floats scaled out
// of the denormal range.
#ifndef FLOAT_BITS_GLSL
#define FLOAT_BITS_GLSL

const uint FLOAT_INFINITY = 0x7f800000u;
// 2^-149, the smallest positive float, times 2^64; and its reciprocal.
const float SMALLEST_UP = 2.5849394142282115e-26;
const float UP_SMALLEST = 3.8685626227668134e25;

// Maps −0 to 0 and leaves everything else unchanged.
uint positive_zero(uint bits) {
    return bits == 0x80000000u ? 0 : bits;
}

bool finite_bits(uint bits) {
    return (bits & FLOAT_INFINITY) != FLOAT_INFINITY;
}

// Integers in the same order as the floats, and back.
uint ordered(uint bits) {
    return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

uint from_ordered(uint key) {
    return (key & 0x80000000u) != 0 ? key & 0x7fffffffu : ~key;
}

// A float below 2^-60, times 2^64.
float scaled_up(uint bits) {
    uint sign = bits & 0x80000000u;
    uint size = bits & 0x7fffffffu;
    float scaled = size < 0x00800000u ? float(size) * SMALLEST_UP : uintBitsToFloat(size + (64u << 23));
    return uintBitsToFloat(floatBitsToUint(scaled) | sign);
}

// The bits of `high − low` rounded to nearest, for `low` ≤ `high`.
uint difference_bits(uint high, uint low) {
    if (max(high & 0x7fffffffu, low & 0x7fffffffu) >= (67u << 23)) {
        // Denormal operands are lost in rounding here, and no such difference is denormal.
        precise float plain = uintBitsToFloat(high) - uintBitsToFloat(low);
        return floatBitsToUint(plain) & 0x7fffffffu;
    }
    precise float scaled = scaled_up(high) - scaled_up(low);
    uint bits = floatBitsToUint(scaled) & 0x7fffffffu;
    // A denormal difference is exact: an integer multiple of 2^-149.
    return bits >= (65u << 23) ? bits - (64u << 23) : uint(scaled * UP_SMALLEST);
}

// Half of a number; denormal results are flushed.
uint half_bits(uint bits) {
    return (bits & FLOAT_INFINITY) >= 0x01000000u ? bits - 0x00800000u : bits & 0x80000000u;
}

// The axis on which `high − low` is largest, the lowest of equal ones; `extent` is the difference's bits.
uint longest_axis(uvec3 low, uvec3 high, out uint extent) {
    uint axis = 0;
    extent = difference_bits(high.x, low.x);
    uint other = difference_bits(high.y, low.y);
    if (other > extent) {
        axis = 1;
        extent = other;
    }
    other = difference_bits(high.z, low.z);
    if (other > extent) {
        axis = 2;
        extent = other;
    }
    return axis;
}

#endif

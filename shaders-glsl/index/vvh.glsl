// The Voxel Volume Heuristic (Wald, Günther, Slusallek 2004): the twin of backend-cpu's `plane`, which
// documents it, with the same splits bit for bit. The including file defines VVH_ROWS, the number of segments
// counted at a time.
#ifndef VVH_GLSL
#define VVH_GLSL

#include "search/lists.glsl"

// By row, then by slab.
shared uint slab_counts[VVH_ROWS * VVH_SLABS];

uint left_size(uint length) {
    uint blocks = (length + KD_TREE_WIDTH - 1) / KD_TREE_WIDTH;
    return KD_TREE_WIDTH << findMSB(blocks - 1);
}

// One photon in this many is counted.
uint vvh_stride(uint length) {
    return (length - 1) / VVH_SAMPLE + 1;
}

// 32 / extent rounded to nearest, which floating-point division does not guarantee: by long division of the
// mantissas. 0 where the segment cannot be divided into slabs.
float slab_scale(uint length, uint depth, uint extent) {
    // Up to 2^-123 the quotient is infinite; for an infinite extent it is zero.
    if (depth >= VVH_HEURISTIC_DEPTH || length <= 2 * KD_TREE_WIDTH || extent <= 0x02000000u || extent >= FLOAT_INFINITY) return 0.0;
    uint mantissa = extent & 0x007fffffu | 0x00800000u;
    uint exponent = 258 - (extent >> 23);
    uint quotient = 0x00800000u;
    if (mantissa == 0x00800000u) {
        exponent++;
    } else {
        uint rest = 0x00800000u;
        quotient = 0;
        for (uint bit = 0; bit < 24; bit++) {
            rest *= 2;
            quotient *= 2;
            if (rest >= mantissa) {
                rest -= mantissa;
                quotient++;
            }
        }
        // Never a tie, since the divisor is not a power of two.
        quotient += uint(2 * rest > mantissa);
    }
    // A carry out of the mantissa increments the exponent.
    return uintBitsToFloat((exponent << 23) + (quotient - 0x00800000u));
}

// The slab of a coordinate; slabs begin at `low`.
uint slab_of(uint coordinate, uint low, float scale) {
    uint distance = difference_bits(coordinate, low);
    precise float slabs;
    if (distance < 0x00800000u) {
        // The difference may be subnormal, which a device may flush: scale it by 2^64, and `scale` by 2^-64.
        if (scale < 1.0) return 0;
        slabs = float(distance) * SMALLEST_UP * (scale * 5.421010862427522e-20);
    } else {
        slabs = uintBitsToFloat(distance) * scale;
    }
    return min(uint(slabs), VVH_SLABS - 1);
}

// Number of photons left of the best plane through a segment whose slabs are counted in `row`.
uint best_plane(uint row, uint length) {
    uint stride = vvh_stride(length);
    uint sampled = (length - 1) / stride + 1;
    uint best = 0;
    uint best_cost = 0xffffffffu;
    uint left = 0;
    for (uint slab = 1; slab < VVH_SLABS; slab++) {
        left += slab_counts[row * VVH_SLABS + slab - 1];
        uint cost = slab * left + (VVH_SLABS - slab) * (sampled - left);
        if (left > 0 && cost < best_cost) {
            best = left;
            best_cost = cost;
        }
    }
    // ⌊best · length / sampled⌋ within 32 bits.
    best = best * (length / sampled) + best * (length % sampled) / sampled;
    uint blocks = (length + KD_TREE_WIDTH - 1) / KD_TREE_WIDTH;
    return clamp((best + KD_TREE_WIDTH / 2) / KD_TREE_WIDTH, 1, blocks - 1) * KD_TREE_WIDTH;
}

#endif

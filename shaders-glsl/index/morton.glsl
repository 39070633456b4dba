// Morton codes (Morton 1966) of three times 21 bits, interleaved, x highest: the twin of backend-cpu's `Grid`,
// in integer arithmetic throughout.
#ifndef MORTON_GLSL
#define MORTON_GLSL

#include "shading/constants.glsl"
#include "shading/float_bits.glsl"

struct Grid {
    uvec3 low;
    // Whether the box is so large that its extent overflows: then everything is halved first.
    bool halved;
    // Cells per unit of length, as a power of two.
    int exponent;
};

// The grid over a box: its longest side is divided into at most 2^21 cells.
Grid grid_over(uvec3 low, uvec3 high) {
    Grid grid;
    uint extent;
    longest_axis(low, high, extent);
    grid.halved = extent >= FLOAT_INFINITY;
    if (grid.halved) {
        low = uvec3(half_bits(low.x), half_bits(low.y), half_bits(low.z));
        high = uvec3(half_bits(high.x), half_bits(high.y), half_bits(high.z));
        longest_axis(low, high, extent);
    }
    grid.low = low;
    // The smallest e with extent ≤ 2^e.
    int above = 0;
    if (extent >= 0x00800000u) {
        above = int(extent >> 23) - 127 + int((extent & 0x007fffffu) != 0);
    } else if (extent != 0) {
        int top = findMSB(extent);
        above = top - 149 + int(extent != 1u << top);
    }
    grid.exponent = extent != 0 ? MORTON_BITS - above : 0;
    return grid;
}

// ⌊(coordinate − low)·2^exponent⌋, clamped to the grid.
uint grid_cell(uint coordinate, uint low, bool halved, int exponent) {
    if (halved) coordinate = half_bits(coordinate);
    uint bits = difference_bits(coordinate, low);
    uint size = bits >> 23;
    uint mantissa = size == 0 ? bits : (bits & 0x007fffffu) | 0x00800000u;
    int shift = max(int(size), 1) - 150 + exponent;
    uint last = (1u << MORTON_BITS) - 1;
    if (shift < 0) return min(shift > -32 ? mantissa >> -shift : 0, last);
    // Only non-finite numbers come near this.
    return shift > 7 && mantissa != 0 && findMSB(mantissa) + shift > MORTON_BITS ? last : min(mantissa << shift, last);
}

// Inserts two zeros between any two of the lowest 11 bits.
uint spread_bits(uint v) {
    v &= 0x7ffu;
    v = (v | v << 16) & 0x070000ffu;
    v = (v | v << 8) & 0x0700f00fu;
    v = (v | v << 4) & 0x430c30c3u;
    return (v | v << 2) & 0x49249249u;
}

// The Morton code of a point, lower word first.
uvec2 morton_code(Grid grid, uvec3 position) {
    uint x = grid_cell(position.x, grid.low.x, grid.halved, grid.exponent);
    uint y = grid_cell(position.y, grid.low.y, grid.halved, grid.exponent);
    uint z = grid_cell(position.z, grid.low.z, grid.halved, grid.exponent);
    uint low = spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
    uint high = spread_bits(x >> 11) << 3 | spread_bits(y >> 11) << 2 | spread_bits(z >> 11) << 1 | (x >> 10 & 1);
    return uvec2(low, high);
}

#endif

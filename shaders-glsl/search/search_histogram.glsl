// Histograms of squared distances, one set of bins for each invocation: in columns of shared memory, without
// bank conflicts, and packed in pairs unless k is too large for 16 bits.
#ifndef SEARCH_HISTOGRAM_GLSL
#define SEARCH_HISTOGRAM_GLSL

#include "search/search_pause.glsl"

// Whether a bin has 32 bits.
layout(constant_id = 7) const uint WIDE = 0;

// Words of shared memory per invocation.
const uint COLUMN = 32;
const uint BINS = WIDE != 0 ? 32 : 64;
// Log2 of the number of bins.
const uint BINS_LOG2 = WIDE != 0 ? 5 : 6;
// A bin of 16 bits saturates here.
const uint FULL = 0xFFFFu;

shared uint columns[COLUMN * gl_WorkGroupSize.x];

// Start of this invocation's column, and stride between its words. Stored, since reading the index of an
// invocation may cost as much as the rest of counting a point.
uint column_begin, column_stride;

void column_find() {
    column_begin = gl_SubgroupID * COLUMN * gl_SubgroupSize + gl_SubgroupInvocationID;
    column_stride = gl_SubgroupSize;
}

uint column_at(uint row) {
    return column_begin + row * column_stride;
}

void bins_clear() {
    for (uint row = 0; row < COLUMN; row++) columns[column_at(row)] = 0;
}

uint bin_count(uint bin) {
    if (WIDE != 0) return columns[column_at(bin)];
    return columns[column_at(bin >> 1)] >> ((bin & 1u) * 16u) & 0xFFFFu;
}

// Increments a bin, up to FULL.
void bin_add(uint bin) {
    if (WIDE != 0) {
        columns[column_at(bin)]++;
        return;
    }
    uint place = column_at(bin >> 1), shift = (bin & 1u) * 16u;
    uint word = columns[place];
    columns[place] = word + ((word >> shift & 0xFFFFu) == FULL ? 0u : 1u << shift);
}

// Shift by which the numbers of a range are reduced to bin indices.
uint bins_shift(uint range) {
    int top = findMSB(range);
    return top < int(BINS_LOG2) ? 0u : uint(top) + 1u - BINS_LOG2;
}

// Saves the bins, or the data stored in their place, or restores them.
void bins_keep() {
    for (uint row = 0; row < COLUMN; row++) keep(columns[column_at(row)]);
}

#endif

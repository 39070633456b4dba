// Counts by rank, one set of bins for each invocation: column by column in shared memory, so that
// nobody meets anybody else's, and packed in pairs unless k is too large for 16 bits.
#ifndef SEARCH_HISTOGRAM_GLSL
#define SEARCH_HISTOGRAM_GLSL

#include "search/search_pause.glsl"

// Whether a bin has 32 bits.
layout(constant_id = 7) const uint WIDE = 0;

// Words of shared memory for each invocation.
const uint COLUMN = 32;
const uint BINS = WIDE != 0 ? 32 : 64;
// Log2 of that.
const uint BINS_LOG2 = WIDE != 0 ? 5 : 6;
// A bin of 16 bits counts no further.
const uint FULL = 0xFFFFu;

shared uint columns[COLUMN * gl_WorkGroupSize.x];

// Where this invocation's column begins, and how far apart its words lie. PhotonFormat, since asking for the
// number of an invocation may cost as much as all the rest of counting a point.
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

// One more, but beyond FULL.
void bin_add(uint bin) {
    if (WIDE != 0) {
        columns[column_at(bin)]++;
        return;
    }
    uint place = column_at(bin >> 1), shift = (bin & 1u) * 16u;
    uint word = columns[place];
    columns[place] = word + ((word >> shift & 0xFFFFu) == FULL ? 0u : 1u << shift);
}

// By how much the numbers of a range are shifted for its bins to hold it.
uint bins_shift(uint range) {
    int top = findMSB(range);
    return top < int(BINS_LOG2) ? 0u : uint(top) + 1u - BINS_LOG2;
}

// Writes the bins down, or what stands in their place, or reads it again.
void bins_keep() {
    for (uint row = 0; row < COLUMN; row++) keep(columns[column_at(row)]);
}

#endif

// Sums over the k nearest photons, for weights that depend on the distance of the k-th, which is known last.
//
// Every kernel is linear in the squared distance: powers are summed times 1 and u, d² over the upper end of the range that
// contains the k-th.
#ifndef SEARCH_MOMENTS_GLSL
#define SEARCH_MOMENTS_GLSL

// Number of points nearer than the range, and in it: the latter are stored as (bits of d², slot) in place of
// the bins.
uint sure, open;
// Sums over a few points, and over all.
vec3 part0, part1;
Sum sum0, sum1;
float per_high;
// Index of the row for ids: rows are in processing order.
uint row;

void moments_begin(uint place) {
    sure = 0;
    open = 0;
    part0 = part1 = vec3(0.0);
    sum0 = sum1 = NOTHING;
    float high = uintBitsToFloat(high_bits);
    per_high = high > 1.0e-30 && high < 1.0e30 ? 1.0 / high : 0.0;
    row = place - push.first;
}

// Saves the sums, or restores them.
void moments_keep() {
    keep(sure);
    keep(open);
    sum_keep(sum0);
    sum_keep(sum1);
    keep(per_high);
}

void moments_add(vec3 power, float d2) {
    part0 += power;
    float u = d2 * per_high;
    if (KERNEL == KERNEL_EPANECHNIKOV) part1 += power * u;
}

void moments_part_end() {
    sum_add(sum0, part0);
    if (KERNEL != KERNEL_CONSTANT) sum_add(sum1, part1);
    part0 = part1 = vec3(0.0);
}

// Rows beyond k occur only if an edge was misplaced by rounding, and are collected again.
void row_add(uint number, uint bits, uint id) {
    if (number < push.k) Rows(push.results)[row * push.k + number].key = uvec2(bits, id);
}

#define ROW_NONE(number) row_add(number, 0xFFFFFFFFu, 0xFFFFFFFFu)

// Processes a point within the limit.
void collect(uint place, uint bits, uint slot) {
    accepted++;
    bool near = bits < low_bits, after = false;
    if (!near && (low_id != 0 || high_id != 0xFFFFFFFFu)) {
        uint id = push.ids[slot].at;
        near = id < low_id;
        after = id > high_id;
    }
    if (near) {
        if (MODE == ROWS) {
            row_add(sure, bits, goods[place].x);
        } else {
            vec3 power = uintBitsToFloat(goods[place]);
            if (SHADING != 0) power *= shading_factor(directions[place], staged[place].w);
            if (MODE == PAPER) power *= dot3(axes[place], normal) * push.parameter;
            moments_add(power, uintBitsToFloat(bits));
        }
        sure++;
    } else if (!after) {
        if (open < STASH) {
            columns[column_at(2 * open)] = bits;
            columns[column_at(2 * open + 1)] = slot;
        }
        open++;
    }
}

// Adds those of the points in the range that are among the k nearest; returns the squared distance of the k-th
// if there is one.
float finish(bool full) {
    uint reach = highest;
    uint kept = MODE == DENSITY ? push.k - 1 : push.k;
    uint rows = sure;
    for (uint e = 0; full && e < open; e++) {
        uint bits = columns[column_at(2 * e)];
        uint slot = columns[column_at(2 * e + 1)];
        uint rank = sure;
        for (uint f = 0; f < open; f++) {
            uint other = columns[column_at(2 * f)];
            bool before = other < bits;
            if (other == bits && f != e) {
                before = push.ids[columns[column_at(2 * f + 1)]].at < push.ids[slot].at;
            }
            rank += before ? 1 : 0;
        }
        if (rank == push.k - 1) reach = bits;
        if (rank >= kept) continue;
        if (MODE == ROWS) {
            row_add(rows, bits, push.ids[slot].at);
            rows++;
            continue;
        }
        uvec4 power = flux_at(FORMAT, push.power, slot);
        vec3 weight = vec3(MODE == PAPER ? dot3(octahedral_unpack(power.w), normal) * push.parameter : 1.0);
        if (SHADING != 0) weight *= shading_factor(power.w, push.positions[slot].at.w);
        moments_add(uintBitsToFloat(power.xyz) * weight, uintBitsToFloat(bits));
    }
    if (MODE == ROWS) {
        for (; rows < push.k; rows += 8) {
            EIGHT(ROW_NONE, rows);
        }
    } else {
        moments_part_end();
    }
    return uintBitsToFloat(reach);
}

Estimate estimate(bool full, float reach) {
    uint photons = full ? push.k : sure;
    if (MODE == PAPER && photons < push.threshold) {
        photons = 0;
        sum0 = NOTHING;
        reach = uintBitsToFloat(highest);
    }
    float divisor = reach >= NEIGHBOUR_MIN_RADIUS_SQUARED ? reach : NEIGHBOUR_MIN_RADIUS_SQUARED;
    float ratio = per_high > 0.0 ? uintBitsToFloat(high_bits) / divisor : 0.0;
    vec3 flux = sum0.total - sum0.excess;
    if (MODE == DENSITY && KERNEL != KERNEL_CONSTANT) {
        vec3 first = sum1.total - sum1.excess;
        flux = 2.0 * (flux - ratio * first);
        // Weights are not negative, but differences of nearly equal sums may be.
        flux = max(flux, vec3(0.0));
    }
    return Estimate(flux, divisor, photons, reach < NEIGHBOUR_MIN_RADIUS_SQUARED ? ESTIMATE_SINGULAR : 0u, vec2(0.0));
}

#endif

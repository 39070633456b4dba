// Locates the k-th nearest point of a query: narrows down a range of squared distances (as bits), and of ids
// among equal distances, until it contains few enough points to store them individually.
//
// The first rounds use bins of equal width over a guessed radius, whose upper end shrinks as points are found.
// The rest is resolved by bins over the bits, which are integers: exact, and at most six rounds even for the
// whole range of floats, and six more for ids.
#ifndef SEARCH_RANK_GLSL
#define SEARCH_RANK_GLSL

// The next phase of a query; phases are in this order.
const uint WIDEN = 0;
const uint NARROW = 1;
const uint SETTLE = 2;
const uint COLLECT = 3;
const uint DONE = 4;

// Maximum number of points in the last range: as many as fit in place of the bins.
const uint STASH = COLUMN / 2;

// Maximum number of rounds with guessed radii, before the method that always terminates is used.
const uint GUESSES = 6;

uint phase;
// WIDEN: the squared radius, the minimum distance of any point, bin width and its reciprocal (0: one bin), the
// highest bin that still matters.
float squared_radius, base, width, per_width;
uint top;
// The bits of the largest allowed squared radius.
uint highest;
// Number of points before the bins, or before `top`.
uint below;
// The range: bits; and ids, if the range is a single distance.
uint low_bits, high_bits, low_id, high_id;

// The upper edge of a bin, not below any distance in it; and the lower edge, not above any.
uint far_edge(uint bin) {
    if (per_width == 0.0) return floatBitsToUint(squared_radius);
    precise float edge = (base + float(bin + 1) * width * 1.000002) * 1.0000003;
    return min(floatBitsToUint(edge), floatBitsToUint(squared_radius));
}

uint near_edge(uint bin) {
    if (bin == 0 || per_width == 0.0) return 0;
    precise float edge = (base + float(bin) * width * 0.999998) * 0.9999997;
    return floatBitsToUint(edge);
}

void range_set(uint new_phase, uint low, uint high) {
    phase = new_phase;
    low_bits = low;
    high_bits = high;
    low_id = 0;
    high_id = 0xFFFFFFFFu;
}

// There are fewer than k points: all of them are used.
void rank_few() {
    range_set(COLLECT, highest + 1, highest);
}

// The number of points in the first bin above which a smaller radius is better.
uint rank_crowd() {
    return 4 * min(push.k, 0x1000000u) + 64;
}

// Begins a round.
void rank_begin() {
    bins_clear();
    below = 0;
    limit = high_bits + 1;
    if (phase == WIDEN) {
        limit = floatBitsToUint(squared_radius) + 1;
        float extent = squared_radius - base;
        width = extent / float(BINS);
        per_width = extent > 1.0e-30 && extent < 1.0e30 ? float(BINS) / extent : 0.0;
        top = BINS - 1;
    }
}

// Counts a point within the limit. WIDEN. No decision is made here: branches that diverge within a subgroup are
// executed one after another.
void rank_widen(float d2) {
    accepted++;
    uint bin = per_width > 0.0 ? min(uint(max(d2 - base, 0.0) * per_width), BINS - 1) : 0;
    if (bin <= top) {
        bin_add(bin);
        below += bin < top ? 1 : 0;
    }
}

// Shrinks the radius, after a few points. Must be called by the whole subgroup.
void rank_shrink() {
    bool fell = false;
    while (subgroupAny(below >= push.k)) {
        turns += TURNS != 0 ? 1 : 0;
        if (below >= push.k) {
            top--;
            below -= bin_count(top);
            fell = true;
        }
    }
    if (fell) limit = min(limit, far_edge(top) + 1);
    if (limit > 0 && top == 0 && per_width > 0.0 && bin_count(0) > rank_crowd()) limit = 0;
}

// Counts a point within the limit. NARROW and SETTLE.
void rank_narrow(uint bits, uint slot) {
    accepted++;
    if (phase == SETTLE && bits == low_bits) {
        uint id = push.ids[slot].at;
        if (id < low_id) below++;
        else if (id <= high_id) bin_add((id - low_id) >> bins_shift(high_id - low_id));
    } else if (bits < low_bits) {
        below++;
    } else {
        bin_add((bits - low_bits) >> bins_shift(high_bits - low_bits));
    }
}

void rank_widened(uint round) {
    uint inside = bin_count(top);
    if (top == 0 && per_width > 0.0 && inside > rank_crowd()) {
        squared_radius = uintBitsToFloat(far_edge(0));
        if (round >= 2 * GUESSES) range_set(NARROW, 0, floatBitsToUint(squared_radius));
    } else if (below + inside >= push.k) {
        // Two additional points may lie at the edges.
        range_set(inside + 2 <= STASH ? COLLECT : NARROW, near_edge(top), far_edge(top));
    } else if (floatBitsToUint(squared_radius) >= highest) {
        rank_few();
    } else {
        float factor = clamp(1.4 * float(push.k) / float(max(below + inside, 1)), 1.5, 8.0);
        // A radius that contains all points, as a last resort.
        float all = corner_distance(at, uintBitsToFloat(push.nodes[0].low.xyz), uintBitsToFloat(push.nodes[0].high.xyz));
        float wider = base + (squared_radius - base) * factor;
        if (!(wider > squared_radius) || round >= GUESSES) wider = all * 1.000001;
        if (!(wider > squared_radius)) wider = INFINITE;
        squared_radius = min(wider, uintBitsToFloat(highest));
    }
}

void rank_narrowed() {
    bool ids = phase == SETTLE;
    uint first = ids ? low_id : low_bits, last = ids ? high_id : high_bits;
    uint shift = bins_shift(last - first);
    uint bin = 0, before = below, inside = 0;
    for (; bin < BINS && before < push.k; bin++) {
        inside = bin_count(bin);
        if (before + inside >= push.k) break;
        before += inside;
    }
    if (before >= push.k || bin == BINS) {
        // The range does not contain the k-th, because of rounding at an edge.
        if (low_bits == 0 && high_bits == highest) rank_few();
        else range_set(NARROW, 0, highest);
        return;
    }
    first += bin << shift;
    last = min(last, first + ((1u << shift) - 1));
    if (ids) {
        low_id = first;
        high_id = last;
        if (inside <= STASH) phase = COLLECT;
    } else {
        range_set(inside <= STASH ? COLLECT : NARROW, first, last);
        if (phase == NARROW && first == last) {
            phase = SETTLE;
            high_id = push.points - 1;
        }
    }
}

// The collected points contain the k-th, unless an edge was misplaced by rounding.
void rank_collected(uint sure, uint open) {
    bool enough = sure < push.k && sure + open >= push.k;
    if (low_bits > high_bits || (enough && open <= STASH)) phase = DONE;
    else if (enough) range_set(NARROW, low_bits, high_bits);
    else range_set(NARROW, 0, floatBitsToUint(squared_radius));
}

// Saves the state of a query, or restores it.
void rank_keep() {
    keep(phase);
    keep(squared_radius);
    keep(base);
    keep(width);
    keep(per_width);
    keep(top);
    keep(highest);
    keep(below);
    keep(low_bits);
    keep(high_bits);
    keep(low_id);
    keep(high_id);
}

// Ends a round.
void rank_end(uint round) {
    if (phase == WIDEN) rank_widened(round);
    else rank_narrowed();
}

#endif

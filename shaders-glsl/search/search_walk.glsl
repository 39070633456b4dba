// One tree traversal for all queries of a tile.
//
// A child is visited if the box around all balls of the tile overlaps it, and then any individual ball does.
// Points of visited leaves are staged in shared memory, two leaves at a time, and every invocation tests each
// of them against its own query: no divergence, and one load per tile.
//
// The kernel defines, before it includes this file,
// - vec3 at, uint limit: the query, and one more than the bits of the squared radius; 0 for none,
// - shared uvec4 staged[]: points, TILE_POINTS per tile,
// - stage(mode, place, slot): stores the point of a slot at position `place` of `staged`,
// - visit(mode, firsts): processes the staged points, two leaves whose first slots these are,
// - uint VISIT_TURNS: maximum number of loop iterations of a visit;
// and may #define SEARCH_NEAREST, for searches that need no more than k of many equal points (they count
// accepted points in `accepted`), or SEARCH_COUNT, which counts whole nodes at once (in `found`), or SEARCH_SEGMENT, for
// searches along segments instead of in balls, with two functions of its own:
// - bool touches(low, high): whether the query may have points in a box,
// - bounds(low, high): a box around all points that the query may have.
//
// A traversal that has to pause sets `paused` and returns; its state is then saved, and restored when the
// traversal continues. The kernel saves the state of its queries itself.
#ifndef SEARCH_WALK_GLSL
#define SEARCH_WALK_GLSL

#include "search/search_pause.glsl"

// First child and a mask of the children still to be visited, level by level.
shared uvec2 walk_stack[TILES * KD_TREE_MAX_DEPTH];

// Barrier between writing shared memory and reading what others wrote; it does not affect buffers, whose loads
// may be moved across.
void tile_barrier() {
    controlBarrier(gl_ScopeSubgroup, gl_ScopeSubgroup, gl_StorageSemanticsShared, gl_SemanticsAcquireRelease);
}

// Whether any ball overlaps a box.
bool meets(vec3 low, vec3 high) {
#ifdef SEARCH_SEGMENT
    return subgroupAny(limit > 0 && touches(low, high));
#else
    return subgroupAny(floatBitsToUint(box_distance(at, low, high)) < limit);
#endif
}

void walk(uint mode) {
    BoxNodes nodes = push.nodes;
    uint lane = gl_SubgroupInvocationID;
    uint levels = gl_SubgroupID * KD_TREE_MAX_DEPTH;
    // The box around all balls, enlarged enough to make rounding and underflow irrelevant.
    vec3 low = vec3(INFINITE), high = vec3(-INFINITE);
#ifdef SEARCH_SEGMENT
    if (limit > 0) bounds(low, high);
#else
    if (limit > 0) {
        float reach = limit > INFINITE_BITS ? INFINITE : sqrt(uintBitsToFloat(limit - 1)) * 1.00001 + 4.0e-19;
        bool all_of_it = floatBitsToUint(reach) >= INFINITE_BITS;
        low = all_of_it ? vec3(-INFINITE) : at - reach;
        high = all_of_it ? vec3(INFINITE) : at + reach;
    }
#endif
    low = subgroupMin(low);
    high = subgroupMax(high);
    vec3 middle = 0.5 * low + 0.5 * high;

    // The root as the only child of a virtual node.
    uint first = 0, mask = 1, depth = 0;
    uint next = KD_TREE_WIDTH;
    uvec2 firsts = uvec2(0), counts = uvec2(0);
    uint pending = 0;
#ifdef SEARCH_NEAREST
    // A run of equal points, processed one leaf's worth at a time.
    uint same_first = 0, same_left = 0, same_start = 0, limit_then = 0;
    // Its position, first slot, and the number of points accepted in earlier nodes of the run.
    vec3 same_at = vec3(0.0);
    uint same_last = 0xFFFFFFFFu, same_taken = 0;
#endif
    bool more = true;
    for (;;) {
        if (TURNS != 0) paused = !resumed && more && turns > TURNS;
        if (TURNS != 0 && (resumed || paused)) {
            pause_begin(0);
            keep(low);
            keep(high);
            keep(first);
            keep(mask);
            keep(depth);
            keep(next);
            keep(firsts);
            keep(counts);
            keep(pending);
#ifdef SEARCH_NEAREST
            keep(same_first);
            keep(same_left);
            keep(same_start);
            keep(limit_then);
            keep(same_at);
            keep(same_last);
            keep(same_taken);
#endif
            for (uint level = lane; level < depth; level += gl_SubgroupSize) keep(walk_stack[levels + level]);
            tile_barrier();
            middle = 0.5 * low + 0.5 * high;
            resumed = false;
        }
        if (!more || paused) break;
        turns += TURNS != 0 ? 4 : 0;
        bool flush = false, same_ends = false;
        uvec2 leaf = uvec2(0);
#ifdef SEARCH_NEAREST
        if (same_left > 0) {
            // Equal points are in id order: after k of them no other can be among the nearest.
            if (same_taken + accepted - same_start >= push.k && limit > 0) {
                limit_then = limit;
                limit = 0;
            }
            if (meets(same_at, same_at)) {
                leaf = uvec2(same_first, min(same_left, KD_TREE_WIDTH));
                same_first += leaf.y;
                same_left -= leaf.y;
            } else {
                same_left = 0;
            }
            // Processes the last of them before anything else adds to the accepted points.
            same_ends = same_left == 0;
            flush = same_ends;
        } else
#endif
        if (mask == 0) {
            if (depth == 0) {
                more = false;
            } else {
                depth--;
                first = walk_stack[levels + depth].x;
                mask = walk_stack[levels + depth].y;
            }
        } else {
            uint child = next < KD_TREE_WIDTH ? next : findLSB(mask);
            next = KD_TREE_WIDTH;
            uint number = first + child;
            uvec4 node_low = nodes[number].low, node_high = nodes[number].high;
            vec3 box_low = uintBitsToFloat(node_low.xyz), box_high = uintBitsToFloat(node_high.xyz);
            bool is_leaf = (node_high.w & KD_TREE_LEAF) != 0;
            bool enter = meets(box_low, box_high);
            bool take = true;
#ifdef SEARCH_NEAREST
            bool same = enter && !is_leaf && box_low == box_high;
            // Processes pending points first, since they belong to other positions.
            if (same && pending > 0) {
                next = child;
                flush = true;
                take = false;
            }
#endif
            if (take) {
                mask &= ~(1u << child);
#ifdef SEARCH_COUNT
                if (enter) {
                    bool touched = floatBitsToUint(box_distance(at, box_low, box_high)) < limit;
                    bool inside = floatBitsToUint(corner_distance(at, box_low, box_high)) < limit;
                    if (!subgroupAny(touched && !inside)) {
                        if (touched) found += is_leaf ? node_high.w & ~KD_TREE_LEAF : push.totals[number].at;
                        enter = false;
                    }
                }
#endif
                if (enter && is_leaf) {
                    leaf = uvec2(node_low.w, node_high.w & ~KD_TREE_LEAF);
                }
#ifdef SEARCH_NEAREST
                else if (same) {
                    same_left = push.totals[number].at;
                    same_start = accepted;
                    uint below = node_low.w;
                    while ((nodes[below].high.w & KD_TREE_LEAF) == 0) {
                        below = nodes[below].low.w;
                        turns += TURNS != 0 ? 1 : 0;
                    }
                    same_first = nodes[below].low.w;
                    // Earlier nodes at the same position come before these.
                    if (!(same_at == box_low && same_first > same_last)) same_taken = 0;
                    same_at = box_low;
                    same_last = same_first;
                }
#endif
                else if (enter) {
                    if (mask != 0) {
                        tile_barrier();
                        if (lane == 0) walk_stack[levels + depth] = uvec2(first, mask);
                        tile_barrier();
                        depth++;
                    }
                    first = node_low.w;
                    mask = 0;
                    uint nearest = 0xFFFFFFFFu;
                    for (uint from = 0; from < KD_TREE_WIDTH; from += gl_SubgroupSize) {
                        uint i = from + lane;
                        bool met = false;
                        uint key = 0xFFFFFFFFu;
                        if (i < node_high.w && i < KD_TREE_WIDTH) {
                            vec3 child_low = uintBitsToFloat(nodes[first + i].low.xyz);
                            vec3 child_high = uintBitsToFloat(nodes[first + i].high.xyz);
                            met = all(lessThanEqual(child_low, high)) && all(greaterThanEqual(child_high, low));
                            uint gap = floatBitsToUint(box_distance(middle, child_low, child_high));
                            if (met) key = (gap & ~15u) | i;
                        }
                        mask |= subgroupBallot(met).x << from;
                        nearest = min(nearest, subgroupMin(key));
                    }
                    // The nearest child first, as its points may make visiting the others unnecessary.
                    next = nearest & 15u;
                    // For infinite balls there is no centre.
                    if ((mask >> next & 1u) == 0) next = KD_TREE_WIDTH;
                }
            }
        }
        if (leaf.y > 0) {
            if (pending == 0) {
                firsts.x = leaf.x;
                counts.x = leaf.y;
            } else {
                firsts.y = leaf.x;
                counts.y = leaf.y;
            }
            pending++;
        }
        if (pending == 2 || (pending > 0 && (flush || !more))) {
            for (uint i = lane; i < TILE_POINTS; i += gl_SubgroupSize) {
                uint j = i & (KD_TREE_WIDTH - 1);
                uint place = gl_SubgroupID * TILE_POINTS + i;
                if (j < (i < KD_TREE_WIDTH ? counts.x : counts.y)) {
                    stage(mode, place, (i < KD_TREE_WIDTH ? firsts.x : firsts.y) + j);
                } else {
                    // NaN: never accepted.
                    staged[place] = uvec4(0x7FC00000u);
                }
            }
            turns += TURNS != 0 ? TILE_POINTS / gl_SubgroupSize + VISIT_TURNS + 2 : 0;
            tile_barrier();
            visit(mode, firsts);
            tile_barrier();
            pending = 0;
            counts = uvec2(0);
        }
#ifdef SEARCH_NEAREST
        if (same_ends) {
            same_taken += accepted - same_start;
            if (limit_then > 0) limit = limit_then;
            limit_then = 0;
        }
#endif
    }
}

#endif

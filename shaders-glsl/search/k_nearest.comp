// Exact k nearest photons, ties by lower id: estimates from them, or their ids. Twin of backend-cpu's
// estimate.rs, `Search::KNearest` and `Search::Paper`, and of its index/nearest.rs.
//
// No list of k photons is stored: a histogram determines a range of distances that contains the k-th, and a
// second traversal sums the nearer photons and stores the few photons within the range individually.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_memory_scope_semantics : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_shuffle : require
layout(local_size_x_id = 1) in;

// Result: estimates, estimates as in the paper, or rows of (bits of d², id).
layout(constant_id = 6) const uint MODE = 0;
const uint DENSITY = 0, PAPER = 1, ROWS = 2;
layout(constant_id = 4) const uint KERNEL = 0;
// Whether photons are filtered by normal or, in the paper's mode, by direction.
layout(constant_id = 5) const uint FILTER = 1;

#include "shading/constants.glsl"
#include "shading/kernel.glsl"
#include "shading/octahedral.glsl"
#include "shading/gloss_caustics.glsl"
#include "shading/reflection_lobe.glsl"
#include "shading/shading_normal.glsl"
#include "search/search_map.glsl"
#include "search/search_distance.glsl"
#include "search/search_sum.glsl"

// What photons are weighted by: nothing, the cosine to the query's shading normal, or the reflection of the query.
layout(constant_id = 10) const uint SHADING = 0;
const uint REFLECTED = 2;
// The same, which may be anisotropic.
const uint ANISOTROPIC = 3;
// The same, which may be that of a sheen.
const uint SHEEN_OR_OTHER = 4;

// Whether photons count for some queries only; REFLECTED or a higher one.
layout(constant_id = 11) const bool MARKED = false;

// Positions; then normals or directions, and powers or ids.
shared uvec4 staged[TILES * TILE_POINTS];
shared vec3 axes[TILES * TILE_POINTS];
shared uvec3 goods[TILES * TILE_POINTS];
// Packed directions that photons came from, if `SHADING`.
shared uint directions[SHADING != 0 ? TILES * TILE_POINTS : 1];

// Parameters that every photon needs.
Slots positions;
Fluxes fluxes;
float min_cosine;

vec3 at, normal;
// The shading normal, if `SHADING`.
vec3 shading;
// From `REFLECTED` on.
ReflectionLobe lobe;
// Its packed direction towards the viewer, if MARKED.
uint query_mark;
// From `ANISOTROPIC` on.
vec2 widths;
// If `SHEEN_OR_OTHER`.
Charlie sheen;
bool is_sheen;

Albedos albedos() { return Albedos(push.albedos); }

// Factor on the power of a photon, whose packed direction and normal these are.
vec3 shading_factor(uint direction, uint photon_normal) {
    if (SHADING == 0) return vec3(1.0);
    if (MARKED && !gloss_caustics_counts(direction, query_mark)) return vec3(0.0);
    vec3 from = octahedral_unpack(direction), geometric = octahedral_unpack(photon_normal);
    if (SHADING == REFLECTED) return lobe_weight(albedos(), lobe, from, geometric);
    if (SHADING == SHEEN_OR_OTHER && is_sheen) return lobe_weight_sheen(albedos(), lobe, sheen, from, geometric);
    if (SHADING >= ANISOTROPIC) return lobe_weight_anisotropic(albedos(), lobe, widths, from, geometric);
    return vec3(shading_cosine_ratio(from, geometric, shading));
}
uint limit, accepted;

layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Rows { uvec2 key; };

#define SEARCH_NEAREST
#include "search/search_histogram.glsl"
#include "search/search_guess.glsl"
#include "search/search_rank.glsl"
#include "search/search_moments.glsl"

void stage(uint mode, uint place, uint slot) {
    uvec4 point = positions[slot].at;
    staged[place] = point;
    if (MODE == ROWS) {
        if (mode == COLLECT) goods[place].x = push.ids[slot].at;
        return;
    }
    if (mode == COLLECT || MODE == PAPER) {
        uvec4 power = flux_at(FORMAT, fluxes, slot);
        goods[place] = power.xyz;
        if (SHADING != 0) directions[place] = power.w;
        if (MODE == PAPER) axes[place] = octahedral_unpack(power.w);
    }
    if (MODE == DENSITY && FILTER != 0) axes[place] = octahedral_unpack(point.w);
}

bool accepts(uint place) {
    if (FILTER == 0) return true;
    float cosine = dot3(axes[place], normal);
    return MODE == PAPER ? cosine > 0.0 : cosine >= min_cosine;
}

// The bits of the squared distance to a staged point; all ones if it is rejected.
uint look(uint place) {
    uint bits = floatBitsToUint(point_distance(at, uintBitsToFloat(staged[place].xyz)));
    return bits < limit && accepts(place) ? bits : 0xFFFFFFFFu;
}

void widen(uint place) {
    uint bits = look(place);
    if (bits != 0xFFFFFFFFu) rank_widen(uintBitsToFloat(bits));
}

void narrow(uint place, uint slots) {
    uint bits = look(place);
    if (bits != 0xFFFFFFFFu) rank_narrow(bits, slots + place);
}

void take(uint place, uint slots) {
    uint bits = look(place);
    if (bits != 0xFFFFFFFFu) collect(place, bits, slots + place);
}

#define NARROW_AT(place) narrow(place, slots)
#define TAKE_AT(place) take(place, slots)

void visit(uint mode, uvec2 firsts) {
    uint begin = gl_SubgroupID * TILE_POINTS;
    for (uint part = 0; part < TILE_POINTS; part += 8) {
        // Offset to convert a staging position into a slot.
        uint slots = part < KD_TREE_WIDTH ? firsts.x - begin : firsts.y - begin - KD_TREE_WIDTH;
        if (mode == WIDEN) {
            EIGHT(widen, begin + part);
            rank_shrink();
        } else if (mode == COLLECT) {
            // Eight copies of a reflection take long to compile and gain nothing.
            if (SHADING >= REFLECTED) {
                for (uint i = 0; i < 8; i++) TAKE_AT(begin + part + i);
            } else {
                EIGHT(TAKE_AT, begin + part);
            }
            if (MODE != ROWS) moments_part_end();
        } else {
            EIGHT(NARROW_AT, begin + part);
        }
    }
}

const uint VISIT_TURNS = TILE_POINTS / 8 * (SHADING >= REFLECTED ? 11 : 2) + 1;
#include "search/search_walk.glsl"

// Loop iterations of a round besides those of its traversal, including an initial guess.
const uint ROUND_TURNS = COLUMN + BINS + KD_TREE_MAX_DEPTH;

void query_keep(inout uint round) {
    pause_begin(PAUSE_KERNEL);
    keep(round);
    keep(limit);
    keep(accepted);
    rank_keep();
    moments_keep();
    bins_keep();
}

// Initializes a query before the traversal.
void ask(uint index) {
    at = push.queries[index].at.position;
    normal = push.queries[index].at.normal;
    if (SHADING != 0) shading = octahedral_unpack(push.queries[index].at.shading_normal);
    if (MARKED) query_mark = push.queries[index].at.offset_or_wo;
    if (SHADING == REFLECTED) {
        uvec2 words = uvec2(push.queries[index].at.media, push.queries[index].at.coat);
        lobe = lobe_new(albedos(), words, octahedral_unpack(push.queries[index].at.offset_or_wo), shading);
    }
    if (SHADING >= ANISOTROPIC) {
        uvec2 words = uvec2(push.queries[index].at.media, push.queries[index].at.coat);
        lobe = lobe_anisotropic(albedos(), words, push.queries[index].at.path,
            octahedral_unpack(push.queries[index].at.offset_or_wo), shading, widths);
        if (SHADING == SHEEN_OR_OTHER) {
            is_sheen = lobe_is_sheen(words);
            if (is_sheen) sheen = lobe_sheen(albedos(), words, lobe.wo);
        }
    }
    precise float radius = MODE == ROWS ? push.radius : push.queries[index].at.radius * push.radius;
    precise float most = radius * radius;
    phase = DONE;
    highest = floatBitsToUint(most);
    range_set(DONE, highest + 1, highest);
    if (push.k == 0 || push.points == 0 || is_nan(most) || is_nan(at.x) || is_nan(at.y) || is_nan(at.z)) return;
    base = box_distance(at, uintBitsToFloat(push.nodes[0].low.xyz), uintBitsToFloat(push.nodes[0].high.xyz));
    if (floatBitsToUint(base) > highest) return;
    if (push.points < push.k) {
        rank_few();
        return;
    }
    phase = WIDEN;
}

// An initial search radius for all queries of the tile.
void guess() {
    bool wanted = phase == WIDEN;
    uvec4 all = subgroupBallot(wanted);
    if (any(notEqual(all, uvec4(0)))) {
        vec3 middle = subgroupShuffle(at, subgroupBallotFindLSB(all));
        float shared_guess = guess_together(middle, push.k);
        if (wanted) {
            bool near = point_distance(at, middle) <= 16.0 * shared_guess;
            squared_radius = near ? shared_guess : guess_alone(at, push.k);
        }
    }
    squared_radius = max(squared_radius, base);
    if (floatBitsToUint(squared_radius) > highest) squared_radius = uintBitsToFloat(highest);
}

// Traverses the tree until all queries of the tile are answered, or the traversal pauses.
void search(uint place) {
    uint round = 0;
    if (resumed) query_keep(round);
    else guess();
    for (;; round++) {
        uint mode = subgroupMin(phase);
        if (mode == DONE) return;
        bool busy = phase == mode;
        if (!resumed) {
            turns += TURNS != 0 ? ROUND_TURNS : 0;
            limit = 0;
            below = 0;
            if (busy && mode < COLLECT) rank_begin();
            if (busy && mode == COLLECT) {
                limit = high_bits + 1;
                moments_begin(place);
            }
        }
        walk(mode);
        if (paused) {
            query_keep(round);
            return;
        }
        if (busy && mode < COLLECT) rank_end(round);
        if (busy && mode == COLLECT) rank_collected(sure, open);
    }
}

void main() {
    if (MODE != ROWS && gl_LocalInvocationIndex == 0 && workgroup() == 0 && push.first == 0) {
        push.result_count[0].at = min(push.query_count[0].at, push.query_count[1].at);
    }
    positions = push.positions;
    fluxes = push.power;
    min_cosine = push.min_cosine;
    uvec2 own;
    if (!own_queries(own) || (TURNS != 0 && !pause_open())) return;
    column_find();
    uint place = own.x + gl_SubgroupInvocationID;
    bool asked = place < own.y;
    uint index = asked && ORDERED != 0 ? push.order[place].at : place;
    at = vec3(0.0);
    normal = vec3(0.0);
    shading = vec3(0.0);
    accepted = 0;
    highest = 0;
    moments_begin(place);
    range_set(DONE, 1, 0);
    base = 0.0;
    squared_radius = 0.0;
    if (asked) ask(index);
    search(place);
    if (!paused && asked) {
        bool full = sure + open >= push.k && push.k > 0;
        float reach = finish(full);
        if (MODE != ROWS && index < push.capacity) Estimates(push.results)[index].at = estimate(full, reach);
    }
    if (TURNS != 0) pause_close();
}

// Photon tracing: twin of backend-cpu's trace.rs.
//
// One dispatch traces paths for a limited number of surfaces; the state of active paths is saved, compacted,
// and continued by the next dispatch, so that no dispatch runs for long, however long the paths are. An
// invocation takes paths by its quota, or one after another from a shared counter. It appends photons to a
// shared buffer, each with the path's index and the number of photons that the path stored before, by which
// they are put in order afterwards.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_EXT_control_flow_attributes : require

layout(local_size_x_id = 1) in;
layout(constant_id = 0) const uint FEATURES = 511;
layout(constant_id = 2) const uint RANDOM = 0;
// Bit mask of the maps that are stored: those on surfaces, then those in media that scatter light. Light straight from a light
// source leaves no photons in media: its bit there is that of photons on surfaces that were last scattered in a medium.
layout(constant_id = 3) const uint WANTED = 7;
layout(constant_id = 4) const bool DYNAMIC = true;
// When fewer rays of a subgroup than this are being traced, the finished ones are processed first: shaded, or
// replaced by the next path's.
layout(constant_id = 5) const uint BUSY = 0;
// Whether paths are aimed: they end at the first diffuse surface, and store no photon that comes directly from a
// light.
layout(constant_id = 6) const bool AIMED = false;
layout(constant_id = 7) const uint MEDIA = 1;
// Whether aimed paths store photons for the reflection of glossy surfaces only, and end there.
layout(constant_id = 8) const bool REFLECTIONS = false;
// Whether those are of all lights, with a mark.
layout(constant_id = 11) const bool ALL_LIGHTS = false;

#include "device/counter.glsl"
#include "device/grid.glsl"
#include "shading/octahedral.glsl"
#include "shading/random.glsl"
#include "shading/scene.glsl"
#include "shading/gloss_caustics.glsl"
#include "shading/photon_sample.glsl"
#include "shading/scattering.glsl"
#include "shading/shade.glsl"
#include "shading/stretches.glsl"
#include "stages/tally.glsl"

const uint WANTED_IN_MEDIA = WANTED >> MAP_COUNT;
const bool IN_MEDIA = WANTED_IN_MEDIA != 0u;
const bool FROM_MEDIA = (WANTED_IN_MEDIA >> MAP_DIRECT & 1u) != 0u;

// Path index, and ordinal << MAP_BITS | map.
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Owners { uvec2 at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Counts { uint at; };
// Next path to be taken in a dispatch, and number of paths given to it: two counters.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Round {
    uint taken;
    uint given;
};

// An active path, saved between two dispatches.
struct State {
    vec3 origin;
    // With SCATTERING also the number of collisions << 16, and `from_medium` << 31.
    uint bounce;
    vec3 direction;
    uint media;
    vec3 power;
    // Flags: only specular surfaces so far; a fifth nested solid was ignored; number of total reflections << 2; the
    // wavelength << 16.
    uint flags;
    // Number of photons stored in each map so far.
    uint stored[MAP_COUNT];
    uint numbers;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer States { State at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Waiting { uint at; };

// Parameters of one chunk of paths, the same for all its dispatches.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Chunk {
    // An array of `count` words for each map, on surfaces and in media: number of photons that each path stored in it. Those in
    // media are kept there between dispatches too.
    Counts stored;
    Endings endings;
    States states;
    uvec2 seed;
    uint pass;
    // Index of the first ray of this chunk.
    uint first;
    uint count;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Chunk chunk;
    // Parameters needed at every surface.
    SceneRef scene;
    PhotonRays rays;
    Photons photons;
    Owners owners;
    Counter place;
    // Counters of this dispatch and of the next one.
    Round now;
    Round then;
    Waiting waiting;
    Waiting left;
    // Maximum number of paths per invocation, and of surfaces and collisions that each is traced for.
    uint quota;
    uint surfaces;
    uint begins;
    uint places;
    uint max_bounces;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

bool is_finite3(vec3 v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }

vec3 over(vec3 power, float share) {
    precise vec3 left = power / share;
    return left;
}

// The next path for this invocation, as an index among the given ones; `given` if there is none left.
uint next_path(inout uint turn, uint given) {
    if (turn >= push.quota) return given;
    uint threads = gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_WorkGroupSize.x;
    uint number = turn * threads + thread();
    if (DYNAMIC) number = counter_take(Counter(push.now));
    ++turn;
    return min(number, given);
}

// An active path.
struct Path {
    uint index;
    uint left;
    Sampler numbers;
    Ray ray;
    vec3 power;
    uint bounce;
    // Number of collisions in media. Only with SCATTERING.
    uint collisions;
    // Whether the light was last scattered in a medium. Only with FROM_MEDIA.
    bool from_medium;
    uint media;
    uint wavelength;
    bool specular_only;
    bool too_deep;
    // Number of total reflections.
    uint total;
    uint stored[MAP_COUNT];
    uint stored_in_media[MAP_COUNT];
};

// The path's random word, which decides what it meets where that is random.
uint layer(Path path) {
    if (!RANDOM_SURFACES) return 0u;
    uint block = BLOCK_SURFACES + path.bounce;
    if (SCATTERING) block += path.collisions;
    return sampler_words(path.numbers, block).w;
}

// The place of the number of photons in media that a path has stored in a map.
Counts counts_in_media(uint path, uint map) { return push.chunk.stored[(MAP_COUNT + map) * push.chunk.count + path]; }

void keep_counts_in_media(Path path) {
    [[unroll]] for (uint map = 0u; map < MAP_COUNT; ++map) {
        if ((WANTED_IN_MEDIA >> map & 1u) != 0u) counts_in_media(path.index, map).at = path.stored_in_media[map];
    }
}

Path begin(uint number) {
    Path path;
    path.index = push.begins != 0u ? number : push.waiting[number].at;
    path.left = push.surfaces;
    PhotonRay start = push.rays[push.chunk.first + path.index].at;
    uint domain = AIMED ? DOMAIN_AIMED : DOMAIN_PHOTON;
    path.numbers = sampler_new(RANDOM, push.chunk.seed, push.chunk.pass, domain, start.path);
    if (push.begins != 0u) {
        if (RANDOM == RANDOM_LCG) {
            // The random sequence continues where emission left it.
            sampler_words(path.numbers, 0u);
            sampler_words(path.numbers, 0u);
        }
        path.ray = Ray(start.origin, start.direction, NO_LIMIT);
        path.power = start.power;
        path.bounce = 0u;
        if (SCATTERING) path.collisions = 0u;
        path.from_medium = false;
        path.media = start.media;
        path.wavelength = NO_WAVELENGTH;
        path.specular_only = true;
        path.too_deep = false;
        path.total = 0u;
        [[unroll]] for (uint map = 0u; map < MAP_COUNT; ++map) {
            path.stored[map] = 0u;
            path.stored_in_media[map] = 0u;
        }
        return path;
    }
    State state = push.chunk.states[path.index].at;
    path.numbers.state = state.numbers;
    path.ray = Ray(state.origin, state.direction, NO_LIMIT);
    path.power = state.power;
    path.bounce = state.bounce;
    if (SCATTERING) {
        path.bounce &= 0xFFFFu;
        path.collisions = state.bounce >> 16 & 0x7FFFu;
    }
    path.from_medium = FROM_MEDIA && state.bounce >> 31 != 0u;
    path.media = state.media;
    path.specular_only = (state.flags & 1u) != 0u;
    path.too_deep = NESTED && (state.flags & 2u) != 0u;
    path.total = state.flags >> 2;
    path.wavelength = NO_WAVELENGTH;
    if (DISPERSION) {
        path.total &= 0x3FFFu;
        path.wavelength = state.flags >> 16;
    }
    path.stored = state.stored;
    [[unroll]] for (uint map = 0u; map < MAP_COUNT; ++map) {
        bool kept = (WANTED_IN_MEDIA >> map & 1u) != 0u;
        path.stored_in_media[map] = kept ? counts_in_media(path.index, map).at : 0u;
    }
    return path;
}

void keep(Path path) {
    State state;
    state.origin = path.ray.origin;
    state.bounce = path.bounce;
    if (SCATTERING) state.bounce |= path.collisions << 16;
    if (FROM_MEDIA && path.from_medium) state.bounce |= 0x80000000u;
    state.direction = path.ray.direction;
    state.media = path.media;
    state.power = path.power;
    state.flags = (path.specular_only ? 1u : 0u) | (path.too_deep ? 2u : 0u) | (path.total << 2);
    if (DISPERSION) state.flags |= path.wavelength << 16;
    state.stored = path.stored;
    state.numbers = path.numbers.state;
    push.chunk.states[path.index].at = state;
    if (IN_MEDIA) keep_counts_in_media(path);
    push.left[counter_take(Counter(push.then) + 1)].at = path.index;
}

// Number of photons that a path has stored in a map.
uint stored_in(uint stored[MAP_COUNT], uint map) {
    uint count = stored[0];
    [[unroll]] for (uint m = 1u; m < MAP_COUNT; ++m) count = map == m ? stored[m] : count;
    return count;
}

// Whether camera paths cannot find the light that a path comes from.
bool is_sampled_only(Path path) {
    PhotonRay start = push.rays[push.chunk.first + path.index].at;
    return gloss_caustics_is_sampled_only(push.scene.lights[start.light].at.kind);
}

// Appends a photon, the `ordinal`-th of a path in the map with this number.
void append(uint path, Photon photon, uint number, uint ordinal) {
    uint place = counter_take(push.place);
    if (place >= push.places) return;
    push.photons[place].at = photon;
    push.owners[place].at = uvec2(path, ordinal << MAP_BITS | number);
}

// Where a surface is met by a share of the photons, its coverage, each stands for the others too.
void store(inout Path path, Surface at, vec3 power, float coverage) {
    uint map = !path.specular_only ? MAP_GLOBAL : path.bounce > 0u ? MAP_CAUSTIC : MAP_DIRECT;
    bool stores = (WANTED >> map & 1u) != 0u;
    bool from_medium = FROM_MEDIA && path.from_medium;
    if (!stores && !from_medium) return;
    Photon photon;
    photon.position = at.point;
    photon.direction = octahedral_pack(-path.ray.direction);
    if (REFLECTIONS && ALL_LIGHTS) {
        photon.direction = gloss_caustics_with_mark(photon.direction, is_sampled_only(path));
    }
    photon.power = RANDOM_SURFACES ? over(power, coverage) : power;
    photon.normal = octahedral_pack(at.normal);
    if (stores) {
        append(path.index, photon, map, stored_in(path.stored, map));
        [[unroll]] for (uint m = 0u; m < MAP_COUNT; ++m) path.stored[m] += map == m ? 1u : 0u;
    }
    if (from_medium) append(path.index, photon, MAP_COUNT + MAP_DIRECT, path.stored_in_media[MAP_DIRECT]++);
}

// Whether the path's numbers are valid for continuing.
bool is_sane(Path path) {
    return is_finite3(path.ray.origin) && is_finite3(path.ray.direction) && is_finite3(path.power)
        && photon_greatest(abs(path.power)) <= FATE_MAX_POWER;
}

#include "stages/trace_medium.glsl"

// Processes one surface, or a collision before it; returns how the path ended there, or FATE_NONE.
uint step_path(inout Path path, Hit hit) {
    bool escapes = hit.primitive == NO_PRIMITIVE;
    if (!SCATTERING && escapes) return FATE_ESCAPED;
    Surface at;
    Material material;
    bool stores = false;
    float coverage = 1.0;
    vec3 normal;
    Layers layers = layers_none();
    Interface sides;
    sides.before = path.media;
    float end = NO_LIMIT;
    if (!escapes) {
        at = surface_met(push.scene, path.ray.direction, hit, layer(path));
        material = push.scene.materials[at.material].at;
        stores = material_stores_photons(material);
        if (ALPHA) coverage = alpha_coverage_at(push.scene, material, hit.slot, hit.u, hit.v);
        if (PARTIAL_TRANSMISSION) coverage *= 1.0 - partial_share_at(push.scene, material, hit.slot, hit.u, hit.v);
        normal = at.normal;
        if (SHADED) normal = shade(push.scene, at, hit, material, layers);
        if (BENT_NORMALS && material.kind != MATERIAL_LAMBERT) shade_specular(at, path.ray.direction, normal);
        sides = media_interface(push.scene, material, at.front, path.media);
        end = at.t;
    }
    if (SCATTERING) {
        uint crossing = fly(path, sides.before, end);
        if (crossing != CROSSING_PASSES) return after_collision(crossing, path.collisions);
        if (escapes) return FATE_ESCAPED;
    } else if (may_attenuate(sides.before)) {
        path.power = photon_times(path.power, transmittance(push.scene, path.ray, end, sides.before));
    }
    if (DISPERSION && media_is_dispersive(push.scene, sides)) {
        Sampler s = path.numbers;
        uint word = wavelength_word(s.key, s.pass, s.domain, s.path, 0u);
        media_disperse(push.scene, sides, path.wavelength, path.power, word);
    }
    uint block = BLOCK_SURFACES + path.bounce;
    if (SCATTERING) block += path.collisions;
    uvec4 words = sampler_words(path.numbers, block);
    float choice = unit_f32(words.x);
    Arriving arriving =
        Arriving(path.ray.direction, path.power, at.normal, normal, vec2(unit_f32(words.y), unit_f32(words.z)));
    // Light straight from a light source is not counted by aimed paths.
    bool is_counted = !(AIMED && path.bounce == 0u);
    PhotonSample left;
    bool survives;
    bool enters = false;
    uint rule = scattering_at(material, sides);
    if (GLOSSY && rule == SCATTERING_GLOSSY) {
        if (REFLECTIONS) {
            bool is_counted = path.bounce > 0u && (ALL_LIGHTS || is_sampled_only(path));
            if (is_counted) store(path, at, path.power, coverage);
            ++path.bounce;
            return FATE_TERMINATED;
        }
        Glossy glossy = glossy_at(push.scene, material, layers, at.cosine, -path.ray.direction, true);
        if (stores && is_counted) {
            vec3 entering = vec3(glossy_entering(push.scene, glossy.coat, at.cosine));
            store(path, at, photon_times(path.power, entering), coverage);
        }
        float rest;
        uint lobe = glossy_lobe_choose(glossy, choice, rest);
        if (lobe != GLOSSY_LOBE_REFLECTION) {
            if (AIMED) {
                ++path.bounce;
                return FATE_TERMINATED;
            }
            path.specular_only = false;
            path.from_medium = false;
        }
        survives = photon_glossy(push.scene, glossy, lobe, rest, arriving, left);
    } else if (ROUGH_GLASS && rule == SCATTERING_ROUGH_GLASS) {
        if (REFLECTIONS) {
            ++path.bounce;
            return FATE_TERMINATED;
        }
        RoughGlass glass = rough_glass_new(push.scene, material, at.cosine, sides);
        RoughSample drawn = rough_glass_sample(
            push.scene, glass, -path.ray.direction, normal, choice, arriving.uv.x, arriving.uv.y);
        enters = !drawn.stays;
        path.media = sides.before;
        survives = photon_rough_glass(drawn, arriving, left);
    } else {
        Bsdf bsdf = bsdf_new(material, at.cosine, sides);
        uint lobe = bsdf_choose(bsdf, choice);
        if (lobe == LOBE_DIFFUSE) {
            if (stores && !REFLECTIONS && is_counted) store(path, at, path.power, coverage);
            if (AIMED) {
                ++path.bounce;
                return FATE_TERMINATED;
            }
            path.specular_only = false;
            path.from_medium = false;
        }
        enters = lobe == LOBE_SPECULAR_TRANSMISSION;
        if (bsdf_is_total(bsdf)) ++path.total;
        survives = photon_simple(bsdf, lobe, choice, arriving, left);
    }
    if (enters) {
        if (NESTED && sides.is_too_deep) path.too_deep = true;
        path.media = sides.transmitted;
    }
    ++path.bounce;
    if (!survives) return FATE_ABSORBED;
    path.power = left.power;
    path.ray = left.passes ? surface_pass(at, left.direction) : surface_leave(at, left.direction);
    bool is_trapped = GLASS && path.total > most_total_reflections(push.max_bounces);
    return is_trapped || path.bounce >= push.max_bounces ? FATE_TRUNCATED : FATE_NONE;
}

void finish(Path path, uint fate) {
    uint count = push.chunk.count;
    [[unroll]] for (uint map = 0u; map < MAP_COUNT; ++map) {
        if ((WANTED >> map & 1u) != 0u) push.chunk.stored[map * count + path.index].at = path.stored[map];
    }
    if (IN_MEDIA) keep_counts_in_media(path);
    Ending ending;
    ending.power = path.power;
    ending.fate_surfaces = fate << 28 | (path.too_deep ? TOO_DEEP : 0u) | min(path.bounce, SURFACES_MASK);
    push.chunk.endings[path.index].at = ending;
}

// Finishes a path, or this dispatch's part of it, and starts the next one. Returns false if there is none.
bool follow_next(inout Path path, uint fate, inout uint turn, uint given) {
    if (fate == FATE_NONE) keep(path);
    else finish(path, fate);
    uint number = next_path(turn, given);
    if (number >= given) return false;
    path = begin(number);
    return true;
}

// State of an invocation.
const uint READY = 0u;
const uint UNDER_WAY = 1u;
const uint ARRIVED = 2u;
const uint IDLE = 3u;

void main() {
    SceneRef scene = push.scene;
    uint given = push.begins != 0u ? push.chunk.count : push.now.given;
    uint turn = 0u;
    uint number = next_path(turn, given);
    bool any = number < given;
    if (!any && BUSY == 0u) return;
    Path path;
    if (any) path = begin(number);
    Walk walk;
    if (BUSY == 0u) {
        // A single loop over surfaces and paths: an invocation whose path has ended continues with the next one
        // while its neighbours are still active.
        while (any) {
            uint fate = FATE_DROPPED;
            if (is_sane(path)) {
                bool under_way = walk_begin(scene, path.ray, layer(path), walk);
                while (under_way) under_way = walk_step(scene, walk, false);
                fate = step_path(path, walk.best);
            }
            --path.left;
            if (fate != FATE_NONE || path.left == 0u) any = follow_next(path, fate, turn, given);
        }
        return;
    }
    // A single loop over nodes too. All invocations of a subgroup reach its head together and do there what
    // most of them need: none leaves before all are finished, so that they stay converged.
    uint state = any ? READY : IDLE;
    while (true) {
        uint under_way = subgroupBallotBitCount(subgroupBallot(state == UNDER_WAY));
        uint waiting = subgroupBallotBitCount(subgroupBallot(state == READY || state == ARRIVED));
        if (under_way + waiting == 0u) break;
        if (waiting > 0u && under_way < BUSY) {
            if (state == ARRIVED) {
                uint fate = is_sane(path) ? step_path(path, walk.best) : FATE_DROPPED;
                --path.left;
                bool goes_on = fate == FATE_NONE && path.left > 0u;
                if (!goes_on) goes_on = follow_next(path, fate, turn, given);
                state = goes_on ? READY : IDLE;
            }
            if (state == READY) {
                bool starts = is_sane(path) && walk_begin(scene, path.ray, layer(path), walk);
                state = starts ? UNDER_WAY : ARRIVED;
                if (!starts) walk.best.primitive = NO_PRIMITIVE;
            }
        } else if (state == UNDER_WAY) {
            if (!walk_step(scene, walk, false)) state = ARRIVED;
        }
    }
}

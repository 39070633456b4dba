// Photons in media that scatter light: included by trace.comp, whose Path and push constants it uses. Twin of
// backend-cpu's trace/medium.rs.
#ifndef TRACE_MEDIUM_GLSL
#define TRACE_MEDIUM_GLSL

#include "shading/flight.glsl"
#include "shading/phase.glsl"

// Bit of the blocks of aimed paths, whose numbers may be those of other paths.
const uint AIMED_BLOCKS = AIMED ? 0x80000000u : 0u;

vec3 along(Ray ray, float far) {
    precise vec3 point = ray.origin + ray.direction * far;
    return point;
}

uvec4 medium_words(Sampler s, uint domain, uint block) {
    return philox4x32(uvec4(s.path, block, s.pass, domain), s.key);
}

// Bits of blocks below the number of a stretch of the ray, which has as many numbers as there are bits up to that of aimed paths.
const uint STRETCH_BITS = 18u;
const uint MOST_STRETCHES = 0x1FFFu;

// Largest number below 1.
const float LAST_PLACE = 0.99999994;

// Appends a photon of a map in the medium with this index; they are counted by the caller.
void store_in_medium(Path path, uint map, uint index, float distance, vec3 power, uint ordinal) {
    Photon photon;
    photon.position = along(path.ray, distance);
    photon.direction = octahedral_pack(-path.ray.direction);
    photon.power = power;
    photon.normal = index;
    append(path.index, photon, MAP_COUNT + map, ordinal);
}

float column_sum(float a, float b) {
    precise float sum = a + b;
    return sum;
}

// Leaves the photons of the part of a ray between two distances, in the medium with this index, whose flight reached a column and a
// distance, in `reached`: several where the light may be focused. `block` is that of its random numbers, less the number of the
// event.
void deposit(inout Path path, uint index, Medium medium, float from, float to, vec2 reached, Flight flight, uint block) {
    uint map = !path.specular_only ? MAP_GLOBAL : path.bounce > 0u ? MAP_CAUSTIC : MAP_DIRECT;
    if ((WANTED_IN_MEDIA >> map & 1u) == 0u) return;
    uint first = stored_in(path.stored_in_media, map);
    uint count = path.specular_only ? FLIGHT_FOCUSED_DEPOSITS : 1u;
    bool sees_grid = has_grid(push.scene, index);
    // A variable is not known to be false when branches are removed.
    if (GRIDS && sees_grid && !path.specular_only && grid_is_thick(push.scene.grids.grids[index].at, medium_extinction(medium))) {
        if (!flight.collides || !(flight.albedo > 0.0)) return;
        store_in_medium(path, map, index, reached.y, photon_times(flight.power, vec3(flight.albedo)), first);
    } else {
        // Walks through a grid go on where the flight ended.
        vec2 before = flight.collides && sees_grid ? reached : vec2(0.0, from);
        float column = reached.x;
        if (flight.collides) {
            float rest = stretch_until(push.scene, index, path.ray, before.y, to, FLIGHT_ENDLESS).x;
            column = column_sum(before.x, rest);
        }
        if (!(column > 0.0)) return;
        uvec4 words = medium_words(path.numbers, DOMAIN_DEPOSIT, block + path.bounce + path.collisions + AIMED_BLOCKS);
        float channel = unit_f32(words.x), start = unit_f32(words.y);
        for (uint number = 0u; number < count; ++number) {
            precise float at = (float(number) + start) / float(count);
            // Rounding may give 1, which is infinitely far in a dense medium.
            at = min(at, LAST_PLACE);
            vec3 power;
            float within = flight_deposit(medium, path.power, column, count, channel, at, power);
            bool is_before = within < before.x;
            float begin = is_before ? from : before.y;
            float limit = is_before ? within : column_sum(within, -before.x);
            float distance = stretch_until(push.scene, index, path.ray, begin, to, limit).y;
            store_in_medium(path, map, index, distance, power, first + number);
        }
    }
    [[unroll]] for (uint m = 0u; m < MAP_COUNT; ++m) path.stored_in_media[m] += map == m ? count : 0u;
}

// Outcome of a flight: the path reaches its end, or has been scattered and goes on along another ray, or ends.
const uint CROSSING_PASSES = 0u;
const uint CROSSING_COLLIDES = 1u;
const uint CROSSING_ABSORBED = 2u;
// It ends far from the scene, and others stand for it: the power is 0.
const uint CROSSING_THINNED = 3u;

// Follows the part of the ray between two distances, in the medium with this index, which scatters light; `media` are those
// of the solids around it. Aimed paths never collide: the power of those that would is left out.
uint cross_medium(inout Path path, uint media, uint index, float from, float to, uint block) {
    Medium medium = push.scene.media[index].at;
    uint event = path.bounce + path.collisions;
    uvec4 words = uvec4(0u);
    float drawn = FLIGHT_ENDLESS;
    if (!AIMED) {
        words = medium_words(path.numbers, DOMAIN_FLIGHT, block + 2u * event);
        drawn = flight_length(medium, path.power, unit_f32(words.x), unit_f32(words.y));
    }
    vec2 reached = stretch_until(push.scene, index, path.ray, from, to, drawn);
    bool collides = has_grid(push.scene, index) ? reached.x >= drawn : reached.x < column_sum(to, -from);
    Flight flight = flight_ended(medium, path.power, collides, reached.x);
    // Shadow rays find light that comes straight from a light source.
    if (IN_MEDIA && event > 0u) deposit(path, index, medium, from, to, reached, flight, block);
    if (AIMED) {
        path.power = photon_times(path.power, medium_transmittance(medium, reached.x));
        return CROSSING_PASSES;
    }
    if (flight.collides && !(unit_f32(words.z) < flight.albedo)) return CROSSING_ABSORBED;
    path.power = flight.power;
    if (!flight.collides) return CROSSING_PASSES;
    uvec4 turn = medium_words(path.numbers, DOMAIN_FLIGHT, block + 2u * event + 1u);
    vec3 direction = phase_sample(phase_of(medium), path.ray.direction, unit_f32(turn.x), unit_f32(turn.y));
    path.ray = Ray(along(path.ray, reached.y), direction, NO_LIMIT);
    path.media = media;
    path.specular_only = false;
    path.from_medium = true;
    ++path.collisions;
    // The medium around everything has no bounds.
    if (AMBIENT && index == 0u) {
        vec3 start = push.rays[push.chunk.first + path.index].at.power;
        vec3 left;
        bool goes_on = flight_thinned(path.power, start, path.ray.origin, unit_f32(words.w), left);
        path.power = goes_on ? left : vec3(0.0);
        if (!goes_on) return CROSSING_THINNED;
    }
    return CROSSING_COLLIDES;
}

// Follows the ray of a path through a stack of media up to the distance `end` of its next surface, NO_LIMIT without one.
uint fly(inout Path path, uint media, float end) {
    uint number = 0u;
    Stretches all = stretches_begin(push.scene, path.ray, end, media);
    Stretch part;
    while (stretches_next(push.scene, all, part)) {
        if (medium_scatters(push.scene.media[part.medium].at)) {
            uint crossing = cross_medium(path, media, part.medium, part.from, part.to, number << STRETCH_BITS);
            if (crossing != CROSSING_PASSES) return crossing;
            number = number + 1u & MOST_STRETCHES;
        } else if (may_attenuate(media)) {
            vec3 passes = stretch_transmittance(push.scene, part.medium, path.ray, part.from, part.to);
            path.power = photon_times(path.power, passes);
        }
    }
    return CROSSING_PASSES;
}

// Fate of a path in a medium that did not pass it, or FATE_NONE if it goes on.
uint after_collision(uint crossing, uint collisions) {
    if (crossing == CROSSING_ABSORBED) return FATE_ABSORBED;
    if (crossing == CROSSING_THINNED) return FATE_TERMINATED;
    return collisions > FLIGHT_MAX_COLLISIONS ? FATE_TRUNCATED : FATE_NONE;
}

#endif

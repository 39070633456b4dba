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

// Whether the medium of the part of a ray that is crossed has a grid of densities, and then its columns.
bool sees_grid = false;
Columns columns;

// The point of a ray where the part of it from a distance on has a column.
vec3 point_of(Ray ray, float from, float column) {
    return along(ray, sees_grid ? columns_place(columns, column) : from + column);
}

// Leaves the photons of the part of a ray from a distance on, with a column > 0, in the medium with this index: several where the
// light may be focused. `block` is that of its random numbers, less the number of the event.
void deposit(inout Path path, uint index, float from, float column, uint block) {
    uint map = !path.specular_only ? MAP_GLOBAL : path.bounce > 0u ? MAP_CAUSTIC : MAP_DIRECT;
    if ((WANTED_IN_MEDIA >> map & 1u) == 0u) return;
    Medium medium = push.scene.media[index].at;
    uint count = path.specular_only ? FLIGHT_FOCUSED_DEPOSITS : 1u;
    uint first = stored_in(path.stored_in_media, map);
    uvec4 words = medium_words(path.numbers, DOMAIN_DEPOSIT, block + path.bounce + path.collisions + AIMED_BLOCKS);
    float channel = unit_f32(words.x), start = unit_f32(words.y);
    for (uint number = 0u; number < count; ++number) {
        precise float at = (float(number) + start) / float(count);
        // Rounding may give 1, which is infinitely far in a dense medium.
        at = min(at, LAST_PLACE);
        Photon photon;
        vec3 power;
        float within = flight_deposit(medium, path.power, column, count, channel, at, power);
        photon.position = point_of(path.ray, from, within);
        photon.direction = octahedral_pack(-path.ray.direction);
        photon.power = power;
        photon.normal = index;
        append(path.index, photon, MAP_COUNT + map, first + number);
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
    float column = to - from;
    sees_grid = has_grid(push.scene, index);
    if (sees_grid) {
        GridTables tables = push.scene.grids;
        columns = columns_new(tables, tables.grids[index].at, path.ray.origin, path.ray.direction, from, to);
        column = columns_total();
    }
    // Shadow rays find light that comes straight from a light source.
    if (IN_MEDIA && event > 0u && column > 0.0) deposit(path, index, from, column, block);
    if (AIMED) {
        path.power = photon_times(path.power, medium_transmittance(medium, column));
        return CROSSING_PASSES;
    }
    uvec4 words = medium_words(path.numbers, DOMAIN_FLIGHT, block + 2u * event);
    Flight flight = flight_sample(medium, path.power, column, unit_f32(words.x), unit_f32(words.y));
    if (flight.collides && !(unit_f32(words.z) < flight.albedo)) return CROSSING_ABSORBED;
    path.power = flight.power;
    if (!flight.collides) return CROSSING_PASSES;
    uvec4 turn = medium_words(path.numbers, DOMAIN_FLIGHT, block + 2u * event + 1u);
    vec3 direction = phase_sample(phase_of(medium), path.ray.direction, unit_f32(turn.x), unit_f32(turn.y));
    path.ray = Ray(point_of(path.ray, from, flight.distance), direction, NO_LIMIT);
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

// Segments of camera paths in media that scatter light: included by eye.comp, whose Path and push constants it uses. Twin of
// backend-cpu's eye_segments.rs.
#ifndef EYE_SEGMENTS_GLSL
#define EYE_SEGMENTS_GLSL

#include "shading/flight.glsl"

// The last slot of a pixel: one of all segments from there on, chosen in proportion to the light that it may scatter, stands
// for all of them.
struct Reservoir {
    // Number of segments so far.
    uint count;
    // Sum of their weights, and the weight of the one in the slot; 0 if it has none.
    float total;
    float kept;
};

// Light that a segment in the medium with this index scatters into the pixel, if all of it arrives evenly.
float segment_weight(uint index, vec3 throughput, Ray ray, float length) {
    Medium medium = push.scene.media[index].at;
    vec3 extinction = medium_extinction(medium), scattering = medium.scattering;
    float column = stretch_column(push.scene, index, ray, 0.0, length);
    precise vec3 lost = 1.0 - medium_transmittance(medium, column);
    precise vec3 few = scattering * column;
    precise vec3 many = scattering * lost / extinction;
    // For small depths the limit.
    vec3 share = mix(few, many, greaterThan(lost, vec3(1e-3)));
    return dot3(throughput, share);
}

// Leaves a segment of a path from `ray.origin` on in the medium with this index, unless nothing is scattered there. `media` is
// the stack that it is stored with, `start` and `end` are the normals of its planes.
void leave_segment(
    vec3 throughput, uint pixel, uint media, uint index, Ray ray, float length, vec3 start, vec3 end,
    inout Reservoir reservoir, inout uint found
) {
    if (!(length > 0.0) || throughput == vec3(0.0)) return;
    if (!medium_scatters(push.scene.media[index].at)) return;
    bool is_last = found + 1u >= SEGMENTS;
    if (is_last) {
        float weight = segment_weight(index, throughput, ray, length);
        uint number = reservoir.count;
        precise float total = reservoir.total + weight;
        uint word = philox4x32(
            uvec4(pixel << PATHS_LOG2, BLOCK_SEGMENTS + number, push.pass, DOMAIN_SEGMENT | domain & 0xFFFF0000u), push.seed).x;
        precise float at = unit_f32(word) * total;
        bool is_kept = weight > 0.0 && at < weight;
        reservoir.count = number + 1u;
        reservoir.total = total;
        if (is_kept) reservoir.kept = weight;
        if (!is_kept && number > 0u) return;
    }
    push.segments[(place << SEGMENT_PLACES_LOG2) + found].at = Query(
        ray.origin, 1.0, ray.direction, place, throughput, media, floatBitsToUint(length),
        (pixel << PATHS_LOG2) + found, octahedral_pack(end), octahedral_pack(start));
    if (!is_last) ++found;
}

// Leaves the segments of a path in a stack of media up to the distance `end`, NO_LIMIT without a surface, where there is a plane
// with this normal: one for each stretch in which light is scattered. Returns the transmittance of all of it.
vec3 leave_segments(
    Path path, uint pixel, uint media, float end, vec3 plane, inout Reservoir reservoir, inout uint found
) {
    vec3 seen = seen_through(path, media), passed = vec3(1.0);
    vec3 start = path.start;
    if (dot3(start, path.ray.direction) < 0.0) start = -start;
    Stretches all = stretches_begin(push.scene, path.ray, end, media);
    Stretch part;
    while (stretches_next(push.scene, all, part)) {
        // The medium that applies, above that of the solid if they differ.
        uint stack = part.medium == all.solid ? all.solid : media_enter(all.solid, part.medium);
        precise vec3 origin = path.ray.origin + path.ray.direction * part.from;
        vec3 first = part.start == vec3(0.0) ? start : part.start, last = part.end == vec3(0.0) ? plane : part.end;
        Ray ray = Ray(origin, path.ray.direction, NO_LIMIT);
        leave_segment(seen * passed, pixel, stack, part.medium, ray, part.to - part.from, first, last, reservoir, found);
        passed *= stretch_transmittance(push.scene, part.medium, path.ray, part.from, part.to);
    }
    return passed;
}

// Completes the last slot.
void close_reservoir(Reservoir reservoir, inout uint found) {
    if (reservoir.count == 0u || (reservoir.count > 1u && !(reservoir.kept > 0.0))) return;
    Queries last = push.segments + int((place << SEGMENT_PLACES_LOG2) + found);
    precise float share = reservoir.total / reservoir.kept;
    if (reservoir.count > 1u) last.at.throughput *= share;
    ++found;
}

#endif

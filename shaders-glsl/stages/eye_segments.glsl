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

// Light that a segment scatters into the pixel, if all of it arrives evenly.
float segment_weight(uint media, vec3 throughput, float length) {
    Medium medium = media_medium(push.scene, media);
    vec3 extinction = medium_extinction(medium), scattering = medium.scattering;
    precise vec3 lost = 1.0 - medium_transmittance(medium, length);
    precise vec3 few = scattering * length;
    precise vec3 many = scattering * lost / extinction;
    // For small depths the limit.
    vec3 share = mix(few, many, greaterThan(lost, vec3(1e-3)));
    return dot3(throughput, share);
}

// Leaves the segment of a path in a stack of media up to a distance, where there is a plane with the normal `end`, unless
// nothing is scattered there.
void leave_segment(
    Path path, uint pixel, uint media, float length, vec3 end, inout Reservoir reservoir, inout uint found
) {
    if (!(length > 0.0) || path.throughput == vec3(0.0)) return;
    if (!medium_scatters(media_medium(push.scene, media))) return;
    vec3 throughput = path.throughput;
    if (GLASS) throughput *= radiance_scale(push.scene, push.camera.at.media, media, wavelength_of(path));
    vec3 start = path.reflected_normal;
    if (dot3(start, path.ray.direction) < 0.0) start = -start;
    bool is_last = found + 1u >= SEGMENTS;
    if (is_last) {
        float weight = segment_weight(media, throughput, length);
        uint number = reservoir.count;
        precise float total = reservoir.total + weight;
        uint word = philox4x32(
            uvec4(pixel << PATHS_LOG2, BLOCK_SEGMENTS + number, push.pass, DOMAIN_SEGMENT | push.domain & 0xFFFF0000u), push.seed).x;
        precise float at = unit_f32(word) * total;
        bool is_kept = weight > 0.0 && at < weight;
        reservoir.count = number + 1u;
        reservoir.total = total;
        if (is_kept) reservoir.kept = weight;
        if (!is_kept && number > 0u) return;
    }
    push.found[(pixel << PLACES_LOG2) + found].at = Query(
        path.ray.origin, 1.0, path.ray.direction, pixel, throughput, media, floatBitsToUint(length),
        (pixel << PATHS_LOG2) + found, octahedral_pack(end), octahedral_pack(start));
    if (!is_last) ++found;
}

// Completes the last slot.
void close_reservoir(Reservoir reservoir, uint pixel, inout uint found) {
    if (reservoir.count == 0u || (reservoir.count > 1u && !(reservoir.kept > 0.0))) return;
    Queries last = push.found + int((pixel << PLACES_LOG2) + found);
    precise float share = reservoir.total / reservoir.kept;
    if (reservoir.count > 1u) last.at.throughput *= share;
    ++found;
}

#endif

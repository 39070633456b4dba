// Segments of camera paths in a medium that scatters light. Twin of photon-core's segment.rs.
#ifndef SEGMENT_GLSL
#define SEGMENT_GLSL

#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/octahedral.glsl"

struct Segment {
    vec3 origin;
    vec3 direction;
    float far;
    // Normals of the planes at its start and its end.
    vec3 start;
    vec3 end;
    uint media;
};

Segment segment_of(Query query) {
    return Segment(query.position, query.normal, uintBitsToFloat(query.offset_or_wo), octahedral_unpack(query.coat),
        octahedral_unpack(query.shading_normal), query.media);
}

vec3 segment_beyond(vec3 from_origin, vec3 direction, float far) {
    precise vec3 beyond = from_origin - direction * far;
    return beyond;
}

// Whether a point lies between the planes of both ends.
bool segment_contains(Segment segment, vec3 from_origin) {
    return dot3(from_origin, segment.start) >= 0.0
        && dot3(segment_beyond(from_origin, segment.direction, segment.far), segment.end) <= 0.0;
}

#endif

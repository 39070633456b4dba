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

// The distance along the segment that a point beside it stands for; below 0 if it does not lie between the planes of both ends.
float segment_distance(Segment segment, vec3 from_origin) {
    vec3 beyond = segment_beyond(from_origin, segment.direction, segment.far);
    // Normals are rounded, and may be along the segment.
    float along_start = max(dot3(segment.direction, segment.start), 1e-6);
    float along_end = max(dot3(segment.direction, segment.end), 1e-6);
    precise float before = dot3(from_origin, segment.start) * along_end;
    precise float behind = -dot3(beyond, segment.end) * along_start;
    if (!(before >= 0.0 && behind >= 0.0)) return -1.0;
    precise float whole = max(before + behind, 1.17549435e-38);
    return segment.far * (before / whole);
}

#endif

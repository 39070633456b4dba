// Squared distances, with the same operations as backend-cpu's lanes.rs: rounding is monotonic, so that a box
// is never nearer than its nearest point, and pruning needs no tolerance.
//
// Distances are compared as bits: non-negative floats and their bits have the same order, NaN comes last, and
// no driver can flush them.
#ifndef SEARCH_DISTANCE_GLSL
#define SEARCH_DISTANCE_GLSL

const uint INFINITE_BITS = 0x7F800000u;
#define INFINITE uintBitsToFloat(INFINITE_BITS)

float squared(vec3 d) {
    precise float sum = d.x * d.x + d.y * d.y + d.z * d.z;
    return sum;
}

float point_distance(vec3 from, vec3 to) {
    precise vec3 d = from - to;
    return squared(d);
}

// Squared distance to the nearest point of a box, 0 inside.
float box_distance(vec3 from, vec3 low, vec3 high) {
    precise vec3 below = low - from;
    precise vec3 above = from - high;
    return squared(max(max(below, above), vec3(0.0)));
}

// Squared distance to the farthest corner of a box.
float corner_distance(vec3 from, vec3 low, vec3 high) {
    precise vec3 below = from - low;
    precise vec3 above = high - from;
    return squared(max(below, above));
}

#endif

// Adds the estimate or value of each query, times the query's weight, to the current pass of its pixel. The
// queries of a pixel are consecutive; the invocation of the first one adds them all, in order.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

// Source: 0 estimates of photon maps, 1 vectors.
layout(constant_id = 2) const uint FROM = 0;

#include "film/film.glsl"
#include "device/grid.glsl"
#include "shading/layout.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Values { vec3 at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Count { uint needed; uint capacity; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Queries queries;
    Count query_count;
    // One of the two is used.
    Estimates estimates;
    Values values;
    Count found_count;
    Planes pass;
    uint pixels;
    // For estimates: 1 / (π times the number of paths).
    float scale;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

vec3 value(uint i) {
    if (FROM == 1) return push.values[i].at;
    Estimates estimates = push.estimates + i;
    if (estimates.at.photons == 0) return vec3(0.0);
    return estimates.at.flux * (push.scale / estimates.at.radius_squared);
}

void main() {
    uint i = thread();
    uint count = min(push.query_count.needed, push.query_count.capacity);
    count = min(count, min(push.found_count.needed, push.found_count.capacity));
    if (i >= count) return;
    uint pixel = push.queries[i].at.pixel;
    if (pixel >= push.pixels || (i > 0 && push.queries[i - 1].at.pixel == pixel)) return;
    precise vec3 sum = vec3(0.0);
    do {
        sum += push.queries[i].at.throughput * value(i);
        i++;
    } while (i < count && push.queries[i].at.pixel == pixel);
    if (sum == vec3(0.0)) return;
    for (uint c = 0; c < 3; c++) {
        Planes place = film_place(push.pass, c, push.pixels, pixel);
        place.at += sum[c];
    }
}

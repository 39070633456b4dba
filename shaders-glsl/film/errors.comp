// Adds the error moments of the photons at each query to the current pass of its pixel. Twin of photon-core's
// `ErrorPixel::deposit`. The queries of a pixel are consecutive; the invocation of the first one adds them all,
// in order.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

// Source: 0 estimates and their error moments, 1 the sums of final_gather_sum.comp.
layout(constant_id = 2) const uint FROM = 0;

#include "film/film.glsl"
#include "device/grid.glsl"
#include "shading/bias.glsl"
#include "shading/layout.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Count { uint needed; uint capacity; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Queries queries;
    Count query_count;
    Estimates estimates;
    ErrorMomentsBuffer error_moments;
    Count found_count;
    // Planes of bias and narrow; planes of the map's photon moments.
    Planes pass;
    Planes map_moments;
    uint pixels;
    // 1 / (3π times the number of paths); or 1/3.
    float scale;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void add(Planes planes, uint plane, uint pixel, float x) {
    Planes place = film_place(planes, plane, push.pixels, pixel);
    place.at += x;
}

void main() {
    uint i = thread();
    uint count = min(push.query_count.needed, push.query_count.capacity);
    count = min(count, min(push.found_count.needed, push.found_count.capacity));
    if (i >= count) return;
    uint pixel = push.queries[i].at.pixel;
    if (pixel >= push.pixels || (i > 0 && push.queries[i - 1].at.pixel == pixel)) return;
    float bias = 0.0, narrow = 0.0, power = 0.0, squared = 0.0, stray = 0.0;
    vec2 slope = vec2(0.0), quadrupole = vec2(0.0);
    do {
        ErrorMomentsBuffer moments = push.error_moments + i;
        if (moments.at.photons != 0) {
            vec3 throughput = push.queries[i].at.throughput;
            // What final_gather_sum.comp writes are biases already.
            Biases found = Biases(moments.at.wide, moments.at.narrow);
            float density = push.scale;
            if (FROM == 0) {
                found = biases(push.estimates[i].at.flux, found.wide, found.narrow);
                density /= push.estimates[i].at.radius_squared;
            }
            vec3 wide = found.wide * throughput, inner = found.narrow * throughput;
            bias += density * (wide.x + wide.y + wide.z);
            narrow += density * (inner.x + inner.y + inner.z);
            float mean = (throughput.x + throughput.y + throughput.z) * (1.0 / 3.0);
            power += mean * moments.at.power;
            squared += mean * mean * moments.at.power_squared;
            slope += mean * moments.at.slope;
            quadrupole += mean * moments.at.quadrupole;
            stray += mean * moments.at.stray;
        }
        i++;
    } while (i < count && push.queries[i].at.pixel == pixel);
    if (power == 0.0 && stray == 0.0) return;
    add(push.pass, 0, pixel, bias);
    add(push.pass, 1, pixel, narrow);
    add(push.map_moments, MOMENTS_POWER, pixel, power);
    add(push.map_moments, MOMENTS_POWER_SQUARED, pixel, squared);
    for (uint axis = 0; axis < 2; axis++) {
        add(push.map_moments, MOMENTS_SLOPE + axis, pixel, slope[axis]);
        add(push.map_moments, MOMENTS_QUADRUPOLE + axis, pixel, quadrupole[axis]);
    }
    add(push.map_moments, MOMENTS_STRAY, pixel, stray);
}

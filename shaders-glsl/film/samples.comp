// Adds what camera samples that were traced together have left to the current pass, one sample after another, and empties
// their places. One invocation per pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "film/film.glsl"
#include "device/grid.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    // Planes of the pixels of all samples: emission, direct light of segments in media, direct light of surfaces.
    Planes from[3];
    // Emission and direct light of the current pass.
    Planes to[2];
    FirstPass first_from;
    FirstPass first_to;
    uint pixels;
    uint samples;
    // A bit for each of `from` that exists.
    uint lit;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// The light of one sample.
float light(uint kind, uint c, uint place) {
    if ((push.lit >> kind & 1) == 0) return 0.0;
    return film_place(push.from[kind], c, push.pixels * push.samples, place).at;
}

void main() {
    uint pixel = thread();
    if (pixel >= push.pixels) return;
    // Nothing is written between reads, so that these need not wait for one another.
    vec3 emission = vec3(0.0), direct = vec3(0.0);
    for (uint c = 0; c < 3; c++) {
        precise float emitted = (push.lit & 1) != 0 ? film_place(push.to[0], c, push.pixels, pixel).at : 0.0;
        precise float arriving = (push.lit & 6) != 0 ? film_place(push.to[1], c, push.pixels, pixel).at : 0.0;
        for (uint i = 0; i < push.samples; i++) {
            uint place = i * push.pixels + pixel;
            emitted += light(0, c, place);
            arriving += light(1, c, place);
            arriving += light(2, c, place);
        }
        emission[c] = emitted;
        direct[c] = arriving;
    }
    FirstPass to = push.first_to + pixel;
    uint hits = to.hits;
    vec3 normal = to.normal, albedo = to.albedo;
    float depth = to.depth;
    for (uint i = 0; i < push.samples; i++) {
        FirstPass from = push.first_from + (i * push.pixels + pixel);
        if (from.hits == 0) continue;
        // Stale before the first hit, as in eye.comp.
        normal = hits == 0 ? from.normal : normal + from.normal;
        depth = hits == 0 ? from.depth : depth + from.depth;
        albedo = hits == 0 ? from.albedo : albedo + from.albedo;
        hits += from.hits;
    }
    to.normal = normal;
    to.depth = depth;
    to.albedo = albedo;
    to.hits = hits;
    for (uint c = 0; c < 3; c++) {
        if ((push.lit & 1) != 0) film_place(push.to[0], c, push.pixels, pixel).at = emission[c];
        if ((push.lit & 6) != 0) film_place(push.to[1], c, push.pixels, pixel).at = direct[c];
    }
    for (uint i = 0; i < push.samples; i++) {
        uint place = i * push.pixels + pixel;
        for (uint kind = 0; kind < 3; kind++) {
            if ((push.lit >> kind & 1) == 0) continue;
            for (uint c = 0; c < 3; c++) film_place(push.from[kind], c, push.pixels * push.samples, place).at = 0.0;
        }
        (push.first_from + place).hits = 0;
    }
}

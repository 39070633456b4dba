// The picture as it is shown: red, green, blue in sRGB and a linear opacity, a byte each. Twin of photon-core's
// `Display::pixel`; bytes differ by 1 at most. One invocation per pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

// Bit mask of the layers that exist.
layout(constant_id = 2) const uint LAYERS = 15;
layout(constant_id = 3) const uint CURVE = 0;
// Whether pixels have an opacity.
layout(constant_id = 4) const bool IS_TRANSPARENT = false;
// Whether radiance is clamped to [0, 1] before the exposure.
layout(constant_id = 5) const bool IS_CLAMPED = false;

#include "film/film.glsl"
#include "film/tone_map.glsl"
#include "device/grid.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Shown { uint at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Planes sums[4];
    Hits hits;
    Shown shown;
    uint pixels;
    // From a sum to a radiance.
    float factor;
    float exposure;
    float inverse_paths;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

vec3 layer(uint index, uint pixel) {
    vec3 radiance;
    for (uint c = 0; c < 3; c++) {
        float high = film_place(push.sums[index], c, push.pixels, pixel).at;
        float low = film_place(push.sums[index], c + 3, push.pixels, pixel).at;
        radiance[c] = high * push.factor + low * push.factor;
    }
    return radiance;
}

void main() {
    uint pixel = thread();
    if (pixel >= push.pixels) return;
    vec3 radiance = vec3(0.0);
    if ((LAYERS & 1) != 0) radiance += layer(0, pixel);
    if ((LAYERS & 2) != 0) radiance += layer(1, pixel);
    if ((LAYERS & 4) != 0) radiance += layer(2, pixel);
    if ((LAYERS & 8) != 0) radiance += layer(3, pixel);
    radiance = without_nan(radiance);
    if (IS_CLAMPED) radiance = clamp(radiance, 0.0, 1.0);
    uint opacity = 255;
    if (IS_TRANSPARENT) {
        float alpha = float((push.hits + pixel).at) * push.inverse_paths;
        radiance = alpha > 0.0 ? radiance / alpha : vec3(0.0);
        opacity = uint(clamp(alpha, 0.0, 1.0) * 255.0 + 0.5);
    }
    uvec3 colour = encode_srgb(tone_map(CURVE, push.exposure, radiance));
    (push.shown + pixel).at = colour.r | colour.g << 8 | colour.b << 16 | opacity << 24;
}

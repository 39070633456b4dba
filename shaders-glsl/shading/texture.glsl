// Texture lookup: twin of photon-core's texture.rs.
#ifndef TEXTURE_GLSL
#define TEXTURE_GLSL

#include "shading/constants.glsl"
#include "shading/math.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Texels { uint at; };
// The values of bytes: 256 of linear ones, and 256 decoded from sRGB.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ByteValues { float at; };

struct Texture {
    Texels texels;
    uint width;
    uint height;
    uint format;
    uint wrap_u;
    uint wrap_v;
    uint filter_mode;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Textures { Texture at; };

// The two texels on either side of a coordinate, and the weight of the second.
struct TextureAxis {
    uint first;
    uint second;
    float weight;
};

TextureAxis texture_axis(float coordinate, uint size, uint wrap, uint filter_mode) {
    float t = is_finite(coordinate) ? coordinate : 0.0;
    precise float inside = clamp(t, 0.0, 1.0);
    if (wrap == WRAP_REPEAT) {
        inside = t - floor(t);
    } else if (wrap == WRAP_MIRROR) {
        precise float twice = t - 2.0 * floor(0.5 * t);
        inside = twice > 1.0 ? 2.0 - twice : twice;
    }
    uint last = size - 1u;
    precise float place = inside * float(size);
    if (filter_mode == FILTER_NEAREST) {
        uint texel = min(uint(place), last);
        return TextureAxis(texel, texel, 0.0);
    }
    precise float from_centre = place - 0.5;
    float below = floor(from_centre);
    bool repeats = wrap == WRAP_REPEAT;
    uint first = below < 0.0 ? (repeats ? last : 0u) : min(uint(max(below, 0.0)), last);
    uint second = uint(below + 1.0);
    if (second > last) second = repeats ? 0u : last;
    precise float weight = from_centre - below;
    return TextureAxis(first, second, weight);
}

vec4 texture_texel(Texture image, ByteValues values, uint x, uint y) {
    uint index = y * image.width + x;
    if (image.format == TEXEL_FLOAT32) {
        Texels texel = image.texels + int(4u * index);
        return vec4(uintBitsToFloat(texel[0].at), uintBitsToFloat(texel[1].at), uintBitsToFloat(texel[2].at),
            uintBitsToFloat(texel[3].at));
    }
    uint word = image.texels[index].at;
    uint colors = image.format == TEXEL_SRGB8 ? 256u : 0u;
    return vec4(values[colors + (word & 255u)].at, values[colors + (word >> 8 & 255u)].at,
        values[colors + (word >> 16 & 255u)].at, values[word >> 24].at);
}

vec4 texture_mix(vec4 from, vec4 to, float share) {
    precise vec4 mixed = from * (1.0 - share) + to * share;
    return mixed;
}

vec4 texture_lookup(Texture image, ByteValues values, vec2 uv) {
    TextureAxis across = texture_axis(uv.x, image.width, image.wrap_u, image.filter_mode);
    TextureAxis down = texture_axis(uv.y, image.height, image.wrap_v, image.filter_mode);
    vec4 upper = texture_texel(image, values, across.first, down.first);
    if (across.weight != 0.0) {
        upper = texture_mix(upper, texture_texel(image, values, across.second, down.first), across.weight);
    }
    if (down.weight == 0.0) return upper;
    vec4 lower = texture_texel(image, values, across.first, down.second);
    if (across.weight != 0.0) {
        lower = texture_mix(lower, texture_texel(image, values, across.second, down.second), across.weight);
    }
    return texture_mix(upper, lower, down.weight);
}

#endif

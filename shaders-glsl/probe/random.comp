// Evaluates the functions of random.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/random.glsl"

Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    switch (FUNCTION) {
        case 0u: return Output(philox4x32(words.a, words.b.xy), uvec4(0u));
        case 1u: {
            uint word = words.a.x;
            uint centred = floatBitsToUint(centred_f32(word));
            return Output(uvec4(lcg(word), floatBitsToUint(unit_f32(word)), centred, 0u), uvec4(0u));
        }
        case 4u: return Output(uvec4(evenly_spread(words.a.xy, words.a.z), 0u, 0u), uvec4(0u));
        case 3u: {
            uint word = wavelength_word(words.a.yz, words.a.w, words.b.x, words.b.y, words.b.z);
            return Output(uvec4(word, 0u, 0u, 0u), uvec4(0u));
        }
        default: {
            Sampler s = sampler_new(words.a.x, words.a.yz, words.a.w, words.b.x, words.b.y);
            uvec4 first = sampler_words(s, words.b.z);
            return Output(first, sampler_words(s, words.b.w));
        }
    }
}

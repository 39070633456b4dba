// Twin of photon-core's random.rs: the same words, bit for bit.
#ifndef RANDOM_GLSL
#define RANDOM_GLSL

#include "shading/constants.glsl"

// Philox4x32-10.
uvec4 philox4x32(uvec4 counter, uvec2 key) {
    for (uint i = 0u; i < 10u; ++i) {
        uvec2 a, b;
        umulExtended(0xD2511F53u, counter.x, a.y, a.x);
        umulExtended(0xCD9E8D57u, counter.z, b.y, b.x);
        counter = uvec4(b.y ^ counter.y ^ key.x, b.x, a.y ^ counter.w ^ key.y, a.x);
        key += uvec2(0x9E3779B9u, 0xBB67AE85u);
    }
    return counter;
}

// One step of the paper's generator.
uint lcg(uint state) {
    return (state * 1103515245u + 12345u) & 0x7FFFFFFFu;
}

// Element `index` of a sequence of points that begins at `first`, which are spread evenly.
uvec2 evenly_spread(uvec2 first, uint index) {
    uint column = 1u << 31;
    uint second = 0u;
    for (uint rest = index; rest != 0u; rest >>= 1) {
        if ((rest & 1u) != 0u) second ^= column;
        column ^= column >> 1;
    }
    return first ^ uvec2(bitfieldReverse(index), second);
}

// A float in [0, 1) from the upper 24 bits, exactly.
float unit_f32(uint word) {
    return float(word >> 8) * (1.0 / 16777216.0);
}

// The same number modulo 1, in [-1/2, 1/2] and from all bits. Both parts are exact: one rounding.
float centred_f32(uint word) {
    precise float sum = float(int(word) >> 8) * (1.0 / 16777216.0) + float(word & 0xFFu) * (1.0 / 4294967296.0);
    return sum;
}

// The random numbers of one path.
struct Sampler {
    uint kind;
    uvec2 key;
    uint path;
    uint pass;
    uint domain;
    uint state;
};

// `seed` is the low word, then the high one. `kind` applies only to photons.
Sampler sampler_new(uint kind, uvec2 seed, uint pass, uint domain, uint path) {
    uint state = (path + pass * 0x9E3779B9u + seed.x) & 0x7FFFFFFFu;
    bool photon = domain == DOMAIN_PHOTON || domain == DOMAIN_AIMED;
    return Sampler(photon ? kind : RANDOM_COUNTER, seed, path, pass, domain, state);
}

// Four random words: those of block `block`, or the next four of the LCG.
uvec4 sampler_words(inout Sampler s, uint block) {
    if (s.kind != RANDOM_LCG) {
        return philox4x32(uvec4(s.path, block, s.pass, s.domain), s.key);
    }
    uvec4 words;
    for (uint i = 0u; i < 4u; ++i) {
        s.state = lcg(s.state);
        words[i] = s.state << 1;
    }
    return words;
}

// The random word for the wavelength of a path of `domain`, whose upper half is the camera sample, or of its gather ray `ray`:
// Sampler::wavelength.
uint wavelength_word(uvec2 seed, uint pass, uint domain, uint path, uint ray) {
    uint block = ray << 3 | domain & 0xFFFFu;
    uint word = domain & 0xFFFF0000u | DOMAIN_WAVELENGTH;
    if ((domain & 0xFFFFu) == DOMAIN_EYE) {
        return philox4x32(uvec4(path, block, 0u, word), seed).x + pass * GOLDEN_STEP;
    }
    return philox4x32(uvec4(path, block, pass, word), seed).x;
}

#endif

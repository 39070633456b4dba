// How photons leave a surface: direction, weight, and Russian roulette. Twin of photon-core's photon_sample.rs.
#ifndef PHOTON_SAMPLE_GLSL
#define PHOTON_SAMPLE_GLSL

#include "shading/bsdf.glsl"
#include "shading/glossy.glsl"
#include "shading/rough_glass.glsl"
#include "shading/sampling.glsl"
#include "shading/shade.glsl"
#include "shading/shading_normal.glsl"

// A photon that arrives at a surface: where it moves to, its power, the normals on its side, and two uniform numbers for
// the direction in which it leaves.
struct Arriving {
    vec3 incoming;
    vec3 power;
    vec3 geometric;
    vec3 shading;
    vec2 uv;
};

// A photon that leaves a surface: `passes` if it goes on beyond it.
struct PhotonSample {
    vec3 direction;
    vec3 power;
    bool passes;
};

float photon_greatest(vec3 v) { return max(max(v.x, v.y), v.z); }

vec3 photon_times(vec3 power, vec3 by) {
    precise vec3 left = power * by;
    return left;
}

// Russian roulette by the brightest channel; false if the photon is absorbed. With shading normals and at glossy
// surfaces, weights may be above 1.
bool photon_roulette(inout vec3 power, vec3 weight, float choice) {
    precise vec3 next = power * weight;
    precise float chance = photon_greatest(next) / photon_greatest(power);
    // Comparisons with NaN (0/0) are false.
    if (!(choice < chance) || is_nan(chance)) return false;
    if (SHADING_NORMALS || FOLLOWED) chance = min(chance, 1.0);
    precise vec3 left = next / chance;
    power = left;
    return true;
}

// From diffuse surfaces, mirrors and smooth glass. False: the photon is absorbed.
bool photon_simple(Bsdf bsdf, uint lobe, float choice, Arriving at, out PhotonSample left) {
    left.passes = lobe == LOBE_SPECULAR_TRANSMISSION;
    left.power = at.power;
    vec3 weight = bsdf_weight(bsdf, lobe);
    if (SHADING_NORMALS) {
        vec3 about = lobe == LOBE_DIFFUSE ? at.geometric : at.shading;
        left.direction = bsdf_direction(bsdf, lobe, at.incoming, about, at.uv.x, at.uv.y);
        float factor = shading_cosine_ratio(-at.incoming, at.geometric, at.shading);
        if (lobe != LOBE_DIFFUSE) {
            left.direction = shading_on_side(left.passes, left.direction, at.geometric);
            factor = shading_specular_factor(at.incoming, left.direction, at.geometric, at.shading);
        }
        weight = photon_times(weight, vec3(factor));
    }
    // Where the random number has chosen a lobe, none is left for roulette.
    if (bsdf_splits(bsdf)) left.power = photon_times(left.power, weight);
    else if (!photon_roulette(left.power, weight, choice)) return false;
    if (!SHADING_NORMALS) {
        left.direction = bsdf_direction(bsdf, lobe, at.incoming, at.geometric, at.uv.x, at.uv.y);
    }
    return true;
}

const uint GLOSSY_LOBE_REFLECTION = 0u;
const uint GLOSSY_LOBE_BASE = 1u;
const uint GLOSSY_LOBE_TRANSMISSION = 2u;

// The lobe that `choice` selects, and the uniform number that is left of it.
uint glossy_lobe_choose(Glossy glossy, float choice, out float rest) {
    float first = glossy.specular_probability, second = glossy.transmission_probability;
    rest = glossy_rest(choice, first);
    if (choice < first) return GLOSSY_LOBE_REFLECTION;
    if (!(DIFFUSE_TRANSMISSION && second > 0.0)) return GLOSSY_LOBE_BASE;
    float decides = rest;
    rest = glossy_rest(decides, second);
    return decides < second ? GLOSSY_LOBE_TRANSMISSION : GLOSSY_LOBE_BASE;
}

// From a glossy surface, by a lobe whose probability is divided out. False: the photon is absorbed.
bool photon_glossy(SceneRef scene, Glossy glossy, uint lobe, float rest, Arriving at, out PhotonSample left) {
    float first = glossy.specular_probability;
    left.passes = DIFFUSE_TRANSMISSION && lobe == GLOSSY_LOBE_TRANSMISSION;
    left.power = at.power;
    vec3 weight;
    if (lobe == GLOSSY_LOBE_REFLECTION) {
        Reflected reflected =
            glossy_sample(scene, glossy, -at.incoming, at.shading, at.uv.x, at.uv.y, left.direction);
        bool above = dot3(left.direction, at.geometric) > 0.0 && dot3(at.incoming, at.geometric) < 0.0;
        precise float factor =
            shading_specular_factor(at.incoming, left.direction, at.geometric, at.shading) / first;
        weight = glossy_weight(reflected, above ? factor : 0.0);
    } else {
        float second = glossy.transmission_probability, side = left.passes ? -1.0 : 1.0, share = 1.0 - first;
        if (DIFFUSE_TRANSMISSION && second > 0.0) {
            precise float both = share * (left.passes ? second : 1.0 - second);
            share = both;
        }
        left.direction = cosine_hemisphere(at.geometric * side, at.uv.x, at.uv.y);
        float ratio = shading_cosine_ratio(-at.incoming, at.geometric, at.shading);
        precise float factor =
            glossy_entering(scene, glossy.coat, dot3(left.direction, at.shading) * side) * ratio / share;
        weight = photon_times(left.passes ? glossy.transmitted : glossy.diffuse, vec3(factor));
    }
    return photon_roulette(left.power, weight, rest);
}

// From rough glass. False: the photon is absorbed.
bool photon_rough_glass(RoughSample drawn, Arriving at, out PhotonSample left) {
    // Shading normals may send light to the wrong side.
    bool lands = (dot3(drawn.direction, at.geometric) > 0.0) == drawn.stays && dot3(at.incoming, at.geometric) < 0.0;
    float factor = shading_specular_factor(at.incoming, drawn.direction, at.geometric, at.shading);
    left = PhotonSample(drawn.direction, at.power, !drawn.stays);
    return photon_roulette(left.power, glossy_weight(drawn.found, lands ? factor : 0.0), drawn.rest);
}

#endif

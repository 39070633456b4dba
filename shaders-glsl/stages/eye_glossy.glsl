// Glossy surfaces on camera paths: included by eye.comp, whose Path and push constants it uses.
#ifndef EYE_GLOSSY_GLSL
#define EYE_GLOSSY_GLSL

#include "shading/glossy.glsl"
#include "shading/reflection_lobe.glsl"
#include "shading/rough_glass.glsl"
#include "shading/light_sample.glsl"
#include "shading/light_sampler.glsl"

// The weight of a sample of density `mine` where another technique has density `other`: the balance heuristic.
float balance(float mine, float other) { return mine > 0.0 ? mine / (mine + other) : 1.0; }

// The weight of light that a reflected path has found itself: from light `index` at distance `far`. 0 by way of something
// specular, where photons have the light.
float found_share(Path path, uint index, float far) {
    if (index == NO_LIGHT) return 1.0;
    if (ALL_LIGHTS && path.reflected_pdf < 0.0) return 0.0;
    vec3 position = path.reflected_position, normal = path.reflected_normal;
    LightSampler light_sampler = light_sampler_at(push.scene, WEIGHED, position, normal);
    float chosen = light_sampler_probability(push.scene, light_sampler, index);
    float pdf = ENVIRONMENT && push.scene.lights[index].at.kind == LIGHT_ENVIRONMENT
        ? environment_pdf(push.scene, path.ray.direction)
        : light_sample_pdf(push.scene, index, off_surface(position, normal), path.ray.direction, far);
    return balance(path.reflected_pdf, pdf * chosen);
}

// The side of a surface on which a shadow ray starts.
struct Side {
    vec3 start;
    // Geometric and shading normal on that side.
    vec3 geometric;
    vec3 shading;
    uint media;
    // Of choosing this side.
    float probability;
};

// The light that a shadow ray from glossy surfaces or rough glass finds, as `rule` scatters it to the path: radiance. `normal` is
// the shading normal on the side of the path.
vec3 sampled_light(Path path, uvec4 random, Side side, vec3 normal, uint rule, Glossy glossy, RoughGlass glass) {
    if (push.scene.light_count == 0u) return vec3(0.0);
    LightSampler light_sampler = light_sampler_at(push.scene, WEIGHED, side.start, side.geometric);
    float share;
    uint index = light_sampler_pick(push.scene, light_sampler, random.xw, share);
    LightSample found;
    vec3 from = off_surface(side.start, side.geometric);
    if (!light_sample(push.scene, index, from, vec3(0.0), random, found)) return vec3(0.0);
    vec3 direction = found.ray.direction;
    Reflected scattered = Reflected(vec3(0.0), 0.0);
    if (GLOSSY && rule == SCATTERING_GLOSSY) {
        scattered = glossy_evaluate(push.scene, glossy, -path.ray.direction, direction, normal);
    } else if (ROUGH_GLASS) {
        scattered = rough_glass_evaluate(push.scene, glass, -path.ray.direction, direction, normal);
    }
    vec3 value = light_sample_times(found, glossy_limited(direction, side.geometric, side.shading)) * scattered.value;
    if (!(glossy_greatest(value) > 0.0) || occluded(push.scene, found.ray, random.w)) return vec3(0.0);
    if (may_attenuate(side.media)) value *= transmittance(push.scene, found.ray, found.ray.t_max, side.media);
    share *= side.probability;
    return value * (balance(found.pdf * share, scattered.pdf) / share);
}

// The query that a path leaves at a glossy surface.
struct Leaves {
    // Probability that the path goes on by the reflection instead, where it does not do both.
    float first;
    // Throughput of the query, without `scale`, if it is certain.
    vec3 throughput;
    float scale;
    // Media and coat of the query.
    uvec2 words;
    // Of the light that the base transmits: the probability of a query on the other side, where the path leaves one for
    // either side, and its throughput.
    float transmission_probability;
    vec3 transmitted;
    // Of the reflection of a clearcoat, left instead with this probability.
    float clearcoat_probability;
    vec3 clearcoat_throughput;
    uvec2 clearcoat_words;
    // Of a sheen, likewise, if not of the clearcoat.
    float sheen_probability;
    vec3 sheen_throughput;
    uvec2 sheen_words;
    // From anisotropy_pack.
    uint anisotropy;
};

// For the base. `seen` is the factor from radiance that leaves the surface to its contribution at the camera.
Leaves leaves_base(Glossy glossy, uint media, vec3 seen) {
    return Leaves(glossy.specular_probability, glossy.diffuse * seen, 0.318309886, uvec2(media, glossy.coat),
        glossy.transmission_probability, glossy.transmitted * seen, 0.0, vec3(0.0), uvec2(0u), 0.0, vec3(0.0), uvec2(0u), 0u);
}

// None at all: the path goes on by the reflection.
Leaves leaves_none() {
    return Leaves(1.0, vec3(0.0), 1.0, uvec2(0u), 0.0, vec3(0.0), 0.0, vec3(0.0), uvec2(0u), 0.0, vec3(0.0), uvec2(0u), 0u);
}

// For the reflection: the path goes on in search of other glossy surfaces.
Leaves leaves_reflection(Material material, Layers layers, Glossy glossy, vec3 normal, vec3 seen) {
    vec3 factor;
    uvec2 words = lobe_pack(material, layers, factor);
    Leaves leaves = Leaves(0.5, seen * factor, 1.0, words, 0.0, vec3(0.0), 0.0, vec3(0.0), uvec2(0u), 0.0, vec3(0.0),
        uvec2(0u), 0u);
    // Relative to the normal as the query has it.
    if (ANISOTROPY) leaves.anisotropy = anisotropy_pack(layers, octahedral_unpack(octahedral_pack(normal)));
    float share = glossy.clearcoat_probability;
    if (CLEARCOAT && share > 0.0) {
        leaves.clearcoat_probability = share;
        leaves.clearcoat_words = lobe_pack(clearcoat_reflector(layers), layers_none(), factor);
        leaves.clearcoat_throughput = seen * factor / share;
        float passed = glossy.through / max(1.0 - share, 1.1920929e-7);
        seen *= passed;
        leaves.throughput *= passed;
    }
    float own = glossy.sheen_probability;
    if (SHEEN && own > 0.0) {
        leaves.sheen_probability = own;
        leaves.sheen_words = lobe_pack_sheen(glossy.sheen.roughness);
        leaves.sheen_throughput = seen * glossy.sheen_color / own;
        leaves.throughput *= glossy.sheen_through / max(1.0 - own, 1.1920929e-7);
    }
    return leaves;
}

// Leaves a query at a glossy surface, and continues the path by its reflection; or, where the path has split as often
// as it may, one of the two. Returns whether the path continues.
bool reflect_path(
    inout Path path, uint pixel, Surface at, vec3 offset, vec3 normal, uint media, Glossy glossy, Leaves leaves,
    inout uint found
) {
    float first = leaves.first;
    // The next block, as at glass: the words of this one belong to the surface before.
    path.surfaces++;
    uvec4 random = words(pixel, path.branch, BLOCK_SURFACES + path.surfaces);
    bool splits = first > 0.0 && first < 1.0 && path.splits < MAX_SPLITS;
    bool reflects = splits || unit_f32(random.x) < first;
    if (splits || !reflects) {
        vec3 left = leaves.throughput;
        uvec2 media_coat = leaves.words;
        uint packed = leaves.anisotropy;
        vec3 facing = normal;
        float choice = splits ? unit_f32(random.x) : glossy_rest(unit_f32(random.x), first);
        bool is_above = false;
        if (CLEARCOAT && leaves.clearcoat_probability > 0.0) {
            is_above = choice < leaves.clearcoat_probability;
            if (SHEEN) choice = glossy_rest(choice, leaves.clearcoat_probability);
            if (is_above) {
                left = leaves.clearcoat_throughput;
                media_coat = leaves.clearcoat_words;
                packed = 0u;
                facing = glossy_coat_normal(glossy, normal);
            }
        }
        if (SHEEN && REFLECTIONS && !is_above && choice < leaves.sheen_probability) {
            left = leaves.sheen_throughput;
            media_coat = leaves.sheen_words;
            packed = 0u;
        }
        float scale = leaves.scale / (splits ? 1.0 : 1.0 - first);
        vec3 throughput = left * scale;
        float second = leaves.transmission_probability;
        if (DIFFUSE_TRANSMISSION && !REFLECTIONS && second > 0.0) {
            // Light from both sides, if the path may split once more, or from one of them.
            uint bit = path.splits + (splits ? 1u : 0u);
            float choice = unit_f32(random.x);
            if (!splits) choice = glossy_rest(choice, first);
            float near = 1.0, far = 1.0;
            if (second >= 1.0) near = 0.0;
            else if (bit >= MAX_SPLITS && choice < second) near = 0.0, far = 1.0 / second;
            else if (bit >= MAX_SPLITS) near = 1.0 / (1.0 - second), far = 0.0;
            Path beyond = path;
            if (near > 0.0) beyond.branch |= 1u << bit;
            Surface under = at;
            under.normal = -at.normal;
            vec3 dimmed = leaves.transmitted * (scale * far);
            leave_query(beyond, pixel, under, vec3(0.0), -normal, media_coat, packed, dimmed, found);
            throughput *= near;
        }
        leave_query(path, pixel, at, offset, facing, media_coat, packed, throughput, found);
    }
    if (!reflects || ends(path, pixel)) return false;
    Surface lit = lit_surface(at, normal, offset);
    vec3 onward;
    Reflected reflected = glossy_sample(
        push.scene, glossy, -path.ray.direction, normal, unit_f32(random.y), unit_f32(random.z), onward);
    path.throughput *= glossy_weight(reflected, glossy_limited(onward, lit.normal, normal) / (splits ? 1.0 : first));
    if (path.throughput == vec3(0.0)) return false;
    if (splits) {
        path.branch |= 1u << path.splits;
        path.splits++;
    }
    path.reflected_pdf = reflected.pdf;
    path.reflected_position = lit.start;
    path.reflected_normal = lit.normal;
    path.media = media;
    path.ray = surface_leave(lit, onward);
    return true;
}

#endif

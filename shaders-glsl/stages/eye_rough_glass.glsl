// Rough glass on camera paths: included by eye.comp, whose Path and push constants it uses.
#ifndef EYE_ROUGH_GLASS_GLSL
#define EYE_ROUGH_GLASS_GLSL

#include "shading/rough_glass.glsl"

// Where rays to lights start, on the side of the path or beyond, where they have no offset.
Surface rough_glass_side(bool stays, Surface at, vec3 normal, vec3 offset) {
    if (stays) return lit_surface(at, normal, offset);
    at.normal = -at.normal;
    return at;
}

// The light that a shadow ray from rough glass finds, on the side of the path or beyond: its contribution to the pixel.
vec3 light_through(Path path, uint pixel, Surface at, vec3 offset, vec3 normal, Interface sides, RoughGlass glass) {
    if (push.scene.light_count == 0u) return vec3(0.0);
    uvec4 random = words(pixel, path.branch, BLOCK_LIGHTS + path.surfaces);
    bool stays = unit_f32(words(pixel, path.branch, BLOCK_LIGHT_SIDES + path.surfaces).x) < glass.light_side;
    float of_side = stays ? glass.light_side : 1.0 - glass.light_side;
    Surface from = rough_glass_side(stays, at, normal, offset);
    vec3 geometric = from.normal;
    LightSampler light_sampler = light_sampler_at(push.scene, WEIGHED, from.start, geometric);
    float share;
    uint index = light_sampler_pick(push.scene, light_sampler, random.xw, share);
    LightSample found;
    if (!light_sample(push.scene, index, off_surface(from.start, geometric), vec3(0.0), random, found)) return vec3(0.0);
    vec3 direction = found.ray.direction;
    Reflected scattered = rough_glass_evaluate(push.scene, glass, -path.ray.direction, direction, normal);
    float limited = glossy_limited(direction, geometric, stays ? normal : -normal);
    vec3 value = light_sample_times(found, limited) * scattered.value;
    if (!(glossy_greatest(value) > 0.0) || occluded(push.scene, found.ray, random.w)) return vec3(0.0);
    uint media = stays ? sides.before : sides.transmitted;
    if (may_attenuate(media)) value *= transmittance(push.scene, found.ray, found.ray.t_max, media);
    share *= of_side;
    return path.throughput * radiance_scale(push.scene, push.camera.at.media, media, wavelength_of(path)) * value
        * (balance(found.pdf * share, scattered.pdf) / share);
}

// Continues the path by reflection or transmission. Returns whether it goes on.
bool scatter_path(inout Path path, uint pixel, Surface at, vec3 offset, vec3 normal, Interface sides, RoughGlass glass) {
    path.surfaces++;
    if (truncates(path)) return false;
    uvec4 random = words(pixel, path.branch, BLOCK_SURFACES + path.surfaces);
    RoughSample drawn = rough_glass_sample(push.scene, glass, -path.ray.direction, normal, unit_f32(random.x),
        unit_f32(random.y), unit_f32(random.z));
    Surface from = rough_glass_side(drawn.stays, at, normal, offset);
    vec3 geometric = from.normal;
    float limited = glossy_limited(drawn.direction, geometric, drawn.stays ? normal : -normal);
    path.throughput *= glossy_weight(drawn.found, limited);
    if (path.throughput == vec3(0.0)) return false;
    // Lights on this side are sampled with that probability: it divides the density, so as not to be a factor
    // elsewhere.
    path.reflected_pdf = drawn.found.pdf / (drawn.stays ? glass.light_side : 1.0 - glass.light_side);
    path.reflected_position = from.start;
    path.reflected_normal = geometric;
    if (ALL_LIGHTS) path.shows_all = false;
    path.media = drawn.stays ? sides.before : sides.transmitted;
    path.ray = surface_leave(from, drawn.direction);
    return true;
}

// Adds the light that is sampled at rough glass, and continues the path. Returns whether it goes on.
bool meet_rough_glass(
    inout Path path, uint pixel, Surface at, vec3 offset, vec3 normal, Material material, Interface sides,
    inout vec3 emission
) {
    RoughGlass glass = rough_glass_new(push.scene, material, at.cosine, sides);
    if (POINTS) emission += light_through(path, pixel, at, offset, normal, sides, glass);
    return scatter_path(path, pixel, at, offset, normal, sides, glass);
}

#endif

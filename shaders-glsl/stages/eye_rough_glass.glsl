// Rough glass on camera paths: included by eye.comp, whose Path and push constants it uses.
#ifndef EYE_ROUGH_GLASS_GLSL
#define EYE_ROUGH_GLASS_GLSL

// Where rays to lights start, on the side of the path or beyond, where they have no offset.
Surface rough_glass_side(bool stays, Surface at, vec3 normal, vec3 offset) {
    if (stays) return lit_surface(at, normal, offset);
    at.normal = -at.normal;
    return at;
}

// The side on which a shadow ray starts: that of the path, or beyond.
Side rough_glass_lit_side(Path path, uint pixel, Surface at, vec3 offset, vec3 normal, Interface sides, RoughGlass glass) {
    bool stays = unit_f32(words(pixel, path.branch, BLOCK_LIGHT_SIDES + path.surfaces).x) < glass.light_side;
    Surface from = rough_glass_side(stays, at, normal, offset);
    return Side(from.start, from.normal, stays ? normal : -normal, stays ? sides.before : sides.transmitted,
        stays ? glass.light_side : 1.0 - glass.light_side);
}

// Continues the path by reflection or transmission. Returns whether it goes on.
bool scatter_path(inout Path path, uint pixel, Surface at, vec3 offset, vec3 normal, Interface sides, RoughGlass glass) {
    path.surfaces++;
    if (ends(path, pixel)) return false;
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

#endif

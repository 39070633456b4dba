// Traces the camera path of each pixel through mirrors and glass to diffuse surfaces. Twin of backend-cpu's
// eye.rs: the same random numbers, the same order of a pixel's queries.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

layout(constant_id = 0) const uint FEATURES = 511;
// Maximum number of splits of a path at glass; it then ends in up to 2 to this power of queries.
layout(constant_id = 2) const uint MAX_SPLITS = 2;
// Log2 of the number of random-number path indices reserved for a pixel.
layout(constant_id = 3) const uint PATHS_LOG2 = 2;
// Neighbouring invocations process tiles of 32 pixels; log2 of the number of rows of a tile.
layout(constant_id = 4) const uint TILE_ROWS_LOG2 = 2;
layout(constant_id = 5) const uint MEDIA = 1;
// Number of lights that are weighted at each glossy surface; 0 if lights are chosen by power alone.
layout(constant_id = 6) const uint WEIGHED = 0;
// Camera rays that hit nothing do not see the environment.
layout(constant_id = 7) const bool HIDES_BACKGROUND = false;
// Paths leave queries for the reflection of glossy surfaces, instead of all else.
layout(constant_id = 8) const bool REFLECTIONS = false;
// Shadow rays from triangles with vertex normals start outside the mesh.
layout(constant_id = 9) const bool TERMINATOR_OFFSET = false;
// Reflections at least this rough show caustics of all lights from photons: the bits of a float, all ones if none does.
layout(constant_id = 11) const uint CAUSTIC_ROUGHNESS = 0xFFFFFFFFu;
// Whether other reflections show those of some lights.
layout(constant_id = 12) const bool MARKED = false;
// Paths leave their segments in media that scatter light too, at most so many for each pixel; 0: none.
layout(constant_id = 13) const uint SEGMENTS = 0;

#include "shading/constants.glsl"
#include "film/film.glsl"
#include "device/grid.glsl"
#include "device/long_counter.glsl"
#include "shading/layout.glsl"
#include "shading/octahedral.glsl"
#include "shading/random.glsl"
#include "shading/scene.glsl"
#include "shading/shade.glsl"
#include "shading/coated_light.glsl"
#include "shading/environment.glsl"
#include "shading/gloss_caustics.glsl"
#include "shading/sun.glsl"
#include "shading/scattering.glsl"
#include "shading/shadow_terminator.glsl"
#include "shading/stretches.glsl"

// Log2 of the number of slots of segments for each pixel.
const uint SEGMENT_PLACES_LOG2 = SEGMENTS > 1u ? PATHS_LOG2 : 0u;
const bool ALL_LIGHTS = CAUSTIC_ROUGHNESS != 0xFFFFFFFFu;
const bool THIN_LENS = (FEATURES & FEATURE_THIN_LENS) != 0u;

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    SceneRef scene;
    Cameras camera;
    FirstPass first;
    Planes emission;
    // 2 to the power of MAX_SPLITS slots for each place, and the number of them that are filled.
    Queries found;
    Words counts;
    // Those of segments.
    Queries segments;
    Words segment_counts;
    uvec2 seed;
    // Number of paths that were truncated.
    LongCounter truncated;
    uint pass;
    // DOMAIN_EYE, and the first camera sample in the upper half.
    uint domain;
    uint width;
    uint height;
    // Range of rows of this dispatch, of as many pictures as there are samples, one below the other.
    uint start_row;
    uint end_row;
    uint max_bounces;
    uint samples;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// The pixel of the path in these pictures, where it leaves queries and light; and `push.domain` with its own sample.
uint place;
uint domain;

// An active camera path.
struct Path {
    Ray ray;
    // In terms of radiance / n^2, which refraction does not change.
    vec3 throughput;
    uint media;
    uint surfaces;
    // Number of total reflections; with DISPERSION also the wavelength << 16.
    uint total;
    uint splits;
    // Index of this path among the pixel's paths; a key of random numbers.
    uint branch;
    // The glossy surface or rough glass that it left last: density of the direction, 0 without one, or negative if
    // something specular lies between (which is only distinguished from 0 for the sun, and with ALL_LIGHTS); position;
    // geometric normal; whether photons show light that arrives there by way of something specular.
    float reflected_pdf;
    vec3 reflected_position;
    vec3 reflected_normal;
    bool shows_all;
    // With SEGMENTS the normal of the last surface of any kind, on either side; the direction of the ray at the camera.
    vec3 start;
};

// Whether light that the path finds is not counted in full: where shadow rays or photons find it too.
bool weighs_lights(Path path) { return path.reflected_pdf > 0.0 || (ALL_LIGHTS && path.shows_all); }

uint wavelength_of(Path path) {
    if (DISPERSION) return path.total >> 16;
    return NO_WAVELENGTH;
}

// Throughput of radiance that arrives in a stack of media: its contribution at the camera.
vec3 seen_through(Path path, uint media) {
    if (!GLASS) return path.throughput;
    return path.throughput * radiance_scale(push.scene, push.camera.at.media, media, wavelength_of(path));
}

uvec4 words(uint pixel, uint branch, uint block) {
    return philox4x32(uvec4((pixel << PATHS_LOG2) + branch, block, push.pass, domain), push.seed);
}

// Whether a path that is to go on ends: it has met as many surfaces as it may, or is trapped, which is counted if light is
// missing; or by Russian roulette, since it is dark.
bool ends(inout Path path, uint pixel) {
    vec3 left = path.throughput;
    bool is_dark = max(max(left.x, left.y), left.z) < NEGLIGIBLE_THROUGHPUT;
    uint total = path.total;
    if (DISPERSION) total &= 0xFFFFu;
    bool is_trapped = GLASS && total > most_total_reflections(push.max_bounces);
    if (path.surfaces >= push.max_bounces || is_trapped) {
        if (!is_dark) count_one(push.truncated);
        return true;
    }
    if (!is_dark) return false;
    float factor = russian_roulette(left, words(pixel, path.branch, BLOCK_LIGHT_SIDES + path.surfaces).y);
    path.throughput = left * factor;
    return factor == 0.0;
}

// Continues the path from `at`; if it splits there, the other path is returned in `other`.
// `normal` is the shading normal.
bool go_on(inout Path path, out Path other, uint pixel, Surface at, vec3 normal, Bsdf bsdf, uint transmitted) {
    bool split = false;
    uint lobe = bsdf_choose(bsdf, 0.0);
    if (bsdf_splits(bsdf)) {
        split = bsdf.reflectance > 0.0 && bsdf.reflectance < 1.0 && path.splits < MAX_SPLITS;
        if (split) {
            other = path;
            vec3 onward =
                bsdf_direction(bsdf, LOBE_SPECULAR_REFLECTION, path.ray.direction, normal, 0.0, 0.0);
            if (SHADING_NORMALS) onward = shading_on_side(false, onward, at.normal);
            other.ray = surface_leave(at, onward);
            vec3 share = path.throughput * bsdf.reflectance;
            other.throughput = share;
            other.branch |= 1u << path.splits;
            other.splits++;
            other.reflected_pdf = (SUN || ALL_LIGHTS) && path.reflected_pdf != 0.0 ? -1.0 : 0.0;
            lobe = LOBE_SPECULAR_TRANSMISSION;
        } else {
            uvec4 choice = words(pixel, path.branch, BLOCK_SURFACES + path.surfaces);
            lobe = bsdf_choose(bsdf, unit_f32(choice.x));
        }
    }
    vec3 onward = bsdf_direction(bsdf, lobe, path.ray.direction, normal, 0.0, 0.0);
    if (SHADING_NORMALS) onward = shading_on_side(lobe == LOBE_SPECULAR_TRANSMISSION, onward, at.normal);
    path.throughput *= bsdf_weight(bsdf, lobe);
    path.reflected_pdf = (SUN || ALL_LIGHTS) && path.reflected_pdf != 0.0 ? -1.0 : 0.0;
    if (lobe == LOBE_SPECULAR_TRANSMISSION) {
        path.ray = surface_pass(at, onward);
        path.media = transmitted;
    } else {
        path.ray = surface_leave(at, onward);
    }
    if (split) {
        vec3 rest = path.throughput * (1.0 - bsdf.reflectance);
        path.throughput = rest;
        path.splits++;
    }
    return split;
}

// The surface as rays to lights see it, and paths that are weighed against them: `offset` is that of shadow rays.
Surface lit_surface(Surface at, vec3 normal, vec3 offset) {
    if (!TERMINATOR_OFFSET || offset == vec3(0.0)) return at;
    at.start += offset;
    at.normal = normal;
    return at;
}

// Adds a query at a surface point, unless it has no effect.
void leave_query(
    Path path, uint pixel, Surface at, vec3 offset, vec3 normal, uvec2 media_coat, uint anisotropy, vec3 throughput,
    inout uint found
) {
    if (throughput == vec3(0.0)) return;
    uint key = (pixel << PATHS_LOG2) + path.branch;
    if (REFLECTIONS && ANISOTROPY) key = anisotropy_path_word(key, anisotropy);
    uint offset_or_wo = 0u;
    if (REFLECTIONS) offset_or_wo = octahedral_pack(-path.ray.direction);
    if (REFLECTIONS && ALL_LIGHTS) offset_or_wo = gloss_caustics_with_mark(offset_or_wo, path.shows_all);
    if (!REFLECTIONS && TERMINATOR_OFFSET) offset_or_wo = shadow_terminator_pack(offset);
    // Moved away from edges, next to which rounding might put it behind the adjacent wall, out of its shadow.
    push.found[(place << MAX_SPLITS) + found].at = Query(
        at.start, 1.0, at.normal, place, throughput, media_coat.x, offset_or_wo, key,
        SHADING_NORMALS || REFLECTIONS ? octahedral_pack(normal) : 0u, media_coat.y);
    found++;
}

#include "stages/camera_ray.glsl"
#include "stages/eye_glossy.glsl"
#include "stages/eye_rough_glass.glsl"
#include "stages/eye_segments.glsl"

void main() {
    const uint columns_log2 = 5 - TILE_ROWS_LOG2;
    uint tile = thread() >> 5;
    uint within = thread() & 31;
    uint tiles_across = ((push.width - 1) >> columns_log2) + 1;
    uint x = (tile % tiles_across << columns_log2) + (within & ((1u << columns_log2) - 1));
    uint y = push.start_row + (tile / tiles_across << TILE_ROWS_LOG2) + (within >> columns_log2);
    if (x >= push.width || y >= push.end_row) return;
    uint camera_sample = y / push.height;
    place = y * push.width + x;
    domain = push.domain + (camera_sample << 16);
    y -= camera_sample * push.height;
    uint pixel = y * push.width + x;
    uvec4 jitter = words(pixel, 0, BLOCK_START);
    if (domain != DOMAIN_EYE) {
        // Points of further samples follow that of the first.
        uvec4 first = philox4x32(uvec4(pixel << PATHS_LOG2, BLOCK_START, push.pass, DOMAIN_EYE), push.seed);
        jitter.xy = evenly_spread(first.xy, domain >> 16);
    }
    precise float across = 2.0 * (float(x) + unit_f32(jitter.x)) / float(push.width) - 1.0;
    precise float down = 2.0 * (float(y) + unit_f32(jitter.y)) / float(push.height) - 1.0;
    Ray ray;
    if (THIN_LENS) ray = ray_through_lens(across, -down, jitter.zw);
    else ray = ray_through_pinhole(across, -down);
    uint media = GLASS ? push.camera.at.media : VACUUM;
    Path path = Path(ray, vec3(1.0), media, 0, 0, 0, 0, 0.0, vec3(0.0), vec3(0.0), false, ray.direction);

    // No path splits more than twice, so that at most two wait.
    Path waiting[2];
    uint waits = 0;
    uint found = 0, segments = 0;
    Reservoir reservoir = Reservoir(0u, 0.0, 0.0);
    vec3 emission = vec3(0.0);
    bool alive = true;
    while (alive) {
        Hit hit;
        uint word = 0u;
        if (RANDOM_SURFACES) word = words(pixel, path.branch, BLOCK_SURFACES + path.surfaces).w;
        alive = nearest(push.scene, path.ray, word, hit);
        bool escaped = !alive;
        Surface at;
        Material material;
        vec3 normal;
        Layers layers = layers_none();
        Interface sides;
        sides.before = path.media;
        float end = NO_LIMIT;
        if (!escaped) {
            at = surface_met(push.scene, path.ray.direction, hit, word);
            material = push.scene.materials[at.material].at;
            normal = at.normal;
            if (SHADED) normal = shade(push.scene, at, hit, material, layers);
            if (BENT_NORMALS && material.kind != MATERIAL_LAMBERT) shade_specular(at, path.ray.direction, normal);
            if (path.surfaces == 0 && !REFLECTIONS) {
                FirstPass first = push.first + place;
                // Sums over the camera samples of the pass; stale before the first hit.
                uint hits = first.hits;
                first.normal = hits == 0 ? normal : first.normal + normal;
                first.depth = hits == 0 ? at.t : first.depth + at.t;
                first.albedo = hits == 0 ? material.albedo : first.albedo + material.albedo;
                first.hits = hits + 1;
            }
            sides = media_interface(push.scene, material, at.front, path.media);
            end = at.t;
        }
        vec3 passed = vec3(1.0);
        if (SEGMENTS != 0u) {
            vec3 plane = escaped ? path.ray.direction : -at.normal;
            passed = leave_segments(path, pixel, sides.before, end, plane, reservoir, segments);
            if (!escaped) path.start = at.normal;
        } else if (may_attenuate(sides.before)) {
            passed = transmittance(push.scene, path.ray, end, sides.before);
        }
        if (!escaped || BOUNDARIES) path.throughput *= passed;
        if (DISPERSION && !escaped && media_is_dispersive(push.scene, sides)) {
            uint key = (pixel << PATHS_LOG2) + path.branch;
            uint drawn = wavelength_word(push.seed, push.pass, domain, key, 0u);
            uint wavelength = wavelength_of(path);
            media_disperse(push.scene, sides, wavelength, path.throughput, drawn);
            path.total = path.total & 0xFFFFu | wavelength << 16;
        }
        // The factor from radiance that arrives along the ray to its contribution at the camera.
        vec3 seen = seen_through(path, sides.before);
        if (!escaped) {
            if ((FEATURES & FEATURE_AREA_LIGHTS) != 0 && !REFLECTIONS && material.emission != vec3(0.0)
                && (at.front || (material.flags & MATERIAL_EMITS_BOTH_SIDES) != 0)) {
                vec3 throughput = seen;
                if (FOLLOWED && weighs_lights(path)) {
                    throughput *= found_share(path, light_of_triangle(push.scene, hit.primitive), at.t);
                }
                if (COATED_LIGHTS) {
                    throughput *= emission_through(push.scene, hit.slot, hit.u, hit.v, -path.ray.direction);
                }
                emission += throughput * material.emission;
            }
            vec3 offset = vec3(0.0);
            if (TERMINATOR_OFFSET && SHADING_NORMALS && material_samples_lights(material)) {
                offset = shadow_terminator_at(push.scene, hit, at, word);
            }
            uint rule = scattering_at(material, sides);
            Glossy glossy;
            RoughGlass glass;
            if (GLOSSY && rule == SCATTERING_GLOSSY) {
                glossy = glossy_at(push.scene, material, layers, at.cosine, -path.ray.direction, false);
            } else if (ROUGH_GLASS && rule == SCATTERING_ROUGH_GLASS) {
                glass = rough_glass_new(push.scene, material, at.cosine, sides);
            }
            if (FOLLOWED && !REFLECTIONS && rule != SCATTERING_SIMPLE) {
                Surface lit = lit_surface(at, normal, offset);
                Side side = Side(lit.start, lit.normal, normal, sides.before, 1.0);
                if (ROUGH_GLASS && rule == SCATTERING_ROUGH_GLASS) {
                    side = rough_glass_lit_side(path, pixel, at, offset, normal, sides, glass);
                }
                uvec4 random = words(pixel, path.branch, BLOCK_LIGHTS + path.surfaces);
                emission += seen_through(path, side.media) * sampled_light(path, random, side, normal, rule, glossy, glass);
            }
            if (GLOSSY && rule == SCATTERING_GLOSSY) {
                if (ALL_LIGHTS) {
                    float least = uintBitsToFloat(CAUSTIC_ROUGHNESS);
                    path.shows_all = gloss_caustics_narrowest(material, layers) >= least;
                }
                Leaves leaves;
                if (REFLECTIONS && ALL_LIGHTS && !MARKED && !path.shows_all) {
                    leaves = leaves_none();
                } else if (REFLECTIONS) {
                    leaves = leaves_reflection(material, layers, glossy, normal, seen);
                } else {
                    leaves = leaves_base(glossy, sides.before, seen);
                }
                alive = reflect_path(path, pixel, at, offset, normal, sides.before, glossy, leaves, found);
            } else if (ROUGH_GLASS && rule == SCATTERING_ROUGH_GLASS) {
                alive = scatter_path(path, pixel, at, offset, normal, sides, glass);
            } else {
                Bsdf bsdf = bsdf_new(material, at.cosine, sides);
                if (bsdf.kind == MATERIAL_LAMBERT) {
                    vec3 throughput = seen * bsdf.albedo * 0.318309886;
                    uvec2 media_coat = uvec2(sides.before, 0u);
                    if (!REFLECTIONS) leave_query(path, pixel, at, offset, normal, media_coat, 0u, throughput, found);
                    alive = false;
                } else {
                    path.surfaces++;
                    if (bsdf_is_total(bsdf)) path.total++;
                    alive = !ends(path, pixel);
                    Path other;
                    if (alive && go_on(path, other, pixel, at, normal, bsdf, sides.transmitted)) {
                        waiting[waits] = other;
                        waits++;
                    }
                }
            }
        } else if (!REFLECTIONS && !(HIDES_BACKGROUND && path.surfaces == 0)) {
            if (ENVIRONMENT) {
                vec3 throughput = seen;
                if (FOLLOWED && weighs_lights(path)) {
                    // It is among the last lights.
                    uint index = push.scene.light_count;
                    while (index > 0u && push.scene.lights[index - 1u].at.kind != LIGHT_ENVIRONMENT) --index;
                    throughput *= found_share(path, index > 0u ? index - 1u : NO_LIGHT, 0.0);
                }
                emission += throughput * environment_radiance(push.scene, path.ray.direction);
            }
            // Shadow rays and photons find the sun for paths with glossy surfaces.
            if (SUN && path.reflected_pdf == 0.0) emission += seen * sun_radiance(push.scene, path.ray.direction);
        }
        if (!alive && waits > 0) {
            waits--;
            path = waiting[waits];
            alive = true;
        }
    }
    push.counts[place].at = found;
    if (SEGMENTS != 0u) {
        close_reservoir(reservoir, segments);
        push.segment_counts[place].at = segments;
    }
    const uint lit = FEATURE_AREA_LIGHTS | FEATURE_ENVIRONMENT | FEATURE_SUN | FEATURE_GLOSSY | FEATURE_ROUGH_GLASS;
    if ((FEATURES & lit) != 0 && !REFLECTIONS && emission != vec3(0.0)) {
        for (uint c = 0; c < 3; c++) {
            Planes light = film_place(push.emission, c, push.width * push.height * push.samples, place);
            light.at += emission[c];
        }
    }
}

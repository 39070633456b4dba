// Samples of lights, for shadow rays: twin of backend-cpu's light_sample.rs.
#ifndef LIGHT_SAMPLE_GLSL
#define LIGHT_SAMPLE_GLSL

#include "shading/constants.glsl"
#include "shading/environment.glsl"
#include "shading/light_intensity.glsl"
#include "shading/offset.glsl"
#include "shading/random.glsl"
#include "shading/sampling.glsl"
#include "shading/scene.glsl"
#include "shading/shade.glsl"
#include "shading/solid_angle.glsl"
#include "shading/sun.glsl"

// A sampled direction towards a light: radiance over density, times a cosine c, is color * (factor * c / divisor).
struct LightSample {
    Ray ray;
    vec3 color;
    float factor;
    float divisor;
    // Density per solid angle, if this light was chosen; 0 for lights that only shadow rays find.
    float pdf;
};

vec3 light_sample_times(LightSample found, float cosine) {
    return found.color * (found.factor * cosine / found.divisor);
}

// The triangle of an area light as seen from a point.
struct LightView {
    // Relative to the eye, which is as far behind the point as shadow rays end above the light.
    vec3 a, b, c;
    // Normal of the triangle on the side of the point.
    vec3 front;
    // Distance of the eye from the plane, above 0 in front of the light.
    float height;
    bool near;
};

LightView light_view(Emission area_light, Light light, vec3 from) {
    LightView view;
    view.front = area_light.normal;
    if ((light.flags & LIGHT_BOTH_SIDES) != 0 && dot3(area_light.normal, from - area_light.a) < 0.0) {
        view.front = -area_light.normal;
    }
    vec3 eye = off_surface(from, -view.front);
    view.a = area_light.a - eye;
    view.b = area_light.b - eye;
    view.c = area_light.c - eye;
    view.height = -dot3(view.front, view.a);
    view.near = solid_angle_is_near(view.a, view.b, view.c);
    return view;
}

// Samples a point of a triangle, on the side that faces the query; returns false if none does.
bool at_area_light(
    Emission area_light, Light light, vec3 from, vec3 normal, float u, float v, out Target target) {
    LightView view = light_view(area_light, light, from);
    target.front = view.front;
    target.per_pdf = 0.0;
    target.to = area_light.a;
    target.weights = vec2(0.0);
    if (!(view.height > (view.near ? SOLID_ANGLE_MIN_HEIGHT : 0.0))) return false;
    vec2 weights;
    if (!view.near
        || !solid_angle_sample(
            view.a, view.b, view.c, view.height, light.area, normal, u, v, weights, target.per_pdf)) {
        weights = sampling_triangle(u, v);
    }
    target.weights = weights;
    target.to = off_surface(barycentric(area_light.a, area_light.b, area_light.c, weights.x, weights.y), target.front);
    return true;
}

// The density with which a direction from `from` that hits the triangle of light `index` at `far` is sampled, if this
// light is chosen; 0 if the light is not sampled from there.
float light_sample_pdf(SceneRef scene, uint index, vec3 from, vec3 direction, float far) {
    Light light = scene.lights[index].at;
    Emission area_light = scene.emissions[index].at;
    LightView view = light_view(area_light, light, from);
    if (!(view.height > (view.near ? SOLID_ANGLE_MIN_HEIGHT : 0.0))) return 0.0;
    if (view.near) {
        float whole = solid_angle_of(view.a, view.b, view.c, view.height, light.area);
        if (whole > 0.0) return 1.0 / whole;
    }
    float cosine = -dot3(direction, view.front);
    return cosine > 0.0 ? far * far / (light.area * cosine) : 0.0;
}

// Samples light from infinity, that of a directional light or of the environment. Returns false for other lights.
bool light_sample_far(SceneRef scene, Light light, vec3 from, uvec4 words, out LightSample found) {
    found = LightSample(Ray(from, vec3(0.0, 0.0, 1.0), 0.0), light.power, 1.0, 1.0, 0.0);
    if ((FEATURES & FEATURE_DIRECTIONAL_LIGHTS) != 0 && light.kind == LIGHT_DIRECTIONAL) {
        vec3 direction = -light.direction;
        if (SUN && is_sun(light)) {
            float versine = sun_versine(light.versine_outer, unit_f32(words.y));
            direction = sampling_about(direction, versine, unit_f32(words.z));
            found.factor = 1.0 / (1.0 - versine);
        }
        found.ray = Ray(from, direction, NO_LIMIT);
        found.divisor = 3.14159265 * light.radius * light.radius;
        return true;
    }
    if (ENVIRONMENT && light.kind == LIGHT_ENVIRONMENT) {
        EnvironmentSample sky = environment_sample(scene, words.yz);
        found.ray = Ray(from, sky.direction, NO_LIMIT);
        found.color = sky.weight;
        found.pdf = sky.pdf;
        return true;
    }
    return false;
}

// Samples a light as seen from `from`, a point just above the surface. Returns false if the light faces the other way. Unless the
// normal is 0, directions to a nearby area light are roughly in proportion to the cosine to it; light_sample_pdf is without.
bool light_sample(SceneRef scene, uint index, vec3 from, vec3 normal, uvec4 words, out LightSample found) {
    Light light = scene.lights[index].at;
    if (light_sample_far(scene, light, from, words, found)) return true;
    bool is_area = (FEATURES & FEATURE_AREA_LIGHTS) != 0 && light.kind == LIGHT_TRIANGLE;
    Target target = Target(light.position, vec3(0.0), 0.0, vec2(0.0));
    if (is_area
        && !at_area_light(scene.emissions[index].at, light, from, normal, unit_f32(words.y), unit_f32(words.z), target)) {
        return false;
    }
    vec3 gap = target.to - from;
    float square = dot3(gap, gap);
    float far = sqrt(square);
    vec3 direction = gap / far;
    found.ray = Ray(from, direction, far);
    if (!is_area) {
        found.color = light_intensity_of_point(light, direction);
        found.divisor = square;
        return found.color != vec3(0.0);
    }
    found.color = light_power_from_area(scene, index, light, target.weights, direction);
    if (target.per_pdf > 0.0) {
        // The radiance is the power divided by π and the area.
        found.factor = target.per_pdf * 0.318309886 / light.area;
        found.pdf = 1.0 / target.per_pdf;
        return true;
    }
    float cosine = -dot3(direction, target.front);
    found.color *= light_lambert(cosine);
    found.divisor = square;
    found.pdf = square / (light.area * cosine);
    return found.color != vec3(0.0);
}

#endif

// Environment maps: twin of photon-core's environment.rs.
#ifndef ENVIRONMENT_GLSL
#define ENVIRONMENT_GLSL

#include "shading/math.glsl"
#include "shading/scene.glsl"

const bool ENVIRONMENT = (FEATURES & FEATURE_ENVIRONMENT) != 0u;

vec3 environment_texel(SceneRef scene, uint x, uint y) {
    vec4 texel = scene.environment.texels[y * scene.environment.width + x].at;
    return texel.xyz;
}

vec3 environment_mix(vec3 from, vec3 to, float share) {
    precise vec3 mixed = from * (1.0 - share) + to * share;
    return mixed;
}

vec3 environment_row(SceneRef scene, uint first, uint second, float across, uint y) {
    return environment_mix(environment_texel(scene, first, y), environment_texel(scene, second, y), across);
}

// A coordinate in texels, from the centre of the first.
float environment_place(float share, uint size) {
    precise float place = share * float(size) - 0.5;
    return place;
}

vec3 environment_bilinear(SceneRef scene, float u, float v) {
    uint width = scene.environment.width, height = scene.environment.height;
    float x = environment_place(u, width), y = environment_place(v, height);
    float left = floor(x), above = floor(y);
    precise float across = x - left;
    precise float down = y - above;
    uint first = left < 0.0 ? width - 1u : min(uint(max(left, 0.0)), width - 1u);
    uint second = first + 1u == width ? 0u : first + 1u;
    uint upper = min(uint(max(above, 0.0)), height - 1u);
    uint lower = min(uint(above + 1.0), height - 1u);
    return environment_mix(environment_row(scene, first, second, across, upper),
        environment_row(scene, first, second, across, lower), down);
}

float environment_across(vec3 direction) {
    precise float squared = direction.x * direction.x + direction.z * direction.z;
    return sqrt(squared);
}

float environment_turns(float from_centre, float rotation) {
    precise float u = 0.5 + from_centre + rotation;
    precise float inside = u - floor(u);
    return inside;
}

// Radiance that arrives from `direction`.
vec3 environment_radiance(SceneRef scene, vec3 direction) {
    float from_centre = copysign(turns_of(abs(direction.x), -direction.z), direction.x);
    float u = environment_turns(from_centre, scene.environment.rotation);
    return environment_bilinear(scene, u, 2.0 * turns_of(environment_across(direction), direction.y));
}

// An interval of a table of starts: its index, the position in it, and its probability.
struct EnvironmentInterval {
    uint index;
    float within;
    float probability;
};

// The position of a random word in its interval, in (0, 1).
float environment_within(uint offset, float whole) {
    precise float within = (float(offset) + 0.5) / whole;
    return min(within, 1.0 - 1.1920929e-7);
}

// The interval of `count` starts, from the entry `first` of all starts on, that contains `random`. The guide tables follow all
// starts, in the same order.
EnvironmentInterval environment_interval(SceneRef scene, uint first, uint count, uint random) {
    uint guide = scene.environment.rows_count * (scene.environment.columns + 1u) + first;
    uint part, unused;
    umulExtended(random, count, part, unused);
    uint low = scene.environment.starts[guide + part].at;
    uint high = part + 1u < count ? scene.environment.starts[guide + part + 1u].at + 1u : count;
    while (high - low > 1u) {
        uint middle = low + (high - low) / 2u;
        if (scene.environment.starts[first + middle].at <= random) low = middle;
        else high = middle;
    }
    uint start = scene.environment.starts[first + low].at;
    uint end = low + 1u < count ? scene.environment.starts[first + low + 1u].at : 0u;
    uint span = end - start;
    float whole = span == 0u ? 4294967296.0 : float(span);
    return EnvironmentInterval(low, environment_within(random - start, whole), whole * (1.0 / 4294967296.0));
}

struct EnvironmentSample {
    vec3 direction;
    vec3 weight;
    // Density per solid angle.
    float pdf;
};

// The direction at a position within a cell, of `texels` texels from `first` on.
vec3 environment_direction(vec3 cell, float within_row, float within_column, float first, float texels, float span,
    float rotation) {
    // `cell`: above, below, extent. From the nearer pole, where differences are small.
    precise float height = cell.z * within_row;
    precise float from_top = cell.x + height;
    precise float from_bottom = cell.y + (cell.z - height);
    bool upper = from_top < 0.5;
    precise float low = upper ? from_top : 1.0 - from_bottom;
    precise float high = upper ? 1.0 - from_top : from_bottom;
    precise float cosine = upper ? 1.0 - 2.0 * low : 2.0 * high - 1.0;
    precise float sine = 2.0 * sqrt(max(low * high, 0.0));
    precise float turns = (first + 0.5 + texels * within_column) * span - 0.5 - rotation;
    precise float inside = turns - floor(turns);
    vec2 sin_cos = sin_cos_turns(inside);
    precise vec3 direction = vec3(sin_cos.x * sine, cosine, -sin_cos.y * sine);
    return direction;
}

vec3 environment_weight(vec3 radiance, float extent, float share, float row, float column) {
    precise float solid_angle = 4.0 * 3.14159265 * extent * share;
    precise vec3 weight = radiance * (solid_angle / (row * column));
    return weight;
}

float environment_density(float extent, float share, float row, float column) {
    precise float solid_angle = 4.0 * 3.14159265 * extent * share;
    precise float density = row * column / solid_angle;
    return density;
}

// A direction for two random words.
EnvironmentSample environment_sample(SceneRef scene, uvec2 words) {
    uint rows = scene.environment.rows_count, columns = scene.environment.columns;
    EnvironmentInterval row = environment_interval(scene, 0u, rows, words.x);
    EnvironmentInterval column = environment_interval(scene, rows + row.index * columns, columns, words.y);
    vec4 cell = scene.environment.rows[row.index].at;
    uint step = scene.environment.step_texels, width = scene.environment.width;
    float span = 1.0 / float(width);
    float first = float(column.index * step);
    float texels = float(min((column.index + 1u) * step, width)) - first;
    EnvironmentSample found;
    found.direction = environment_direction(
        cell.xyz, row.within, column.within, first, texels, span, scene.environment.rotation);
    found.weight = environment_weight(
        environment_radiance(scene, found.direction), cell.z, texels * span, cell.w, column.probability);
    found.pdf = environment_density(cell.z, texels * span, cell.w, column.probability);
    return found;
}

// The density with which a direction is sampled.
float environment_pdf(SceneRef scene, vec3 direction) {
    uint width = scene.environment.width, height = scene.environment.height;
    uint step = scene.environment.step_texels, columns = scene.environment.columns;
    float from_centre = copysign(turns_of(abs(direction.x), -direction.z), direction.x);
    float x = environment_place(environment_turns(from_centre, scene.environment.rotation), width);
    uint column = (x < 0.0 ? width - 1u : min(uint(max(x, 0.0)), width - 1u)) / step;
    precise float y = 2.0 * turns_of(environment_across(direction), direction.y) * float(height) + 0.5;
    uint row = min(uint(y), height) / step;
    vec4 cell = scene.environment.rows[row].at;
    uint first = scene.environment.rows_count + row * columns;
    uint start = scene.environment.starts[first + column].at;
    uint end = column + 1u < columns ? scene.environment.starts[first + column + 1u].at : 0u;
    float span = end == start ? 4294967296.0 : float(end - start);
    precise float share = float(min((column + 1u) * step, width) - column * step) / float(width);
    return environment_density(cell.z, share, cell.w, span * (1.0 / 4294967296.0));
}

#endif

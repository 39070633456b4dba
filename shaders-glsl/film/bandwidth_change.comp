// The change of a pixel's r², from the noise and the bias around it.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
layout(local_size_x_id = 1) in;

// Bit masks of the layers and of the maps that exist.
layout(constant_id = 2) const uint LAYERS = 15;
layout(constant_id = 3) const uint MAPS = 7;

#include "film/bandwidth.glsl"

// Whether one of two biases is more than twice the other, beyond 3 standard errors.
bool exceeds(float a, float a_error, float b, float b_error) {
    return abs(a) - 2.0 * abs(b) > 3.0 * sqrt(a_error * a_error + 4.0 * b_error * b_error);
}

// The mean over passes of a sum, and its standard error.
vec2 mean_and_error(uint sum, uint square_sum, uint pixel) {
    float mean = error_sum(sum, pixel) / push.passes;
    float square = error_sum(square_sum, pixel) / push.passes;
    precise float spread = square - mean * mean;
    return vec2(mean, sqrt(max(spread, 0.0) / (push.passes - 1.0)));
}

// The sum over passes and channels of a layer.
float layer(Planes sums, uint pixel) {
    float sum = 0.0;
    for (uint c = 0u; c < 3u; c++) sum += film_place(sums, c, push.pixels, pixel).at;
    return sum;
}

// Whether the interval of the pixel has to allow for an edge: `ConfidenceInterval::reasons`. Of pixels where only stray photons
// were found it is not asked whether their surface could store any.
bool has_edge(uint pixel) {
    vec2 wide = mean_and_error(ERROR_BIAS, ERROR_BIAS_SQUARE, pixel);
    vec2 narrow = 2.0 * mean_and_error(ERROR_NARROW, ERROR_NARROW_SQUARE, pixel);
    bool curved = exceeds(wide.x, wide.y, narrow.x, narrow.y) || exceeds(narrow.x, narrow.y, wide.x, wide.y);
    float photons = 0.0, found = 0.0, doubtful = 0.0;
    bool edge = curved;
    [[unroll]] for (uint map = 0u; map < MAP_COUNT; ++map) {
        if ((MAPS >> map & 1u) == 0u) continue;
        float moments[MOMENTS_LOW];
        for (uint i = 0u; i < MOMENTS_LOW; i++) {
            moments[i] = film_place(push.photon_moments[map], i, push.pixels, pixel).at;
        }
        float power = moments[MOMENTS_POWER];
        float squared = moments[MOMENTS_POWER_SQUARED];
        float stray = moments[MOMENTS_STRAY];
        float count = squared > 0.0 ? power * (power / squared) : 0.0;
        bool strays = stray > MOMENTS_MAX_STRAY * (power + stray);
        bool uneven = false;
        if (count >= MOMENTS_MIN_PHOTONS) {
            float offset = length(vec2(moments[MOMENTS_SLOPE], moments[MOMENTS_SLOPE + 1u]) / power);
            float four = length(vec2(moments[MOMENTS_QUADRUPOLE], moments[MOMENTS_QUADRUPOLE + 1u]) / power);
            uneven = offset > MOMENTS_MAX_OFFSET || (four > MOMENTS_MAX_QUADRUPOLE && four > 3.0 * sqrt(1.0 / (6.0 * count)));
        }
        // A map without photons gave none of its layer.
        float light = power > 0.0 ? layer(push.lights[map], pixel) : 0.0;
        photons += count;
        found += light;
        if (strays || uneven) {
            edge = true;
            doubtful += light;
        }
    }
    if (!edge) return false;
    float sum = 0.0;
    [[unroll]] for (uint i = 0u; i < 4u; ++i) {
        if ((LAYERS >> i & 1u) != 0u) sum += layer(push.sums[i], pixel);
    }
    bool few = photons < INTERVAL_MIN_PHOTONS;
    if (few || curved) doubtful = found;
    return doubtful > INTERVAL_MINOR * sum || (few && photons < INTERVAL_MIN_BOUNDED_PHOTONS);
}

// The factor on r² that minimizes the error, within bounds; 1 where no photon was found.
float change(float noise_squared, float bias_squared) {
    if (!(noise_squared > 0.0)) return 1.0;
    float twice = 2.0 * bias_squared;
    if (noise_squared >= RADII_STEP * RADII_STEP * RADII_STEP * twice) return RADII_STEP;
    return clamp(cube_root(noise_squared / twice), 1.0 / RADII_STEP, RADII_STEP);
}

void main() {
    uint pixel = thread();
    if (pixel >= push.pixels) return;
    int width = int(push.width);
    int height = int(push.pixels / push.width);
    int x = int(pixel) % width, y = int(pixel) / width;
    float bias_squared = 0.0, variance = 0.0;
    for (int row = max(y - int(RADII_REACH), 0); row <= min(y + int(RADII_REACH), height - 1); row++) {
        for (int column = max(x - int(RADII_REACH), 0); column <= min(x + int(RADII_REACH), width - 1); column++) {
            uint other = uint(row * width + column);
            bias_squared += radii_read(BIAS_SQUARED, other);
            variance += radii_read(BIAS_VARIANCE, other);
        }
    }
    // The square of the mean difference contains its own variance.
    float bias = max(bias_squared - variance, 0.0) * push.bias * push.bias;
    float step = change(variance * push.noise, bias);
    // Across an edge a second radius is a poor measure of the bias: do not increase the radius there.
    radii_write(CHANGE, pixel, step > 1.0 && has_edge(pixel) ? 0.0 : log(step));
}

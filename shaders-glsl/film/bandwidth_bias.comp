// The squared mean of the bias over the passes since the last update, and the variance of that mean.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
layout(local_size_x_id = 1) in;

#include "film/bandwidth.glsl"

// What was added to a sum since the last update.
float added(uint plane, uint before, uint pixel) {
    float high = error_sum(plane, pixel);
    float low = error_sum(plane + ERROR_LOW, pixel);
    precise float sum = (high - radii_read(before, pixel)) + (low - radii_read(before + 1u, pixel));
    radii_write(before, pixel, high);
    radii_write(before + 1u, pixel, low);
    return sum;
}

void main() {
    uint pixel = thread();
    if (pixel >= push.pixels) return;
    float mean = added(ERROR_BIAS, BEFORE_BIAS, pixel) / push.since;
    float square = added(ERROR_BIAS_SQUARE, BEFORE_BIAS_SQUARE, pixel) / push.since;
    radii_write(BIAS_SQUARED, pixel, mean * mean);
    precise float spread = square - mean * mean;
    radii_write(BIAS_VARIANCE, pixel, max(spread, 0.0) / (push.since - 1.0));
}

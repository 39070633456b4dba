// The factors on radii, from the changes around each pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
layout(local_size_x_id = 1) in;

#include "film/bandwidth.glsl"

void main() {
    uint pixel = thread();
    if (pixel >= push.pixels) return;
    int width = int(push.width);
    int height = int(push.pixels / push.width);
    int x = int(pixel) % width, y = int(pixel) / width;
    // Geometric mean over neighbours, so that the factors do not become visible in the picture.
    float sum = 0.0, count = 0.0;
    for (int row = max(y - 1, 0); row <= min(y + 1, height - 1); row++) {
        for (int column = max(x - 1, 0); column <= min(x + 1, width - 1); column++) {
            sum += radii_read(CHANGE, uint(row * width + column));
            count += 1.0;
        }
    }
    Factors factor = push.factors + pixel;
    factor.at = clamp(factor.at * exp(0.5 * sum / count), RADII_LEAST, RADII_GREATEST);
}

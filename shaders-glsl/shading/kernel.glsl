// Twin of photon-core's kernel.rs: the weight of a photon by its distance.
#ifndef KERNEL_GLSL
#define KERNEL_GLSL

#include "shading/constants.glsl"

// The weight at `u`, squared distance over squared radius. `slope` is that of the cone kernel.
float kernel_weight(uint kernel, float slope, float u) {
    switch (kernel) {
        case KERNEL_EPANECHNIKOV: {
            precise float weight = 2.0 * (1.0 - u);
            return weight;
        }
        case KERNEL_CONE: {
            precise float weight = (1.0 - sqrt(u) / slope) * (slope / (slope - 0.6666667));
            return weight;
        }
        case KERNEL_BIWEIGHT: {
            precise float weight = 3.0 * (1.0 - u) * (1.0 - u);
            return weight;
        }
        default: return 1.0;
    }
}

#endif

// Twin of photon-core's kernel.rs: the weight of a photon by its distance.
#ifndef KERNEL_GLSL
#define KERNEL_GLSL

#include "shading/constants.glsl"

// The weight at `u`, squared distance over squared radius.
float kernel_weight(uint kernel, float u) {
    if (kernel == KERNEL_CONSTANT) return 1.0;
    precise float weight = 2.0 * (1.0 - u);
    return weight;
}

#endif

// Twin of photon-core's bias.rs: the bias of an estimate, as estimated from two other radii.
#ifndef BIAS_GLSL
#define BIAS_GLSL

struct Biases {
    // The estimate over twice the area minus this one.
    vec3 wide;
    // This estimate minus the one over half the area.
    vec3 narrow;
};

// In units of `flux`, that of the estimate; `wide` and `narrow` are those of its error moments.
Biases biases(vec3 flux, vec3 wide, vec3 narrow) {
    return Biases(0.5 * wide - flux, flux - 2.0 * narrow);
}

#endif

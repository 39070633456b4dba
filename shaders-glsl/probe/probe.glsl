// Common part of probes: reads a table of inputs, calls `probe`, writes a table of outputs.
#ifndef PROBE_GLSL
#define PROBE_GLSL

#include "device/grid.glsl"

// Index of the function to evaluate: see the table in the backend's probe tests.
layout(constant_id = 2) const uint FUNCTION = 0u;

struct Input {
    uvec4 a;
    uvec4 b;
    uvec4 c;
};

struct Output {
    uvec4 a;
    uvec4 b;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Inputs { Input at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Outputs { Output at; };

layout(push_constant, scalar) uniform Push {
    Inputs inputs;
    Outputs outputs;
    uint count;
} push;

Output probe(vec4 a, vec4 b, vec4 c, Input words);

Output floats(vec4 a, vec4 b) {
    return Output(floatBitsToUint(a), floatBitsToUint(b));
}

void main() {
    uint i = thread();
    if (i >= push.count) return;
    Input words = push.inputs[i].at;
    push.outputs[i].at =
        probe(uintBitsToFloat(words.a), uintBitsToFloat(words.b), uintBitsToFloat(words.c), words);
}

#endif

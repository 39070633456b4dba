// Sums path statistics in integers, so that the result does not depend on the order.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

layout(local_size_x_id = 1) in;
layout(constant_id = 3) const uint WANTED = 7;

#include "shading/constants.glsl"
#include "device/grid.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "stages/tally.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Counts { uint at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Sums { uint at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    PhotonRays rays;
    Endings endings;
    Counts stored;
    Sums sums;
    uint first;
    uint count;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Two words each: paths by fate, surfaces, photons by map, paths nested in too many solids. Then three words
// for each channel of the emitted flux, and of the flux by fate.
const uint COUNTERS = FATE_COUNT + 2u + MAP_COUNT;
const uint FLUXES = 3u + 3u * FATE_COUNT;
const uint WORDS = 2u * COUNTERS + 3u * FLUXES;

shared uint total[WORDS];

// Fixed point in units of 2^-40, rounded towards zero; saturates; NaN becomes 0.
int64_t fixed_flux(float flux) {
    if (is_nan(flux)) return 0l;
    float scaled = flux * FATE_FLUX_ONE;
    if (scaled >= 9223372036854775808.0) return 0x7FFFFFFFFFFFFFFFl;
    if (scaled < -9223372036854775808.0) return -0x7FFFFFFFFFFFFFFFl - 1l;
    return int64_t(scaled);
}

void add2(uint at, uint value) {
    uint before = atomicAdd(total[at], value);
    if (before + value < before) atomicAdd(total[at + 1u], 1u);
}

// `high` · 2^32 + `low`, modulo 2^96.
void add3(uint at, uint64_t low, int64_t high) {
    high += int64_t(low >> 32);
    uint words[3] = uint[](uint(low), uint(uint64_t(high)), uint(uint64_t(high) >> 32));
    [[unroll]] for (uint i = 0u; i < 3u; ++i) {
        uint before = atomicAdd(total[at + i], words[i]);
        if (before + words[i] < before) {
            if (i == 0u) {
                uint middle = atomicAdd(total[at + 1u], 1u);
                if (middle == 0xFFFFFFFFu) atomicAdd(total[at + 2u], 1u);
            } else if (i == 1u) {
                atomicAdd(total[at + 2u], 1u);
            }
        }
    }
}

void main() {
    uint size = gl_WorkGroupSize.x;
    for (uint i = gl_LocalInvocationID.x; i < WORDS; i += size) total[i] = 0u;
    barrier();
    uint counters[COUNTERS];
    uint64_t low[FLUXES];
    int64_t high[FLUXES];
    [[unroll]] for (uint i = 0u; i < COUNTERS; ++i) counters[i] = 0u;
    [[unroll]] for (uint i = 0u; i < FLUXES; ++i) {
        low[i] = 0ul;
        high[i] = 0l;
    }
    uint threads = gl_NumWorkGroups.x * gl_NumWorkGroups.y * size;
    for (uint index = thread(); index < push.count; index += threads) {
        Ending ending = push.endings[index].at;
        vec3 power = push.rays[push.first + index].at.power;
        uint fate = ending.fate_surfaces >> 28;
        [[unroll]] for (uint c = 0u; c < 3u; ++c) {
            int64_t emitted = fixed_flux(power[c]);
            int64_t left = fixed_flux(ending.power[c]);
            low[c] += uint64_t(uint(uint64_t(emitted)));
            high[c] += emitted >> 32;
            [[unroll]] for (uint f = 0u; f < FATE_COUNT; ++f) {
                // The power that a path lost before its end was absorbed on the way.
                int64_t part = (fate == f ? left : 0l) + (f == FATE_ABSORBED ? emitted - left : 0l);
                low[3u + 3u * f + c] += uint64_t(uint(uint64_t(part)));
                high[3u + 3u * f + c] += part >> 32;
            }
        }
        [[unroll]] for (uint f = 0u; f < FATE_COUNT; ++f) counters[f] += fate == f ? 1u : 0u;
        counters[FATE_COUNT] += ending.fate_surfaces & SURFACES_MASK;
        counters[FATE_COUNT + 1u + MAP_COUNT] += (ending.fate_surfaces & TOO_DEEP) != 0u ? 1u : 0u;
        [[unroll]] for (uint map = 0u; map < MAP_COUNT; ++map) {
            if ((WANTED >> map & 1u) != 0u) counters[FATE_COUNT + 1u + map] += push.stored[map * push.count + index].at;
        }
    }
    [[unroll]] for (uint i = 0u; i < COUNTERS; ++i) add2(2u * i, counters[i]);
    [[unroll]] for (uint i = 0u; i < FLUXES; ++i) add3(2u * COUNTERS + 3u * i, low[i], high[i]);
    barrier();
    // The rest adds word by word to the totals shared by all workgroups.
    if (gl_LocalInvocationID.x < COUNTERS + FLUXES) {
        uint i = gl_LocalInvocationID.x;
        uint length = i < COUNTERS ? 2u : 3u;
        uint at = i < COUNTERS ? 2u * i : 2u * COUNTERS + 3u * (i - COUNTERS);
        for (uint w = 0u; w < length; ++w) {
            uint value = total[at + w];
            // The carry may propagate further.
            for (uint up = w; up < length && value != 0u; ++up) {
                uint before = atomicAdd(push.sums[at + up].at, value);
                value = before + value < before ? 1u : 0u;
            }
        }
    }
}

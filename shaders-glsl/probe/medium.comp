// Evaluates the functions of phase.glsl, flight.glsl and equiangular.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

// All phase functions.
const uint MEDIA = 16u;

#include "probe/probe.glsl"
#include "shading/equiangular.glsl"
#include "shading/flight.glsl"
#include "shading/phase.glsl"

// A phase function of this kind.
Phase phase_from(vec4 a, float kind) { return Phase(uint(kind), a.x, a.y, a.z, a.w); }

// Scattering, absorption, power; length of the stretch, and two random numbers.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    Medium medium;
    medium.scattering = a.xyz;
    medium.absorption = b.xyz;
    float end = a.w, u = b.w, v = c.w;
    switch (FUNCTION) {
        // A phase function; two directions, or one and two random numbers.
        case 0u: return floats(vec4(phase_value(phase_from(a, b.w), b.xyz, c.xyz), 0.0, 0.0, 0.0), vec4(0.0));
        case 1u: return floats(vec4(phase_sample(phase_from(a, c.x), b.xyz, u, v), 0.0), vec4(0.0));
        case 2u: {
            Flight flight = flight_sample(medium, c.xyz, end, u, v);
            float far = flight.collides ? flight.distance : -1.0;
            return floats(vec4(flight.power, far), vec4(flight.albedo, 0.0, 0.0, 0.0));
        }
        case 3u: {
            vec3 left;
            float far = flight_deposit(medium, c.xyz, end, 8u, u, v, left);
            return floats(vec4(left, far), vec4(0.0));
        }
        // Origin and direction of the segment, a point.
        case 4u: {
            Equiangular angles = equiangular_new(a.xyz, b.xyz, end, c.xyz);
            float far = equiangular_sample(angles, u);
            return floats(vec4(far, 0.0, 0.0, 0.0), vec4(0.0));
        }
        case 5u: {
            Equiangular angles = equiangular_new(a.xyz, b.xyz, end, c.xyz);
            return floats(vec4(equiangular_density(angles, u * end), 0.0, 0.0, 0.0), vec4(0.0));
        }
        // The power now and at the start, a position.
        case 7u: {
            vec3 left;
            bool goes_on = flight_thinned(a.xyz, b.xyz, c.xyz, u, left);
            return floats(goes_on ? vec4(left, 1.0) : vec4(0.0), vec4(0.0));
        }
        default:
            return floats(
                vec4(exponential_sample(a.x, end, u), exponential_density(a.x, end, v * end), 0.0, 0.0), vec4(0.0));
    }
}

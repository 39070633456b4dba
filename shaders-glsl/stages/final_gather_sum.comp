// Sums the estimates of the gather rays of each query for one photon map. One invocation per query.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

// Whether the error moments of the estimates are summed as well.
layout(constant_id = 2) const uint ERROR_MOMENTS = 0;
// Whether the estimates are irradiance rather than flux within a disc. Rays that have any are moved to where no map has photons.
layout(constant_id = 3) const uint IRRADIANCE = 0;

#include "device/grid.glsl"
#include "shading/bias.glsl"
#include "shading/layout.glsl"
#include "shading/two_float.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Values { vec3 at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Queries landings;
    Estimates estimates;
    Values values;
    ErrorMomentsBuffer error_moments;
    // For each query: irradiance from twice the area minus that of the image, the latter minus that from half
    // the area, and powers; stored in `wide`, `narrow` and the powers.
    ErrorMomentsBuffer errors;
    uint count_rays;
    uint start_query;
    uint count_queries;
    // 1 / (π times the number of paths times the number of rays of a query).
    float scale;
    // 1 / number of rays.
    float share;
    uint padding;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// As in final_gather.comp.
const float NOWHERE = 1.0e6;

void main() {
    uint local = thread();
    if (local >= push.count_queries) return;
    Values value = push.values + (push.start_query + local);
    vec3 sum = value.at;
    vec3 low = vec3(0.0);
    vec3 bias = vec3(0.0), narrow = vec3(0.0);
    float power = 0.0, squared = 0.0;
    for (uint ray = 0; ray < push.count_rays; ray++) {
        uint i = local * push.count_rays + ray;
        bool with_errors = ERROR_MOMENTS != 0 && push.error_moments[i].at.photons != 0;
        if (push.estimates[i].at.photons == 0 && !with_errors) continue;
        float density = IRRADIANCE != 0 ? push.share : push.scale / push.estimates[i].at.radius_squared;
        vec3 flux = push.estimates[i].at.flux;
        vec3 throughput = push.landings[i].at.throughput;
        two_add(sum, low, throughput * (flux * density));
        if (IRRADIANCE != 0) push.landings[i].at.position = vec3(NOWHERE);
        if (with_errors) {
            Biases found = biases(flux, push.error_moments[i].at.wide, push.error_moments[i].at.narrow);
            bias += throughput * (density * found.wide);
            narrow += throughput * (density * found.narrow);
            float mean = push.share * (throughput.x + throughput.y + throughput.z) * (1.0 / 3.0);
            power += mean * push.error_moments[i].at.power;
            squared += mean * mean * push.error_moments[i].at.power_squared;
        }
    }
    value.at = sum;
    if (ERROR_MOMENTS == 0) return;
    ErrorMomentsBuffer all = push.errors + (push.start_query + local);
    all.at.wide += bias;
    all.at.narrow += narrow;
    all.at.power += power;
    all.at.power_squared += squared;
    if (power > 0.0) all.at.photons = 1;
}

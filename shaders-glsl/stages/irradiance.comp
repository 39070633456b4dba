// Adds one map's estimates to the irradiance at points, which are photons whose power is the irradiance. Twin
// of backend-cpu's irradiance.rs.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "shading/layout.glsl"
#include "shading/octahedral.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Queries queries;
    Estimates estimates;
    Photons points;
    uint count;
    // Whether this is the first map, so that the points are not yet initialized.
    uint first;
    // 1 / (π times the number of paths).
    float scale;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    uint i = thread();
    if (i >= push.count) return;
    if (push.first != 0) {
        uint normal = octahedral_pack(push.queries[i].at.normal);
        push.points[i].at = Photon(push.queries[i].at.position, normal, vec3(0.0), normal);
    }
    if (push.estimates[i].at.photons == 0) return;
    push.points[i].at.power += push.estimates[i].at.flux * (push.scale / push.estimates[i].at.radius_squared);
}

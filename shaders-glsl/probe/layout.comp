// Copies an array of records of one type by assignment, with the offsets and stride of the type.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

#include "device/grid.glsl"
#include "shading/layout.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 2) const uint RECORD = 0u;

layout(push_constant, scalar) uniform Push {
    uint64_t from;
    uint64_t to;
    uint count;
} push;

#define COPY(TABLE) TABLE(push.to)[i].at = TABLE(push.from)[i].at

void main() {
    uint i = thread();
    if (i >= push.count) return;
    switch (RECORD) {
        case 0u: COPY(Photons); break;
        case 1u: COPY(PhotonRays); break;
        case 2u: COPY(Queries); break;
        case 3u: COPY(Estimates); break;
        case 4u: COPY(ErrorMomentsBuffer); break;
        case 5u: COPY(Primitives); break;
        case 6u: COPY(Materials); break;
        case 7u: COPY(Media); break;
        case 8u: COPY(Grids); break;
        case 9u: COPY(Lights); break;
        case 10u: COPY(Cameras); break;
        case 11u: COPY(TextureUses); break;
        case 12u: COPY(MaterialTextureTable); break;
        case 13u: COPY(AnisotropyTable); break;
        case 14u: COPY(TransmissionTable); break;
        case 15u: COPY(SheenLayerTable); break;
        case 16u: COPY(ClearcoatNormalTable); break;
        case 17u: COPY(PartialTransmissionTable); break;
        default: COPY(LightNodes); break;
    }
}

// A host's own kernel (see the program `host_device`): photons distributed uniformly over a square and a grid
// of queries on it, in the record formats of photon_core, written to the host's buffers.
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 128) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) writeonly buffer Photons {
    vec3 position;
    uint normal;
    vec3 power;
    uint direction;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) writeonly buffer Queries {
    vec3 position;
    float radius;
    vec3 normal;
    uint pixel;
    vec3 throughput;
    uint material;
    uint wo;
    uint path;
    uint reserved[2];
};

layout(push_constant, scalar) uniform Push {
    Photons photons;
    Queries queries;
    uint photon_count;
    uint query_side;
    float power;
    float side;
    float radius;
} push;

// The packed up direction: the centre of the unfolded octahedron.
const uint UP = 0u;

// A permutation of 32 bits with good avalanche (O'Neill 2014, PCG-RXS-M-XS).
uint scramble(uint x) {
    x = x * 747796405u + 2891336453u;
    x = ((x >> ((x >> 28) + 4u)) ^ x) * 277803737u;
    return (x >> 22) ^ x;
}

float unit(uint word) {
    return float(word >> 8) * (1.0 / 16777216.0);
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < push.photon_count) {
        uint first = scramble(i);
        vec2 at = (vec2(unit(first), unit(scramble(first ^ 0x9E3779B9u))) - 0.5) * push.side;
        Photons photon = push.photons[i];
        photon.position = vec3(at, 0.0);
        photon.normal = UP;
        photon.power = vec3(push.power);
        photon.direction = UP;
    }
    if (i < push.query_side * push.query_side) {
        // The queries keep a distance of one radius from the border, so that no disc extends beyond the edge.
        vec2 cell = (vec2(i % push.query_side, i / push.query_side) + 0.5) / float(push.query_side) - 0.5;
        Queries query = push.queries[i];
        query.position = vec3(cell * (push.side - 2.0 * push.radius), 0.0);
        query.radius = push.radius;
        query.normal = vec3(0.0, 0.0, 1.0);
        query.pixel = i;
        query.throughput = vec3(1.0);
        query.material = 0u;
        query.wo = UP;
        query.path = i;
        query.reserved[0] = 0u;
        query.reserved[1] = 0u;
    }
}

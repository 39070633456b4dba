// Twin of backend-cpu's scene.rs: the tables of a scene, and what shading needs of a hit.
//
// A kernel gets one address, that of a SceneRef; all else is found from there. Triangles are numbered
// as the tree orders them, in Light::primitive too; Hit::primitive is the index that the user gave.
#ifndef SCENE_GLSL
#define SCENE_GLSL

#include "constants.glsl"
#include "layout.glsl"
#include "math.glsl"
#include "offset.glsl"

// Index of the material that a path is inside of, when it is in none.
const uint VACUUM = 0xFFFFFFFFu;

struct Ray {
    vec3 origin;
    // Unit vector.
    vec3 direction;
    // Hits farther than this do not count.
    float t_max;
};

// A ray's limit when it has none.
const float RAY_ENDLESS = 3.4028235e38;

// Eight children, their boxes in steps of a power of two from a corner; see intersect.glsl.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer WideNodes {
    uvec4 words[5];
};

// Three vertices; in the last word of the first, the index of the triangle that the user gave.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Corners {
    vec4 a;
    vec4 b;
    vec4 c;
};

// How a light is picked: where its share of the range of a random word begins, how large that share
// is, and its power over that.
struct LightShare {
    vec3 carried;
    float probability;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer LightShares { LightShare at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightStarts { uint at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer SceneRef {
    WideNodes nodes;
    Corners corners;
    Facets facets;
    Materials materials;
    Lights lights;
    LightStarts light_starts;
    LightShares light_shares;
    uint triangles;
    uint light_count;
    uint material_count;
    uint reserved;
};

#include "intersect.glsl"

// Where a ray meets the scene.
struct Surface {
    float t;
    vec3 point;
    // On the side that the ray came from.
    vec3 normal;
    // Between that normal and the way back, at least 0.
    float cosine;
    // Whether that is the front.
    bool front;
    uint material;
};

Material scene_material(SceneRef scene, uint index) {
    return scene.materials[index].at;
}

Light scene_light(SceneRef scene, uint index) {
    return scene.lights[index].at;
}

// Of a triangle by its number in the tree.
Facet scene_facet(SceneRef scene, uint triangle) {
    return scene.facets[triangle].at;
}

// Likewise.
void scene_vertices(SceneRef scene, uint triangle, out vec3 a, out vec3 b, out vec3 c) {
    Corners corners = scene.corners[triangle];
    a = corners.a.xyz;
    b = corners.b.xyz;
    c = corners.c.xyz;
}

// The light whose share of the range of a random word holds `random`.
uint scene_pick_light(SceneRef scene, uint random) {
    uint low = 0u;
    uint high = scene.light_count;
    // The first start is 0, so that `low` is right all along.
    while (high - low > 1u) {
        uint middle = low + (high - low) / 2u;
        if (scene.light_starts[middle].at <= random) low = middle;
        else high = middle;
    }
    return low;
}

// The probability of that.
float scene_light_probability(SceneRef scene, uint index) {
    return scene.light_shares[index].at.probability;
}

// The nearest surface, with all that shading needs.
bool surface_at(SceneRef scene, Ray ray, out Surface found) {
    Hit hit;
    if (!nearest(scene, ray, hit)) return false;
    Facet facet = scene_facet(scene, hit.triangle);
    vec3 a, b, c;
    scene_vertices(scene, hit.triangle, a, b, c);
    float cosine = -dot3(ray.direction, facet.normal);
    bool front = cosine > 0.0;
    found.t = hit.t;
    found.point = barycentric(a, b, c, hit.u, hit.v);
    found.normal = front ? facet.normal : -facet.normal;
    found.cosine = abs(cosine);
    found.front = front;
    found.material = facet.material;
    return true;
}

// A ray that goes on from here on the side that it came from.
Ray surface_leave(Surface from, vec3 direction) {
    return Ray(off_surface(from.point, from.normal), direction, RAY_ENDLESS);
}

// A ray that goes on beyond.
Ray surface_pass(Surface from, vec3 direction) {
    return Ray(off_surface(from.point, -from.normal), direction, RAY_ENDLESS);
}

// Share of each channel that is left after the stretch that ended on a surface: Beer and Lambert's
// law inside solids. A back side of glass says itself that the stretch was inside; for other surfaces
// it is what the path last entered.
vec3 transmittance(SceneRef scene, Surface end, uint medium) {
    bool behind = !end.front && scene.materials[end.material].at.kind == MATERIAL_DIELECTRIC;
    uint inside = behind ? end.material : medium;
    if (inside >= scene.material_count) return vec3(1.0);
    precise vec3 depth = scene.materials[inside].at.absorption * end.t;
    return vec3(exp_neg(depth.x), exp_neg(depth.y), exp_neg(depth.z));
}

#endif

// Twin of backend-cpu's scene.rs: the tables of a scene, and the surface data for shading a hit.
//
// A kernel gets one address, that of a SceneRef; all tables are found through it. Corners and triangle records
// are in BVH order (Hit::slot); Hit::primitive is the index that the user supplied.
#ifndef SCENE_GLSL
#define SCENE_GLSL

#include "shading/constants.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/offset.glsl"
#include "shading/texture.glsl"

struct Ray {
    vec3 origin;
    vec3 direction;
    // Maximum distance of hits.
    float t_max;
};

const float NO_LIMIT = 3.4028235e38;

// Whether some of the scattering is diffuse. Textures may make a glossy surface less metallic than its factor says.
bool material_is_diffuse(Material material) {
    return material.kind == MATERIAL_LAMBERT
        || (material.kind == MATERIAL_GLOSSY && (material.metallic < 1.0 || material.textures != 0u));
}

// Whether photons are stored on a material; before textures are evaluated.
bool material_stores_photons(Material material) {
    uint flag = (FEATURES & FEATURE_DIFFUSE_TRANSMISSION) != 0u ? MATERIAL_DIFFUSE_TRANSMISSION : 0u;
    bool transmits = (material.flags & flag) != 0u;
    return material_is_diffuse(material) && (material.albedo != vec3(0.0) || transmits);
}

// Eight children, with boxes quantized in steps of a power of two from a corner; see intersect.glsl.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer WideNodes {
    uvec4 words[5];
};

// A triangle, in BVH order: three vertices; `w` of the first is its index, of the second its margin, of the third whether
// its material has alpha.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Corners {
    vec4 a;
    vec4 b;
    vec4 c;
};

// Data beyond a light's record: the power of its photons, the probability of its selection, and the corners of its triangle
// with its normal and margin. Of a point or spot light outside of the scene, `normal` and `margin` are the axis and the versine
// of the cone around the scene.
struct Emission {
    vec3 carried;
    float probability;
    vec3 a;
    vec3 b;
    vec3 c;
    vec3 normal;
    float margin;
    // Media that paths start in, on the front and on the back side.
    uvec2 media;
    // Position of the triangle in BVH order.
    uint slot;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Emissions { Emission at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightStarts { uint at; };

// Words of a triangle's three vertices: packed normals or tangents.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CornerWords { uint a; uint b; uint c; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CornerColors { uvec2 a; uvec2 b; uvec2 c; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Uvs { vec2 a; vec2 b; vec2 c; };

// Directional albedos of glossy surfaces.
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Vec2s { vec2 at; };

// Vertex attributes and textures; those of triangles are in BVH order.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ShadingRef {
    CornerWords normals;
    CornerWords tangents;
    CornerColors colors;
    Uvs uvs;
    MaterialTextureTable material_textures;
    TextureUses uses;
    Textures textures;
    ByteValues values;
    Vec2s albedos;
    uint has_normals;
    // Number of ratios of refractive indices at rough glass.
    uint rough_ratios;
    AnisotropyTable anisotropies;
    TransmissionTable diffuse_transmissions;
    ClearcoatNormalTable clearcoat_normals;
    SheenLayerTable sheens;
    PartialTransmissionTable partial_transmissions;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Vec4s { vec4 at; };

// An environment map: texels, rows of cells, starts of the rows and of the columns of each row.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer EnvironmentRef {
    Vec4s texels;
    Vec4s rows;
    LightStarts starts;
    uint width;
    uint height;
    uint rows_count;
    uint columns;
    uint step_texels;
    float rotation;
};

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer LightTrails { uvec2 at; };

// A tree over many lights: its nodes, LIGHT_TREE_WIDTH children of one node after the other, and the path from the root to the
// leaf of each light. A node's `next` counts such groups of children.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer LightTreeRef {
    LightNodes nodes;
    LightTrails trails;
};

// A cell of the spectrum: SpectrumCell of photon-core.
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer SpectrumCells {
    vec3 share;
    vec3 cumulative;
};

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer GridBricks { uint at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer GridDensities { float at; };

// GridTables of photon-core.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer GridTables {
    Grids grids;
    GridBricks bricks;
    GridDensities densities;
};

// Boundaries of media that light passes, with a tree of their own. In the second vertex of a triangle, `w` is the index of the
// medium behind it; positions are in units of `scale`.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer BoundariesRef {
    WideNodes nodes;
    Corners corners;
    float scale;
};

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer SceneRef {
    WideNodes nodes;
    Corners corners;
    Primitives primitives;
    Materials materials;
    Lights lights;
    LightStarts light_cdf;
    Emissions emissions;
    Media media;
    uint triangles;
    uint light_count;
    // 0 in a scene without any.
    ShadingRef shading;
    // 0 in a scene without one.
    EnvironmentRef environment;
    // 0 in a scene of few lights.
    LightTreeRef light_tree;
    // 0 in a scene whose media do not disperse light.
    SpectrumCells spectrum;
    // 0 in a scene of homogeneous media.
    GridTables grids;
    // 0 in a scene without any.
    BoundariesRef boundaries;
};

#include "shading/alpha.glsl"
#include "shading/partial_transmission.glsl"
#include "shading/intersect.glsl"

// A surface point hit by a ray.
struct Surface {
    float t;
    vec3 point;
    // Origin for continuing rays, except for the offset from the surface.
    vec3 start;
    // Facing the side that the ray came from.
    vec3 normal;
    // Cosine between that normal and the reversed ray direction, at least 0.
    float cosine;
    // Whether that side is the front.
    bool front;
    uint material;
};

// All data that shading needs of a hit of a ray in this direction, but that the material is that of the primitive.
Surface surface_of(SceneRef scene, vec3 direction, Hit hit) {
    Primitive primitive = scene.primitives[hit.slot].at;
    // Whole vectors are read: llvmpipe of Mesa 22.3 returns the third component of a vector for the fourth if
    // the fourth alone is read in addition to the first three.
    Corners corners = scene.corners[hit.slot];
    vec4 a = corners.a;
    vec4 b = corners.b;
    vec4 c = corners.c;
    float cosine = -dot3(direction, primitive.normal);
    bool front = cosine > 0.0;
    Surface found;
    found.t = hit.t;
    found.point = barycentric(a.xyz, b.xyz, c.xyz, hit.u, hit.v);
    found.start = within(a.xyz, b.xyz, c.xyz, b.w, hit.u, hit.v);
    found.normal = front ? primitive.normal : -primitive.normal;
    found.cosine = abs(cosine);
    found.front = front;
    found.material = primitive.material;
    return found;
}

// The same, with the material that the ray meets; `word` is its random word.
Surface surface_met(SceneRef scene, vec3 direction, Hit hit, uint word) {
    Surface found = surface_of(scene, direction, hit);
    if (PARTIAL_TRANSMISSION) {
        found.material = partial_material(scene, found.material, hit.slot, hit.u, hit.v, word);
    }
    return found;
}

// The nearest surface along a ray; `word` as for `nearest`.
bool surface(SceneRef scene, Ray ray, uint word, out Surface found) {
    Hit hit;
    if (!nearest(scene, ray, word, hit)) return false;
    found = surface_met(scene, ray.direction, hit, word);
    return true;
}

// A ray that continues on the side that the incoming ray came from.
Ray surface_leave(Surface at, vec3 direction) {
    return Ray(off_surface(at.start, at.normal), direction, NO_LIMIT);
}

// A ray that continues on the other side.
Ray surface_pass(Surface at, vec3 direction) {
    return Ray(off_surface(at.start, -at.normal), direction, NO_LIMIT);
}

// The light whose interval of the range of random words contains `random`.
uint pick_light(SceneRef scene, uint random) {
    uint low = 0u;
    uint high = scene.light_count;
    // The first interval starts at 0, so that the invariant for `low` always holds.
    while (high - low > 1u) {
        uint middle = low + (high - low) / 2u;
        if (scene.light_cdf[middle].at <= random) low = middle;
        else high = middle;
    }
    return low;
}

#endif

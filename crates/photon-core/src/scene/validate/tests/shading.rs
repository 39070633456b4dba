//! Invalid vertex attributes and textures.

use super::Tables;
use crate::scene::SceneView;
use crate::scene::material::Material;
use crate::scene::texture::{
    Anisotropy, ClearcoatNormal, DiffuseTransmission, Filter, MaterialTextures, PartialTransmission, ShadingTables,
    SheenLayer, TexelFormat, Texture, TextureUse, Wrap,
};

/// Vertex attributes of two triangles, and a texture that the first material uses.
struct Shading {
    tables: Tables,
    normals: Vec<[u32; 3]>,
    tangents: Vec<[u32; 3]>,
    uvs: Vec<[[f32; 2]; 3]>,
    material_textures: Vec<MaterialTextures>,
    anisotropies: Vec<Anisotropy>,
    diffuse_transmissions: Vec<DiffuseTransmission>,
    clearcoat_normals: Vec<ClearcoatNormal>,
    sheens: Vec<SheenLayer>,
    partial_transmissions: Vec<PartialTransmission>,
    uses: Vec<TextureUse>,
    textures: Vec<Texture>,
}

impl Shading {
    fn new() -> Self {
        let mut tables = Tables::new();
        tables.materials[0].textures = 1;
        let texture = Texture {
            texels: vec![0; 6].into(),
            width: 3,
            height: 2,
            format: TexelFormat::Srgb8,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
        };
        Self {
            tables,
            normals: vec![[ShadingTables::FLAT; 3]; 2],
            tangents: vec![[0; 3]; 2],
            uvs: vec![[[0.0; 2]; 3]; 4],
            material_textures: vec![MaterialTextures {
                base_color: 0,
                normal: 0,
                anisotropy: 0,
                ..MaterialTextures::default()
            }],
            anisotropies: vec![Anisotropy { strength: 1.0, direction: [0.6, -0.8], texture: 0 }],
            diffuse_transmissions: vec![DiffuseTransmission { color_texture: 0, ..DiffuseTransmission::NONE }],
            clearcoat_normals: vec![ClearcoatNormal { is_own: 1, texture: 0, ..ClearcoatNormal::NONE }],
            sheens: vec![SheenLayer { color_texture: 0, ..SheenLayer::NONE }],
            partial_transmissions: vec![PartialTransmission {
                factor_texture: 0,
                glass: 2,
                ..PartialTransmission::NONE
            }],
            uses: vec![TextureUse { uv_set: 1, ..TextureUse::new(0) }],
            textures: vec![texture],
        }
    }

    fn check(&self) -> Result<(), String> {
        let shading = ShadingTables {
            normals: &self.normals,
            tangents: &self.tangents,
            uvs: &self.uvs,
            material_textures: &self.material_textures,
            anisotropies: &self.anisotropies,
            diffuse_transmissions: &self.diffuse_transmissions,
            clearcoat_normals: &self.clearcoat_normals,
            sheens: &self.sheens,
            partial_transmissions: &self.partial_transmissions,
            uses: &self.uses,
            textures: &self.textures,
            ..ShadingTables::default()
        };
        let view = SceneView { shading, ..self.tables.view() };
        view.validate().map_err(|error| error.to_string())
    }
}

/// A modification, and how the resulting message begins.
type Case = (fn(&mut Shading), &'static str);

#[test]
fn invalid_attributes_and_textures_are_named() {
    Shading::new().check().unwrap();
    let cases: [Case; 42] = [
        (|s| s.normals.truncate(1), "scene view: shading.normals is 1 entries for 2 triangles"),
        (|s| s.tangents.truncate(1), "scene view: shading.tangents is 1"),
        (|s| s.tangents.clear(), "material_textures entry 0: it has a normal map, but the scene has no tangents"),
        (|s| s.uvs.truncate(3), "scene view: shading.uvs is 3"),
        (|s| s.uvs.truncate(2), "texture use 0: UV set 1 is out of range, 1 exist"),
        (|s| s.uvs[3][2][1] = f32::NAN, "texture coordinate 3: "),
        (|s| s.tables.materials[2].textures = 2, "material 2: its textures 2 are out of range"),
        (|s| s.material_textures[0].emission = 1, "material_textures entry 0: its emission texture 1 is out of range"),
        (|s| s.material_textures[0].normal_scale = f32::NAN, "material_textures entry 0: its normal_scale NaN"),
        (|s| s.anisotropies.clear(), "material_textures entry 0: its anisotropy 0 is out of range"),
        (|s| s.anisotropies[0].strength = 1.1, "anisotropy 0: its strength 1.1"),
        (|s| s.anisotropies[0].direction = [0.0; 2], "anisotropy 0: its direction [0, 0]"),
        (|s| s.anisotropies[0].texture = 1, "anisotropy 0: its texture 1 is out of range"),
        (
            |s| {
                s.material_textures[0].normal = MaterialTextures::NONE;
                s.tangents.clear();
            },
            "material_textures entry 0: it is anisotropic, but the scene has no tangents",
        ),
        (|s| s.clearcoat_normals.push(ClearcoatNormal::NONE), "scene view: shading.clearcoat_normals is 2"),
        (|s| s.clearcoat_normals[0].scale = f32::INFINITY, "clearcoat_normals entry 0: its scale inf"),
        (|s| s.clearcoat_normals[0].texture = 1, "clearcoat_normals entry 0: its texture 1 is out of range"),
        (
            |s| {
                (s.material_textures[0].normal, s.material_textures[0].anisotropy) = (u32::MAX, u32::MAX);
                s.tangents.clear();
            },
            "clearcoat_normals entry 0: it has a normal map, but the scene has no tangents",
        ),
        (|s| s.diffuse_transmissions.push(DiffuseTransmission::NONE), "scene view: shading.diffuse_transmissions is 2"),
        (|s| s.diffuse_transmissions[0].factor = f32::NAN, "diffuse_transmissions entry 0: its factor NaN"),
        (|s| s.diffuse_transmissions[0].color[1] = 1.5, "diffuse_transmissions entry 0: its color [1.0, 1.5, 1.0]"),
        (|s| s.diffuse_transmissions[0].factor_texture = 1, "diffuse_transmissions entry 0: its texture 1"),
        (|s| s.diffuse_transmissions[0].factor = 0.5, "material 0: it must be glossy and have"),
        (|s| s.tables.materials[0].flags = Material::DIFFUSE_TRANSMISSION, "material 0: it must be glossy and have"),
        (|s| s.sheens.push(SheenLayer::NONE), "scene view: shading.sheens is 2"),
        (|s| s.sheens[0].roughness = f32::NAN, "sheens entry 0: its roughness NaN"),
        (|s| s.sheens[0].color[1] = 1.5, "sheens entry 0: its color [0.0, 1.5, 0.0]"),
        (|s| s.sheens[0].roughness_texture = 1, "sheens entry 0: its texture 1"),
        (|s| s.partial_transmissions.push(PartialTransmission::NONE), "scene view: shading.partial_transmissions is 2"),
        (|s| s.partial_transmissions[0].factor = 1.5, "partial_transmissions entry 0: its factor 1.5"),
        (|s| s.partial_transmissions[0].factor_texture = 1, "partial_transmissions entry 0: its texture 1"),
        (|s| s.partial_transmissions[0].glass = 5, "partial_transmissions entry 0: material 5 is out of range"),
        (
            |s| {
                s.tables.materials[0].flags = Material::PARTIAL_TRANSMISSION;
                s.partial_transmissions[0].glass = 1;
            },
            "material 0: its glass, material 1, must be thin or dielectric",
        ),
        (
            |s| s.tables.materials[0].flags = Material::PARTIAL_TRANSMISSION | Material::ALPHA,
            "material 0: it has Material::ALPHA, but its glass is a solid",
        ),
        (
            |s| {
                s.tables.materials[0].flags = Material::PARTIAL_TRANSMISSION;
                s.tables.materials[0].emission = [1.0; 3];
            },
            "material 0: its glass, material 2, must emit the same light",
        ),
        (
            |s| s.tables.materials[1].flags = Material::PARTIAL_TRANSMISSION,
            "material 1: it has Material::PARTIAL_TRANSMISSION, but only",
        ),
        (|s| s.uses[0].texture_index = 1, "texture use 0: texture 1 is out of range"),
        (|s| s.uses[0].transform[1][2] = f32::INFINITY, "texture use 0: its transform"),
        (|s| s.textures[0].width = 0, "texture 0: its size 0 × 2"),
        (
            |s| {
                s.textures[0].format = TexelFormat::Float32;
                (s.textures[0].width, s.textures[0].height) = (65_536, 8193);
            },
            "texture 0: its 65536 × 8193 texels of floats take up more than 8 GiB",
        ),
        (|s| s.textures[0].height = 4, "texture 0: it has 6 words of texels; 3 × 4 need 12"),
        (
            |s| {
                s.textures[0].format = TexelFormat::Float32;
                s.textures[0].texels = vec![f32::NAN.to_bits(); 24].into();
            },
            "texture 0: a texel is negative or not a finite number",
        ),
    ];
    for (number, (spoil, expected)) in cases.into_iter().enumerate() {
        let mut shading = Shading::new();
        spoil(&mut shading);
        let found = shading.check().expect_err(expected);
        assert!(found.starts_with(expected), "case {number}: {found:?} instead of {expected:?}");
    }
}

//! Textures: images, and how materials refer to them.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};

/// How the words of a [`Texture`] encode its texels.
#[repr(u32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum TexelFormat {
    /// One word a texel: red in the lowest byte, then green, blue and alpha; each is its value over 255.
    #[default]
    Linear8 = 0,
    /// As `Linear8`, but red, green and blue are encoded as sRGB (IEC 61966-2-1); alpha is linear.
    Srgb8 = 1,
    /// Four words a texel: the bits of red, green, blue and alpha as `f32`, linear.
    Float32 = 2,
}

impl TexelFormat {
    /// All formats, ordered by number.
    pub const ALL: [Self; 3] = [Self::Linear8, Self::Srgb8, Self::Float32];

    /// Number of words for each texel.
    #[must_use]
    pub const fn words(self) -> usize {
        match self {
            Self::Linear8 | Self::Srgb8 => 1,
            Self::Float32 => 4,
        }
    }

    /// Whether the words of a texel are the bits of its channels as `f32`; else its word has a byte for each channel.
    #[must_use]
    pub const fn is_float(self) -> bool {
        match self {
            Self::Linear8 | Self::Srgb8 => false,
            Self::Float32 => true,
        }
    }
}

/// What lies beyond the edges of a texture, in one of its two directions.
#[repr(u32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat = 0,
    /// The texture mirrored, then the texture again.
    Mirror = 1,
    /// The texel at the edge.
    Clamp = 2,
}

impl Wrap {
    /// The least shift of a coordinate that changes no lookup; `None` if every shift does.
    #[must_use]
    pub const fn period(self) -> Option<f64> {
        match self {
            Self::Repeat => Some(1.0),
            Self::Mirror => Some(2.0),
            Self::Clamp => None,
        }
    }
}

/// Which texels a lookup reads.
#[repr(u32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Filter {
    /// The four nearest, with bilinear weights.
    #[default]
    Linear = 0,
    /// The nearest one.
    Nearest = 1,
}

/// An image. Cloning it does not copy the texels; several textures can share them.
// Exhaustive: written as a literal by callers that fill in a `SceneView`, who must state every field.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Row by row from the top left, [`TexelFormat::words`] words for each texel; of floats at most
    /// [`Self::MAX_FLOAT_WORDS`].
    pub texels: Arc<[u32]>,
    /// Texels in a row, in `[1, 65536]`.
    pub width: u32,
    /// Rows, in `[1, 65536]`.
    pub height: u32,
    /// Encoding of the texels.
    pub format: TexelFormat,
    /// Wrap modes along the rows and down the columns.
    pub wrap: [Wrap; 2],
    /// Filter.
    pub filter: Filter,
}

impl Texture {
    /// Most words of a texture of [`TexelFormat::Float32`], 8 GiB. One of bytes may have 65536 × 65536 texels, 16 GiB.
    pub const MAX_FLOAT_WORDS: u64 = 1 << 31;
}

/// A texture as a material uses it: the coordinates are those of a UV set, transformed.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TextureUse {
    /// Two rows of three: `u' = m[0] · (u, v, 1)`, `v' = m[1] · (u, v, 1)`. (0, 0) is the corner of the image's first
    /// texel, (1, 1) that of its last one, as in glTF.
    pub transform: [[f32; 3]; 2],
    /// Index of the texture.
    pub texture_index: u32,
    /// Index of the UV set.
    pub uv_set: u32,
}

impl TextureUse {
    /// A texture by the coordinates of UV set 0 as they are.
    #[must_use]
    pub const fn new(texture: u32) -> Self {
        Self { transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], texture_index: texture, uv_set: 0 }
    }
}

/// The textures of a material: indices into [`crate::ShadingTables::uses`], [`MaterialTextures::NONE`] without one; and
/// factors of which few materials have any.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct MaterialTextures {
    /// Multiplies [`crate::Material::albedo`]; its alpha is not read.
    pub base_color: u32,
    /// Multiplies [`crate::Material::emission`].
    pub emission: u32,
    /// Tangent-space normals: `2 rgb − 1`, with x and y times [`Self::normal_scale`].
    pub normal: u32,
    /// Factor on the x and y of the normal map, finite.
    pub normal_scale: f32,
    /// Green multiplies [`crate::Material::roughness`], blue [`crate::Material::metallic`].
    pub metallic_roughness: u32,
    /// Its alpha multiplies that of a material with [`crate::Material::ALPHA`]; in glTF, this is the base colour.
    pub alpha: u32,
    /// Its alpha multiplies [`crate::Material::specular`].
    pub specular: u32,
    /// Its colour multiplies [`Self::specular_color_factor`].
    pub specular_color: u32,
    /// Glossy: factor on the reflectance at normal incidence of the coat, linear RGB, finite, ≥ 0; the product is at most 1.
    pub specular_color_factor: [f32; 3],
    /// Weight of a clearcoat over the surface, in `[0, 1]`; 0 without one. Only of glossy materials.
    pub clearcoat_factor: f32,
    /// Its roughness, in `[0, 1]`.
    pub clearcoat_roughness_factor: f32,
    /// Its red multiplies [`Self::clearcoat_factor`].
    pub clearcoat: u32,
    /// Its green multiplies [`Self::clearcoat_roughness_factor`].
    pub clearcoat_roughness: u32,
    /// Index into [`ShadingTables::anisotropies`]; [`Self::NONE`] without one. Only of glossy materials.
    pub anisotropy: u32,
}

/// The anisotropy of a glossy material: [`crate::anisotropy`].
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Anisotropy {
    /// Strength, in `[0, 1]`.
    pub strength: f32,
    /// Direction in which the reflection is wider: cosine and sine of its angle from the vertex tangent towards the bitangent.
    pub direction: [f32; 2],
    /// `2 rg − 1` is the direction which [`Self::direction`] turns, as complex numbers multiply; blue multiplies
    /// [`Self::strength`]. Index into [`ShadingTables::uses`]; [`MaterialTextures::NONE`] stands for (1, ½, 1).
    pub texture: u32,
}

/// Diffuse transmission of a glossy material: Lambertian light to the other side of a sheet without thickness.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct DiffuseTransmission {
    /// Albedo of transmission where all of the base transmits, linear RGB, each channel in `[0, 1]`.
    pub color: [f32; 3],
    /// Share of the base that transmits instead of reflecting, in `[0, 1]`; 0 is a material without transmission.
    pub factor: f32,
    /// Its colour multiplies [`Self::color`]. Index into [`ShadingTables::uses`]; [`MaterialTextures::NONE`] without one.
    pub color_texture: u32,
    /// Its alpha multiplies [`Self::factor`]; likewise.
    pub factor_texture: u32,
    /// 0.
    pub reserved: [u32; 2],
}

impl DiffuseTransmission {
    /// No transmission.
    pub const NONE: Self = Self {
        color: [1.0; 3],
        factor: 0.0,
        color_texture: MaterialTextures::NONE,
        factor_texture: MaterialTextures::NONE,
        reserved: [0; 2],
    };
}

/// The share of a surface that is glass: [`crate::partial_transmission`].
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct PartialTransmission {
    /// Factor on the share of what is not metal, in `[0, 1]`.
    pub factor: f32,
    /// Its red multiplies [`Self::factor`]. Index into [`ShadingTables::uses`]; [`MaterialTextures::NONE`] without one.
    pub factor_texture: u32,
    /// Index of the material of the glass: [`crate::MaterialKind::Thin`] or [`crate::MaterialKind::Dielectric`].
    pub glass: u32,
    /// 0.
    pub reserved: u32,
}

impl PartialTransmission {
    /// No glass.
    pub const NONE: Self = Self { factor: 0.0, factor_texture: MaterialTextures::NONE, glass: 0, reserved: 0 };
}

/// Sheen of a glossy material: [`crate::sheen`].
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SheenLayer {
    /// Its colour, linear RGB, each channel in `[0, 1]`; 0 is a material without sheen.
    pub color: [f32; 3],
    /// Its roughness, in `[0, 1]`.
    pub roughness: f32,
    /// Its colour multiplies [`Self::color`]. Index into [`ShadingTables::uses`]; [`MaterialTextures::NONE`] without one.
    pub color_texture: u32,
    /// Its alpha multiplies [`Self::roughness`]; likewise.
    pub roughness_texture: u32,
    /// 0.
    pub reserved: [u32; 2],
}

impl SheenLayer {
    /// No sheen.
    pub const NONE: Self = Self {
        color: [0.0; 3],
        roughness: 0.0,
        color_texture: MaterialTextures::NONE,
        roughness_texture: MaterialTextures::NONE,
        reserved: [0; 2],
    };
}

/// The normal of a clearcoat, where it differs from that of the surface below.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ClearcoatNormal {
    /// 1: the clearcoat has the vertex normal, turned by a texture if there is one; 0: the normal of the surface below.
    pub is_own: u32,
    /// Tangent-space normals as [`MaterialTextures::normal`]. Index into [`ShadingTables::uses`];
    /// [`MaterialTextures::NONE`] without one.
    pub texture: u32,
    /// Factor on the x and y of the texture, finite.
    pub scale: f32,
    /// 0.
    pub reserved: u32,
}

impl ClearcoatNormal {
    /// The normal of the surface below.
    pub const NONE: Self = Self { is_own: 0, texture: MaterialTextures::NONE, scale: 1.0, reserved: 0 };
}

impl MaterialTextures {
    /// No texture.
    pub const NONE: u32 = u32::MAX;

    /// Whether the coat has a specular colour other than white.
    #[must_use]
    pub fn has_specular_color(&self) -> bool {
        self.specular_color != Self::NONE || self.specular_color_factor != [1.0; 3]
    }
}

impl Default for MaterialTextures {
    fn default() -> Self {
        Self {
            base_color: Self::NONE,
            emission: Self::NONE,
            normal: Self::NONE,
            normal_scale: 1.0,
            metallic_roughness: Self::NONE,
            alpha: Self::NONE,
            specular: Self::NONE,
            specular_color: Self::NONE,
            specular_color_factor: [1.0; 3],
            clearcoat_factor: 0.0,
            clearcoat_roughness_factor: 0.0,
            clearcoat: Self::NONE,
            clearcoat_roughness: Self::NONE,
            anisotropy: Self::NONE,
        }
    }
}

/// What shading reads beyond the geometry: vertex attributes of triangles, and textures. Borrowed; the default is
/// a scene without any of it. A table that no material needs is empty, and costs nothing.
// Exhaustive: written as a literal with `..ShadingTables::default()`.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShadingTables<'a> {
    /// Vertex normals of each triangle, on its front side, packed by [`crate::octahedral::pack`]; empty without smooth
    /// normals. [`Self::FLAT`] at the first vertex: the triangle has none, and its geometric normal is used.
    pub normals: &'a [[u32; 3]],
    /// Vertex tangents of each triangle, packed by [`crate::octahedral::pack`], with the sign of the bitangent
    /// `sign · normal × tangent` in the lowest bit: 1 is negative. Empty without normal maps and anisotropy.
    pub tangents: &'a [[u32; 3]],
    /// Vertex colours of each triangle: red and green, blue and alpha, each times 65535 in 16 bits, red and blue in the
    /// lower ones. Linear; they multiply the albedo, and alpha that of materials with [`crate::Material::ALPHA`]. Empty
    /// without colours.
    pub colors: &'a [[[u32; 2]; 3]],
    /// Texture coordinates of each triangle's vertices; UV set `s` of triangle `t` is at `s · triangles + t`.
    pub uvs: &'a [[[f32; 2]; 3]],
    /// Indexed by [`crate::Material::textures`] less 1.
    pub material_textures: &'a [MaterialTextures],
    /// Indexed by [`MaterialTextures::anisotropy`]. Needs tangents.
    pub anisotropies: &'a [Anisotropy],
    /// As [`Self::material_textures`]; empty if no material has diffuse transmission. A factor above 0 needs
    /// [`crate::Material::DIFFUSE_TRANSMISSION`].
    pub diffuse_transmissions: &'a [DiffuseTransmission],
    /// As [`Self::material_textures`]; empty if no clearcoat has a normal of its own. Textures need tangents.
    pub clearcoat_normals: &'a [ClearcoatNormal],
    /// As [`Self::material_textures`]; empty if no material has a sheen.
    pub sheens: &'a [SheenLayer],
    /// As [`Self::material_textures`]; empty if no material has [`crate::Material::PARTIAL_TRANSMISSION`].
    pub partial_transmissions: &'a [PartialTransmission],
    /// Indexed by the members of [`MaterialTextures`].
    pub uses: &'a [TextureUse],
    /// Indexed by [`TextureUse::texture_index`].
    pub textures: &'a [Texture],
}

/// The tables that a [`ShadingTables`] borrows, owned; their contents are documented there.
// Exhaustive: as `ShadingTables`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnedShadingTables {
    /// [`ShadingTables::normals`].
    pub normals: Vec<[u32; 3]>,
    /// [`ShadingTables::tangents`].
    pub tangents: Vec<[u32; 3]>,
    /// [`ShadingTables::colors`].
    pub colors: Vec<[[u32; 2]; 3]>,
    /// [`ShadingTables::uvs`].
    pub uvs: Vec<[[f32; 2]; 3]>,
    /// [`ShadingTables::material_textures`].
    pub material_textures: Vec<MaterialTextures>,
    /// [`ShadingTables::anisotropies`].
    pub anisotropies: Vec<Anisotropy>,
    /// [`ShadingTables::diffuse_transmissions`].
    pub diffuse_transmissions: Vec<DiffuseTransmission>,
    /// [`ShadingTables::clearcoat_normals`].
    pub clearcoat_normals: Vec<ClearcoatNormal>,
    /// [`ShadingTables::sheens`].
    pub sheens: Vec<SheenLayer>,
    /// [`ShadingTables::partial_transmissions`].
    pub partial_transmissions: Vec<PartialTransmission>,
    /// [`ShadingTables::uses`].
    pub uses: Vec<TextureUse>,
    /// [`ShadingTables::textures`].
    pub textures: Vec<Texture>,
}

impl OwnedShadingTables {
    /// The tables, borrowed.
    #[inline]
    #[must_use]
    pub fn view(&self) -> ShadingTables<'_> {
        ShadingTables {
            normals: &self.normals,
            tangents: &self.tangents,
            colors: &self.colors,
            uvs: &self.uvs,
            material_textures: &self.material_textures,
            anisotropies: &self.anisotropies,
            diffuse_transmissions: &self.diffuse_transmissions,
            clearcoat_normals: &self.clearcoat_normals,
            sheens: &self.sheens,
            partial_transmissions: &self.partial_transmissions,
            uses: &self.uses,
            textures: &self.textures,
        }
    }
}

/// Copies the tables, but shares the texels.
impl From<&ShadingTables<'_>> for OwnedShadingTables {
    fn from(tables: &ShadingTables<'_>) -> Self {
        Self {
            normals: tables.normals.to_vec(),
            tangents: tables.tangents.to_vec(),
            colors: tables.colors.to_vec(),
            uvs: tables.uvs.to_vec(),
            material_textures: tables.material_textures.to_vec(),
            anisotropies: tables.anisotropies.to_vec(),
            diffuse_transmissions: tables.diffuse_transmissions.to_vec(),
            clearcoat_normals: tables.clearcoat_normals.to_vec(),
            sheens: tables.sheens.to_vec(),
            partial_transmissions: tables.partial_transmissions.to_vec(),
            uses: tables.uses.to_vec(),
            textures: tables.textures.to_vec(),
        }
    }
}

impl ShadingTables<'_> {
    /// The first entry of [`Self::normals`] of a triangle without vertex normals.
    pub const FLAT: u32 = 0x8000_8000;

    /// Whether there is nothing to read.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.normals.is_empty() && self.colors.is_empty() && self.material_textures.is_empty()
    }
}

//! Textures of a scene description, and how materials refer to them.

use std::sync::Arc;

use photon_core::{Filter, TexelFormat, Texture, Wrap};

use crate::parameter::TEXTURES;

/// Handle of a texture of one [`crate::SceneBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextureId(pub(crate) u32);

/// A named image.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TextureDesc {
    /// Name in messages; need not be unique.
    pub name: String,
    /// The image. Texels of [`TexelFormat::Float32`] must be finite and ≥ 0; as base colours and normals, ≤ 1.
    pub image: Texture,
}

impl TextureDesc {
    /// A texture as it is.
    #[must_use]
    pub fn new(name: impl Into<String>, image: Texture) -> Self {
        Self { name: name.into(), image }
    }

    /// An image of colours encoded as sRGB: red, green, blue and alpha, row by row from the top left. Repeated beyond
    /// its edges and filtered.
    #[must_use]
    pub fn srgb8(name: impl Into<String>, width: u32, height: u32, texels: &[[u8; 4]]) -> Self {
        let words = texels.iter().map(|texel| u32::from_le_bytes(*texel)).collect();
        Self::from_words(name, [width, height], TexelFormat::Srgb8, words)
    }

    /// As [`Self::srgb8`], but linear: for normal maps.
    #[must_use]
    pub fn linear8(name: impl Into<String>, width: u32, height: u32, texels: &[[u8; 4]]) -> Self {
        let words = texels.iter().map(|texel| u32::from_le_bytes(*texel)).collect();
        Self::from_words(name, [width, height], TexelFormat::Linear8, words)
    }

    /// As [`Self::srgb8`], but linear 32-bit floats, which may exceed 1.
    #[must_use]
    pub fn float32(name: impl Into<String>, width: u32, height: u32, texels: &[[f32; 4]]) -> Self {
        let words = texels.as_flattened().iter().map(|part| part.to_bits()).collect();
        Self::from_words(name, [width, height], TexelFormat::Float32, words)
    }

    /// An image from the words of its texels.
    pub(crate) fn from_words(
        name: impl Into<String>,
        [width, height]: [u32; 2],
        format: TexelFormat,
        texels: Arc<[u32]>,
    ) -> Self {
        let (wrap, filter) = ([Wrap::Repeat; 2], Filter::Linear);
        Self::new(name, Texture { texels, width, height, format, wrap, filter })
    }

    /// The same with other wrap modes, along the rows and down the columns.
    #[must_use]
    pub fn wrapped(mut self, wrap: [Wrap; 2]) -> Self {
        self.image.wrap = wrap;
        self
    }

    /// The same with another filter.
    #[must_use]
    pub fn filtered(mut self, filter: Filter) -> Self {
        self.image.filter = filter;
        self
    }
}

/// A texture as a material uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TextureRef {
    /// The texture.
    pub texture: TextureId,
    /// Index of the UV set: [`crate::VertexAttributes::uvs`] of every mesh with the material must have it.
    pub uv_set: u32,
    /// Two rows of three numbers: `u' = m[0] · (u, v, 1)`, `v' = m[1] · (u, v, 1)`; finite in single precision. (0, 0)
    /// is the outer corner of the image's first texel, (1, 1) that of its last one.
    pub transform: [[f64; 3]; 2],
}

impl TextureRef {
    /// The transform that leaves coordinates as they are.
    pub const IDENTITY: [[f64; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    /// A texture by the coordinates of UV set 0 as they are.
    #[must_use]
    pub fn new(texture: TextureId) -> Self {
        Self { texture, uv_set: 0, transform: Self::IDENTITY }
    }

    /// The same with another [`Self::uv_set`].
    #[must_use]
    pub fn with_uv_set(self, uv_set: u32) -> Self {
        Self { uv_set, ..self }
    }

    /// The same with another [`Self::transform`].
    #[must_use]
    pub fn with_transform(self, transform: [[f64; 3]; 2]) -> Self {
        Self { transform, ..self }
    }

    /// The coordinates on the texture, from those of the UV set.
    pub(crate) fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        self.transform.map(|[a, b, c]| a * u + b * v + c)
    }
}

/// The textures of a material. [`Default`] has none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TexturesDesc {
    /// Multiplies the albedo, reflectance or tint; its alpha is not read.
    pub base_color: Option<TextureRef>,
    /// Multiplies the emission.
    pub emission: Option<TextureRef>,
    /// Tangent-space normals, as in glTF: `2 rgb − 1`, with x and y times [`Self::normal_scale`]. Meshes without
    /// tangents get those of `MikkTSpace`.
    pub normal: Option<TextureRef>,
    /// Factor on the x and y of the normal map; finite.
    pub normal_scale: f64,
    /// Green multiplies the roughness and blue the metallic share of a [`crate::Surface::Glossy`]; linear.
    pub metallic_roughness: Option<TextureRef>,
    /// Its alpha multiplies [`crate::MaterialDesc::alpha`], unless the material is [`crate::AlphaMode::Opaque`]; its
    /// colours are not read. In glTF, this is the base colour.
    pub alpha: Option<TextureRef>,
    /// Its alpha multiplies the specular factor of a [`crate::Surface::Glossy`]; its colours are not read.
    pub specular: Option<TextureRef>,
    /// Its colour multiplies [`crate::MaterialDesc::specular_color`].
    pub specular_color: Option<TextureRef>,
    /// Its red multiplies [`crate::MaterialDesc::clearcoat`]; linear.
    pub clearcoat: Option<TextureRef>,
    /// Its green multiplies [`crate::MaterialDesc::clearcoat_roughness`]; linear.
    pub clearcoat_roughness: Option<TextureRef>,
    /// Tangent-space normals of the clearcoat, as [`Self::normal`] with [`Self::clearcoat_normal_scale`]. Without it the
    /// clearcoat has the vertex normals, whatever the normal map of the surface below is.
    pub clearcoat_normal: Option<TextureRef>,
    /// Factor on the x and y of that normal map; finite.
    pub clearcoat_normal_scale: f64,
    /// Red and green are the direction of the anisotropy, `2 rg − 1` along tangent and bitangent, which
    /// [`crate::MaterialDesc::anisotropy_rotation`] turns; blue multiplies [`crate::MaterialDesc::anisotropy`]. Linear.
    pub anisotropy: Option<TextureRef>,
    /// Its alpha multiplies [`crate::MaterialDesc::diffuse_transmission`]; its colours are not read.
    pub diffuse_transmission: Option<TextureRef>,
    /// Its colour multiplies [`crate::MaterialDesc::diffuse_transmission_color`].
    pub diffuse_transmission_color: Option<TextureRef>,
    /// Its red multiplies [`crate::MaterialDesc::transmission`]; linear.
    pub transmission: Option<TextureRef>,
    /// Its colour multiplies [`crate::MaterialDesc::sheen_color`].
    pub sheen_color: Option<TextureRef>,
    /// Its alpha multiplies [`crate::MaterialDesc::sheen_roughness`]; its colours are not read.
    pub sheen_roughness: Option<TextureRef>,
}

impl Default for TexturesDesc {
    /// No texture.
    fn default() -> Self {
        Self {
            base_color: None,
            emission: None,
            normal: None,
            normal_scale: 1.0,
            metallic_roughness: None,
            alpha: None,
            specular: None,
            specular_color: None,
            clearcoat: None,
            clearcoat_roughness: None,
            clearcoat_normal: None,
            clearcoat_normal_scale: 1.0,
            anisotropy: None,
            diffuse_transmission: None,
            diffuse_transmission_color: None,
            transmission: None,
            sheen_color: None,
            sheen_roughness: None,
        }
    }
}

impl TexturesDesc {
    /// The same with this texture as [`Self::base_color`].
    #[must_use]
    pub fn with_base_color(self, texture: TextureRef) -> Self {
        Self { base_color: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::emission`].
    #[must_use]
    pub fn with_emission(self, texture: TextureRef) -> Self {
        Self { emission: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::normal`].
    #[must_use]
    pub fn with_normal(self, texture: TextureRef) -> Self {
        Self { normal: Some(texture), ..self }
    }

    /// The same with another [`Self::normal_scale`].
    #[must_use]
    pub fn with_normal_scale(self, normal_scale: f64) -> Self {
        Self { normal_scale, ..self }
    }

    /// The same with this texture as [`Self::metallic_roughness`].
    #[must_use]
    pub fn with_metallic_roughness(self, texture: TextureRef) -> Self {
        Self { metallic_roughness: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::alpha`].
    #[must_use]
    pub fn with_alpha(self, texture: TextureRef) -> Self {
        Self { alpha: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::specular`].
    #[must_use]
    pub fn with_specular(self, texture: TextureRef) -> Self {
        Self { specular: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::specular_color`].
    #[must_use]
    pub fn with_specular_color(self, texture: TextureRef) -> Self {
        Self { specular_color: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::clearcoat`].
    #[must_use]
    pub fn with_clearcoat(self, texture: TextureRef) -> Self {
        Self { clearcoat: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::clearcoat_roughness`].
    #[must_use]
    pub fn with_clearcoat_roughness(self, texture: TextureRef) -> Self {
        Self { clearcoat_roughness: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::clearcoat_normal`], and this [`Self::clearcoat_normal_scale`].
    #[must_use]
    pub fn with_clearcoat_normal(self, texture: TextureRef, scale: f64) -> Self {
        Self { clearcoat_normal: Some(texture), clearcoat_normal_scale: scale, ..self }
    }

    /// The same with this texture as [`Self::anisotropy`].
    #[must_use]
    pub fn with_anisotropy(self, texture: TextureRef) -> Self {
        Self { anisotropy: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::diffuse_transmission`].
    #[must_use]
    pub fn with_diffuse_transmission(self, texture: TextureRef) -> Self {
        Self { diffuse_transmission: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::diffuse_transmission_color`].
    #[must_use]
    pub fn with_diffuse_transmission_color(self, texture: TextureRef) -> Self {
        Self { diffuse_transmission_color: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::transmission`].
    #[must_use]
    pub fn with_transmission(self, texture: TextureRef) -> Self {
        Self { transmission: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::sheen_color`].
    #[must_use]
    pub fn with_sheen_color(self, texture: TextureRef) -> Self {
        Self { sheen_color: Some(texture), ..self }
    }

    /// The same with this texture as [`Self::sheen_roughness`].
    #[must_use]
    pub fn with_sheen_roughness(self, texture: TextureRef) -> Self {
        Self { sheen_roughness: Some(texture), ..self }
    }

    /// The textures with the names of their uses.
    pub(crate) fn all(&self) -> impl Iterator<Item = (&'static str, TextureRef)> {
        TEXTURES.iter().filter_map(|texture| Some((texture.field, texture.of(self)?)))
    }
}

//! Surfaces of a scene: triangles and their materials.
//!
//! Layouts as in [`crate::Element`].

use bytemuck::{Pod, Zeroable};

/// Geometric normal and material of a triangle.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Primitive {
    /// Unit normal; from the front, the vertices are counter-clockwise.
    pub normal: [f32; 3],
    /// Index of the material.
    pub material: u32,
}

/// The type of scattering at a surface.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MaterialKind {
    /// Lambertian reflection on both sides; stores photons unless it is black.
    Lambert = 0,
    /// A perfect mirror, on both sides.
    Mirror = 1,
    /// A smooth boundary of a solid: reflects and refracts by the Fresnel equations.
    Dielectric = 2,
    /// A smooth sheet without thickness: reflects, or transmits without changing the direction.
    Thin = 3,
    /// GGX reflection: a rough metal, or a diffuse base under a rough dielectric coat, or a mixture of both: the
    /// metallic-roughness model of glTF 2.0. Camera paths go on by the reflection, and photons are stored for the base.
    Glossy = 4,
}

impl MaterialKind {
    /// All kinds, ordered by number.
    pub const ALL: [Self; 5] = [Self::Lambert, Self::Mirror, Self::Dielectric, Self::Thin, Self::Glossy];

    /// The kind with this number; `None` if there is none.
    #[inline]
    #[must_use]
    pub const fn from_u32(number: u32) -> Option<Self> {
        match number {
            0 => Some(Self::Lambert),
            1 => Some(Self::Mirror),
            2 => Some(Self::Dielectric),
            3 => Some(Self::Thin),
            4 => Some(Self::Glossy),
            _ => None,
        }
    }

    /// Whether some light is transmitted.
    #[inline]
    #[must_use]
    pub const fn transmits(self) -> bool {
        match self {
            Self::Lambert | Self::Mirror | Self::Glossy => false,
            Self::Dielectric | Self::Thin => true,
        }
    }
}

/// Scattering and emission of a surface.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Material {
    /// Lambert: albedo. Mirror: reflectance at normal incidence. Dielectric: tint of transmitted light. Glossy: base
    /// colour, the albedo of the base and the reflectance of the metal. In `[0, 1]`, linear RGB.
    pub albedo: [f32; 3],
    /// Number of a [`MaterialKind`]; see [`Material::kind`].
    pub kind: u32,
    /// Emitted radiance, linear RGB, in units of total power per steradian and squared normalised
    /// length; from the front only unless [`Material::EMITS_BOTH_SIDES`].
    pub emission: [f32; 3],
    /// Bits: [`Material::EMITS_BOTH_SIDES`], [`Material::ALPHA`], [`Material::DIFFUSE_TRANSMISSION`],
    /// [`Material::PARTIAL_TRANSMISSION`].
    pub flags: u32,
    /// Dielectric: index of the solid's medium in the scene's table, ≥ 1. Otherwise 0.
    pub medium: u32,
    /// Refractive index of a dielectric or a thin sheet relative to vacuum, > 0; that of a glossy coat, ≥ 0, where 0
    /// stands for a coat that reflects everything. 1 otherwise.
    pub ior: f32,
    /// Textures that multiply the colours: 1 + index into [`crate::ShadingTables::material_textures`]; 0 without any.
    pub textures: u32,
    /// Glossy: the share of metal, in `[0, 1]`; the rest has a base under a dielectric coat. Mirror: how far the reflectance
    /// rises to 1 at grazing angles (Schlick 1994, equation 15): 0 not at all, 1 as that of metals. Otherwise 0.
    pub metallic: f32,
    /// Glossy, dielectric and thin: roughness, in `[0, 1]`; the width of the distribution is its square. Of glossy surfaces
    /// it is at least [`crate::ggx::MIN_ALPHA`]; dielectrics of lower widths are smooth. Otherwise 0.
    pub roughness: f32,
    /// Glossy: factor on the reflection of the coat, in `[0, 1]`; 0 leaves a Lambertian base. Otherwise 0.
    pub specular: f32,
    /// With [`Material::ALPHA`]: factor on the alpha of the surface, in `[0, 1]`.
    pub alpha: f32,
    /// With [`Material::ALPHA`]: the surface is there where alpha is at least this, if it is above 0. If it is 0, the
    /// surface is there with a probability of alpha. Finite, ≥ 0.
    pub alpha_cutoff: f32,
}

impl Material {
    /// Flag: the back emits too.
    pub const EMITS_BOTH_SIDES: u32 = 1;
    /// Flag: the surface is only partly there (alpha coverage). Its alpha is [`Material::alpha`] times that of the
    /// texture [`crate::MaterialTextures::alpha`] times that of the vertex colours. Not for dielectrics, whose boundaries
    /// must be closed. Emitted light is covered likewise; [`crate::Light::power`] does not include alpha.
    pub const ALPHA: u32 = 1 << 1;
    /// Flag of glossy materials: [`crate::ShadingTables::diffuse_transmissions`] has an entry for it whose factor is above 0.
    pub const DIFFUSE_TRANSMISSION: u32 = 1 << 2;
    /// Flag of Lambertian and glossy materials: the surface is glass for the share of
    /// [`crate::ShadingTables::partial_transmissions`], whose entry names the material of the glass, which
    /// emits the same light.
    pub const PARTIAL_TRANSMISSION: u32 = 1 << 3;

    /// The type of scattering. [`crate::SceneView::validate`] refuses unknown numbers; here they count as
    /// Lambert.
    #[inline]
    #[must_use]
    pub const fn kind(&self) -> MaterialKind {
        match MaterialKind::from_u32(self.kind) {
            Some(kind) => kind,
            None => MaterialKind::Lambert,
        }
    }

    /// Whether some of the scattering is diffuse. Textures may make a glossy surface less metallic than its factor says.
    #[inline]
    #[must_use]
    pub fn is_diffuse(&self) -> bool {
        match self.kind() {
            MaterialKind::Lambert => true,
            MaterialKind::Mirror | MaterialKind::Dielectric | MaterialKind::Thin => false,
            MaterialKind::Glossy => self.metallic < 1.0 || self.textures != 0,
        }
    }

    /// Whether photons are stored here: where some of the scattering is diffuse and not black. Texels that are black do not
    /// count, so that estimates beside them have all of their photons. Before textures are evaluated.
    #[inline]
    #[must_use]
    pub fn stores_photons(&self) -> bool {
        self.is_diffuse() && (self.albedo != [0.0; 3] || self.flags & Self::DIFFUSE_TRANSMISSION != 0)
    }

    /// Whether camera paths go on here: whether some of the scattering is specular or glossy.
    #[inline]
    #[must_use]
    pub const fn is_specular(&self) -> bool {
        match self.kind() {
            MaterialKind::Lambert => false,
            MaterialKind::Mirror | MaterialKind::Dielectric | MaterialKind::Thin | MaterialKind::Glossy => true,
        }
    }

    /// Whether it is glass that may be rough. Textures may make it smooth, and solids are smooth between media of equal
    /// index; a sheet of refractive index 1 is never rough.
    #[inline]
    #[must_use]
    pub fn is_rough_glass(&self) -> bool {
        let is_rough = self.roughness * self.roughness >= crate::ggx::MIN_ALPHA;
        match self.kind() {
            MaterialKind::Dielectric => is_rough,
            MaterialKind::Thin => is_rough && (self.ior - 1.0).abs() >= crate::rough_glass::MIN_CONTRAST,
            MaterialKind::Lambert | MaterialKind::Mirror | MaterialKind::Glossy => false,
        }
    }

    /// Whether camera paths sample lights here, for the light that arrives or that the surface scatters. After textures are
    /// evaluated.
    #[inline]
    #[must_use]
    pub fn samples_lights(&self) -> bool {
        match self.kind() {
            MaterialKind::Lambert | MaterialKind::Glossy => true,
            MaterialKind::Dielectric | MaterialKind::Thin => self.is_rough_glass(),
            MaterialKind::Mirror => false,
        }
    }

    /// Whether light of the map for reflections is estimated here: [`crate::GlossCaustics`].
    #[inline]
    #[must_use]
    pub const fn has_reflection(&self) -> bool {
        match self.kind() {
            MaterialKind::Glossy => true,
            MaterialKind::Lambert | MaterialKind::Mirror | MaterialKind::Dielectric | MaterialKind::Thin => false,
        }
    }

    /// Whether the surface may be only partly there: [`Material::ALPHA`].
    #[inline]
    #[must_use]
    pub const fn has_alpha(&self) -> bool {
        self.flags & Self::ALPHA != 0
    }

    /// Whether a share of the surface may be glass: [`Material::PARTIAL_TRANSMISSION`].
    #[inline]
    #[must_use]
    pub const fn has_partial_transmission(&self) -> bool {
        self.flags & Self::PARTIAL_TRANSMISSION != 0
    }

    /// Whether it emits light.
    #[must_use]
    pub fn is_emissive(&self) -> bool {
        self.emission != [0.0; 3]
    }
}

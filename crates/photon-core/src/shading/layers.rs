//! What a glossy surface has beyond its [`crate::Material`]; `layers.glsl` is the twin.

use glam::Vec3;

use crate::scene::material::Material;

/// Factors from [`crate::MaterialTextures`] with their textures, at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Layers {
    /// Factor on the reflectance of the coat at normal incidence, ≥ 0; the product is at most 1.
    pub specular_color: Vec3,
    /// Weight of the clearcoat, in `[0, 1]`; 0 without one.
    pub clearcoat: f32,
    /// Its roughness, in `[0, 1]`; the width of the distribution is its square.
    pub clearcoat_roughness: f32,
    /// Its shading normal, on the side that the ray came from; 0 for that of the surface below.
    pub coat_normal: Vec3,
    /// Strength of the anisotropy of the reflection, in `[0, 1]`; 0 without any: [`crate::anisotropy`].
    pub anisotropy: f32,
    /// Direction of the anisotropy, in which the reflection is wider: a vector along the surface, of which only the line
    /// matters, or 0 for any.
    pub tangent: Vec3,
    /// Share of the base that transmits instead of reflecting, in `[0, 1]`; 0 without diffuse transmission.
    pub diffuse_transmission: f32,
    /// Its albedo where all of the base transmits.
    pub transmission_color: Vec3,
    /// Colour of the sheen, each channel in `[0, 1]`; 0 without one: [`crate::sheen`].
    pub sheen_color: Vec3,
    /// Its roughness, in `[0, 1]`.
    pub sheen_roughness: f32,
}

impl Layers {
    /// Of a material without any of it.
    pub const NONE: Self = Self {
        specular_color: Vec3::ONE,
        clearcoat: 0.0,
        clearcoat_roughness: 0.0,
        coat_normal: Vec3::ZERO,
        anisotropy: 0.0,
        tangent: Vec3::ZERO,
        diffuse_transmission: 0.0,
        transmission_color: Vec3::ONE,
        sheen_color: Vec3::ZERO,
        sheen_roughness: 0.0,
    };

    /// The same with this [`Self::specular_color`].
    #[must_use]
    pub const fn with_specular_color(self, specular_color: Vec3) -> Self {
        Self { specular_color, ..self }
    }

    /// The same with a clearcoat of this weight and roughness.
    #[must_use]
    pub const fn with_clearcoat(self, weight: f32, roughness: f32) -> Self {
        Self { clearcoat: weight, clearcoat_roughness: roughness, ..self }
    }

    /// The same with this [`Self::coat_normal`].
    #[must_use]
    pub const fn with_coat_normal(self, coat_normal: Vec3) -> Self {
        Self { coat_normal, ..self }
    }

    /// The same with this [`Self::anisotropy`] in the direction of [`Self::tangent`].
    #[must_use]
    pub const fn with_anisotropy(self, anisotropy: f32, tangent: Vec3) -> Self {
        Self { anisotropy, tangent, ..self }
    }

    /// The same with this [`Self::diffuse_transmission`] and [`Self::transmission_color`].
    #[must_use]
    pub const fn with_diffuse_transmission(self, share: f32, color: Vec3) -> Self {
        Self { diffuse_transmission: share, transmission_color: color, ..self }
    }

    /// The same with this [`Self::sheen_color`] and [`Self::sheen_roughness`].
    #[must_use]
    pub const fn with_sheen(self, color: Vec3, roughness: f32) -> Self {
        Self { sheen_color: color, sheen_roughness: roughness, ..self }
    }

    /// Reflectance at normal incidence of the coat of `material`: its factor times `min(s ((n−1)/(n+1))², 1)`.
    #[inline]
    #[must_use]
    pub fn coat_f0(&self, material: &Material) -> Vec3 {
        let at_normal = (material.ior - 1.0) / (material.ior + 1.0);
        (self.specular_color * (at_normal * at_normal)).min(Vec3::ONE) * material.specular
    }
}

impl Default for Layers {
    fn default() -> Self {
        Self::NONE
    }
}

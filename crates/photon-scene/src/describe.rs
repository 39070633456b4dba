//! Scene descriptions in user space, in f64.
//!
//! Units are radiometric and per channel of linear RGB; the unit of length is the user's choice
//! (called a metre here).

mod camera;
mod dispersion;
mod grid;
mod light;
mod medium;
mod phase;

pub use self::camera::{CameraDesc, Projection, ThinLens};
pub use self::dispersion::Dispersion;
pub(crate) use self::dispersion::warn as warn_of_clamped_indices;
pub use self::grid::GridDesc;
pub(crate) use self::grid::MediaTable;
pub use self::light::LightDesc;
pub use self::medium::AmbientMedium;
pub(crate) use self::medium::{check_density, record as medium_record, warn as warn_of_clamped_anisotropy};
pub use self::phase::{PhaseDesc, PhaseKeys};
use crate::texture::TexturesDesc;

/// How a surface scatters light. Colours are linear RGB in `[0, 1]`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Surface {
    /// Diffuse (Lambertian) reflection on both sides.
    Lambert {
        /// Fraction of the incident light that is scattered.
        albedo: [f64; 3],
    },
    /// A perfect mirror on both sides.
    Mirror {
        /// Fraction of the incident light that is reflected.
        reflectance: [f64; 3],
    },
    /// The boundary of a solid, smooth or rough (GGX). Its triangles must form a closed mesh whose fronts (where the
    /// vertices run counter-clockwise) face outwards.
    Dielectric {
        /// Refractive index inside, relative to vacuum; finite and > 0. The surrounding medium, be it air or another
        /// solid, is accounted for separately.
        ior: f64,
        /// Absorption coefficient inside (Beer–Lambert), per user length, finite and ≥ 0.
        absorption: [f64; 3],
        /// Multiplies transmitted light at each crossing of the boundary.
        tint: [f64; 3],
        /// Roughness, in `[0, 1]`: the square root of the width α of the distribution. Widths below 0.001 are smooth.
        roughness: f64,
    },
    /// The boundary of a medium that has the refractive index of what is around it: mist, smoke, ink. Light passes it without
    /// reflection, refraction or any other event. Its triangles must form a closed mesh whose fronts face outwards; meshes of
    /// one medium may overlap. Surfaces may coincide with it.
    Boundary {
        /// As that of [`Surface::Dielectric`].
        absorption: [f64; 3],
    },
    /// A sheet without thickness, which light passes without change of direction if it is smooth; rough ones scatter what
    /// they transmit as they scatter what they reflect.
    Thin {
        /// Refractive index of the sheet, finite and > 0.
        ior: f64,
        /// Multiplies transmitted light.
        tint: [f64; 3],
        /// As that of [`Surface::Dielectric`].
        roughness: f64,
    },
    /// Rough reflection (GGX), on both sides: the metallic-roughness model of glTF 2.0. A metal reflects
    /// `base_color`; all else has a diffuse base of that albedo under a colourless dielectric coat.
    Glossy {
        /// Reflectance of the metal, and albedo of the base.
        base_color: [f64; 3],
        /// Share of metal, in `[0, 1]`.
        metallic: f64,
        /// Roughness, in `[0, 1]`: the square root of the width α of the distribution. Widths below 0.001 are rendered
        /// as 0.001, which blurs reflections by 0.06 degrees; full metals of such widths reflect in the mirror direction
        /// only, with a reflectance that rises to 1 at grazing angles.
        roughness: f64,
        /// Factor on the reflection of the coat, in `[0, 1]`; 0 leaves a diffuse surface, where there is no metal, and
        /// the same as [`Surface::Lambert`] without any metal.
        specular: f64,
        /// Refractive index of the coat, finite and ≥ 0; 0 stands for a coat that reflects all light, and 1 for none.
        ior: f64,
    },
}

/// Which part of a surface is there (alpha coverage, as in glTF). The alpha of a point is [`MaterialDesc::alpha`] times the
/// alpha of [`crate::TexturesDesc::alpha`] times that of the vertex colours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum AlphaMode {
    /// All of it: alpha is not read.
    #[default]
    Opaque,
    /// The points whose alpha is at least `cutoff`.
    Mask {
        /// Finite and ≥ 0.
        cutoff: f64,
    },
    /// Each point, for a share of all light and of all views that is its alpha. Which points are there for a ray is chosen
    /// at random.
    Blend,
}

/// A named material: a surface, its emission and its textures.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MaterialDesc {
    /// Name in messages and override files; need not be unique.
    pub name: String,
    /// How the surface scatters light.
    pub surface: Surface,
    /// Emitted radiance, the same in all directions, W/(m²·sr), finite and ≥ 0.
    pub emission: [f64; 3],
    /// Whether the back emits too, not only the front.
    pub emits_both_sides: bool,
    /// Where solids overlap, the one of the highest priority applies; among equals, the one that light entered last.
    /// Of boundaries, the one with the highest priority absorbs and scatters light; among equals a solid, then the one
    /// around the smallest volume. Only for [`Surface::Dielectric`] and [`Surface::Boundary`], and where
    /// [`Self::transmission_absorption`] makes a solid.
    pub priority: u32,
    /// Formula of the refractive index by the wavelength; `None` if it does not depend on it. For solids alone, as [`Self::priority`].
    pub dispersion: Option<Dispersion>,
    /// Scattering coefficient inside, per user length, linear RGB, finite and ≥ 0: milk, wax, mist. Only for
    /// [`Surface::Dielectric`] and [`Surface::Boundary`].
    pub scattering: [f64; 3],
    /// Directions of light scattered there.
    pub phase: PhaseDesc,
    /// Densities that multiply the coefficients of scattering and absorption inside; `None` if they are the same everywhere.
    /// Only for [`Surface::Dielectric`].
    pub grid: Option<GridDesc>,
    /// Factor on the alpha of the surface, in `[0, 1]`.
    pub alpha: f64,
    /// What alpha does. Emitted light is covered like the surface. Not for [`Surface::Dielectric`], whose mesh must be
    /// closed.
    pub alpha_mode: AlphaMode,
    /// Factor on the reflectance at normal incidence of the coat of a [`Surface::Glossy`], linear RGB, finite and ≥ 0; the
    /// product is at most 1. White, which is usual, is a coat without colour. At grazing angles every coat is colourless.
    pub specular_color: [f64; 3],
    /// Weight of a clearcoat, in `[0, 1]`: a colourless dielectric layer of refractive index 1.5 over the surface; 0 without
    /// one. Not for [`Surface::Dielectric`] and [`Surface::Thin`]. It dims emission.
    pub clearcoat: f64,
    /// Roughness of the clearcoat, in `[0, 1]`: the square root of the width of its distribution.
    pub clearcoat_roughness: f64,
    /// Strength s of the anisotropy of a [`Surface::Glossy`], in `[0, 1]`; 0 without any. The reflection is wider along the
    /// direction of [`Self::anisotropy_rotation`], where the width of its distribution is `α + (1 − α) s²`; across, it is
    /// α, the square of the roughness.
    pub anisotropy: f64,
    /// Angle of that direction from the tangent of the mesh, towards the bitangent, in radians. Meshes without tangents get
    /// those of `MikkTSpace` for the texture coordinates of the normal map, else of [`TexturesDesc::anisotropy`], else of
    /// UV set 0; without these, the tangent is around the y axis.
    pub anisotropy_rotation: f64,
    /// Share of the base of a [`Surface::Lambert`] or [`Surface::Glossy`] that transmits light diffusely to the other side
    /// instead of reflecting it, in `[0, 1]`; 0 for none. The surface is a sheet without thickness, which looks alike from
    /// both sides: a leaf, paper, cloth. Metals and the reflections of coats do not transmit.
    pub diffuse_transmission: f64,
    /// Albedo of that transmission, linear RGB, each channel in `[0, 1]`.
    pub diffuse_transmission_color: [f64; 3],
    /// Share of a [`Surface::Glossy`] that is glass, in `[0, 1]`; 0 for none. Of what is not metal: as in glTF, metal does not
    /// transmit. The glass has the refractive index, roughness and base colour of the surface, the latter as its tint. It is
    /// a sheet without thickness, unless [`Self::transmission_absorption`] is given. Its clearcoat, sheen, anisotropy and
    /// specular factors are those of the opaque part alone.
    pub transmission: f64,
    /// Absorption coefficient inside, as of [`Surface::Dielectric`]: the mesh bounds a solid and must be closed. `None` for
    /// a sheet.
    pub transmission_absorption: Option<[f64; 3]>,
    /// Colour of a sheen over the surface, which reflects light at grazing angles like the fibres of cloth, linear RGB, each
    /// channel in `[0, 1]`; black without one. Not for [`Surface::Dielectric`] and [`Surface::Thin`].
    pub sheen_color: [f64; 3],
    /// Roughness of the sheen, in `[0, 1]`: the lower, the more of it is at grazing angles. Below 0.07 it is rendered as 0.07.
    pub sheen_roughness: f64,
    /// Textures that multiply the colours above, and a normal map.
    pub textures: TexturesDesc,
}

impl MaterialDesc {
    /// A material with the given surface and no emission.
    #[must_use]
    pub fn new(name: impl Into<String>, surface: Surface) -> Self {
        Self {
            name: name.into(),
            surface,
            emission: [0.0; 3],
            emits_both_sides: false,
            priority: 0,
            dispersion: None,
            scattering: [0.0; 3],
            phase: PhaseDesc::default(),
            grid: None,
            alpha: 1.0,
            alpha_mode: AlphaMode::Opaque,
            specular_color: [1.0; 3],
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            anisotropy: 0.0,
            anisotropy_rotation: 0.0,
            diffuse_transmission: 0.0,
            diffuse_transmission_color: [1.0; 3],
            transmission: 0.0,
            transmission_absorption: None,
            sheen_color: [0.0; 3],
            sheen_roughness: 0.0,
            textures: TexturesDesc::default(),
        }
    }

    /// A diffuse surface.
    #[must_use]
    pub fn lambert(name: impl Into<String>, albedo: [f64; 3]) -> Self {
        Self::new(name, Surface::Lambert { albedo })
    }

    /// A mirror.
    #[must_use]
    pub fn mirror(name: impl Into<String>, reflectance: [f64; 3]) -> Self {
        Self::new(name, Surface::Mirror { reflectance })
    }

    /// A metal of this reflectance, and roughness in `[0, 1]`.
    #[must_use]
    pub fn metal(name: impl Into<String>, reflectance: [f64; 3], roughness: f64) -> Self {
        let surface = Surface::Glossy { base_color: reflectance, metallic: 1.0, roughness, specular: 1.0, ior: 1.5 };
        Self::new(name, surface)
    }

    /// A diffuse base under a coat of refractive index 1.5, with roughness in `[0, 1]`.
    #[must_use]
    pub fn plastic(name: impl Into<String>, albedo: [f64; 3], roughness: f64) -> Self {
        let surface = Surface::Glossy { base_color: albedo, metallic: 0.0, roughness, specular: 1.0, ior: 1.5 };
        Self::new(name, surface)
    }

    /// Clear glass inside a closed mesh.
    #[must_use]
    pub fn glass(name: impl Into<String>, ior: f64) -> Self {
        Self::new(name, Surface::Dielectric { ior, absorption: [0.0; 3], tint: [1.0; 3], roughness: 0.0 })
    }

    /// A clear pane without thickness.
    #[must_use]
    pub fn thin(name: impl Into<String>, ior: f64) -> Self {
        Self::new(name, Surface::Thin { ior, tint: [1.0; 3], roughness: 0.0 })
    }

    /// A [`Surface::Boundary`] of a medium of this absorption coefficient.
    #[must_use]
    pub fn boundary(name: impl Into<String>, absorption: [f64; 3]) -> Self {
        Self::new(name, Surface::Boundary { absorption })
    }

    /// A diffuse surface whose front emits `radiance`, W/(m²·sr).
    #[must_use]
    pub fn emissive(name: impl Into<String>, albedo: [f64; 3], radiance: [f64; 3]) -> Self {
        Self { emission: radiance, ..Self::lambert(name, albedo) }
    }

    /// The material with [`Self::emits_both_sides`] set or cleared.
    #[must_use]
    pub fn with_both_sides(self, emits_both_sides: bool) -> Self {
        Self { emits_both_sides, ..self }
    }

    /// The material with this [`Self::specular_color`].
    #[must_use]
    pub fn with_specular_color(self, specular_color: [f64; 3]) -> Self {
        Self { specular_color, ..self }
    }

    /// The material with this [`Self::clearcoat`] and [`Self::clearcoat_roughness`].
    #[must_use]
    pub fn with_clearcoat(self, clearcoat: f64, clearcoat_roughness: f64) -> Self {
        Self { clearcoat, clearcoat_roughness, ..self }
    }

    /// The material with this [`Self::anisotropy`] and [`Self::anisotropy_rotation`].
    #[must_use]
    pub fn with_anisotropy(self, anisotropy: f64, anisotropy_rotation: f64) -> Self {
        Self { anisotropy, anisotropy_rotation, ..self }
    }

    /// The material with this [`Self::diffuse_transmission`] and [`Self::diffuse_transmission_color`].
    #[must_use]
    pub fn with_diffuse_transmission(self, diffuse_transmission: f64, diffuse_transmission_color: [f64; 3]) -> Self {
        Self { diffuse_transmission, diffuse_transmission_color, ..self }
    }

    /// The material with this [`Self::transmission`] and [`Self::transmission_absorption`].
    #[must_use]
    pub fn with_transmission(self, transmission: f64, transmission_absorption: Option<[f64; 3]>) -> Self {
        Self { transmission, transmission_absorption, ..self }
    }

    /// The material with this [`Self::sheen_color`] and [`Self::sheen_roughness`].
    #[must_use]
    pub fn with_sheen(self, sheen_color: [f64; 3], sheen_roughness: f64) -> Self {
        Self { sheen_color, sheen_roughness, ..self }
    }

    /// The material with these [`Self::textures`].
    #[must_use]
    pub fn with_textures(self, textures: TexturesDesc) -> Self {
        Self { textures, ..self }
    }

    /// The material with this [`Self::alpha_mode`] and [`Self::alpha`].
    #[must_use]
    pub fn with_alpha(self, alpha_mode: AlphaMode, alpha: f64) -> Self {
        Self { alpha, alpha_mode, ..self }
    }

    /// The material with this [`Self::scattering`] and [`Self::phase`], or with the mean cosine of Henyey and Greenstein's.
    #[must_use]
    pub fn with_scattering(self, scattering: [f64; 3], phase: impl Into<PhaseDesc>) -> Self {
        Self { scattering, phase: phase.into(), ..self }
    }

    /// The material with this [`Self::grid`].
    #[must_use]
    pub fn with_grid(self, grid: GridDesc) -> Self {
        Self { grid: Some(grid), ..self }
    }

    /// Factor on the coefficients inside where the density is largest.
    pub(crate) fn density(&self) -> f64 {
        self.grid.as_ref().map_or(1.0, GridDesc::factor)
    }

    /// The material with this [`Self::priority`].
    #[must_use]
    pub fn with_priority(self, priority: u32) -> Self {
        Self { priority, ..self }
    }

    /// The material with this [`Self::dispersion`], whose formula may replace the refractive index of its surface.
    #[must_use]
    pub fn with_dispersion(mut self, dispersion: Dispersion) -> Self {
        if let Surface::Dielectric { ior, .. } | Surface::Glossy { ior, .. } = &mut self.surface {
            *ior = dispersion.ior(*ior);
        }
        Self { dispersion: Some(dispersion), ..self }
    }

    /// Refractive index of the surface, if it has one.
    pub(crate) fn ior(&self) -> Option<f64> {
        match self.surface {
            Surface::Lambert { .. } | Surface::Mirror { .. } | Surface::Boundary { .. } => None,
            Surface::Dielectric { ior, .. } | Surface::Thin { ior, .. } | Surface::Glossy { ior, .. } => Some(ior),
        }
    }

    /// The glass that a share of the surface is; `None` without any.
    pub(crate) fn transmitting_surface(&self) -> Option<Surface> {
        let Surface::Glossy { base_color: tint, roughness, ior, .. } = self.surface else { return None };
        (self.transmission > 0.0).then_some(match self.transmission_absorption {
            Some(absorption) => Surface::Dielectric { ior, absorption, tint, roughness },
            None => Surface::Thin { ior, tint, roughness },
        })
    }

    /// Whether some of the surface bounds a solid.
    pub(crate) fn is_solid(&self) -> bool {
        let is_solid = |surface: &Surface| matches!(surface, Surface::Dielectric { .. });
        is_solid(&self.surface) || self.transmitting_surface().as_ref().is_some_and(is_solid)
    }

    /// Whether it is a [`Surface::Boundary`].
    pub(crate) fn is_boundary(&self) -> bool {
        matches!(self.surface, Surface::Boundary { .. })
    }

    /// Whether the materials differ in their names at most.
    pub(crate) fn is_alike(&self, other: &Self) -> bool {
        self.surface == other.surface && *self == Self { name: self.name.clone(), ..other.clone() }
    }

    /// Whether the material emits any light.
    #[must_use]
    pub fn is_emissive(&self) -> bool {
        self.emission != [0.0; 3]
    }

    /// Whether light passes unchanged: a refractive index of 1 without absorption, scattering, tint or
    /// emission, or [`AlphaMode::Blend`] with an alpha of 0.
    #[must_use]
    pub fn is_invisible(&self) -> bool {
        if self.alpha_mode == AlphaMode::Blend && self.alpha == 0.0 {
            return true;
        }
        let clear = match self.surface {
            Surface::Dielectric { ior, absorption, tint, .. } => {
                ior == 1.0 && self.dispersion.is_none() && absorption == [0.0; 3] && tint == [1.0; 3]
            }
            Surface::Thin { ior, tint, .. } => ior == 1.0 && tint == [1.0; 3],
            // Where media overlap, a clear one may be a cavity.
            Surface::Boundary { .. } | Surface::Lambert { .. } | Surface::Mirror { .. } | Surface::Glossy { .. } => {
                false
            }
        };
        clear && self.scattering == [0.0; 3] && !self.is_emissive() && self.textures.base_color.is_none()
    }
}

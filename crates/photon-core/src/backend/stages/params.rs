//! Parameters of radiance estimates.

use crate::error::{Error, Result};
use crate::requirements::photon_format::PhotonFormat;
use crate::settings::kernel::Kernel;

/// How radiance is estimated from the photons near a query.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: written as a literal with `..EstimateParams::new(search)`.
pub struct EstimateParams {
    /// Which photons count.
    pub search: Search,
    /// How photons are weighted by distance.
    pub kernel: Kernel,
    /// Factor on every query's radius, > 0.
    pub radius_scale: f32,
    /// A photon counts if the cosine between its surface's normal and the query's is at least this; −1: all
    /// photons count.
    pub min_normal_cosine: f32,
    /// A photon counts if its distance from the query's plane is at most this share of the radius, > 0; 1:
    /// all photons in the ball count. Below 1 only with [`Search::Radius`].
    pub max_plane_distance: f32,
    /// Photons are weighted by [`crate::shading_normal::cosine_ratio`] with [`crate::Query::shading_normal`]; needs
    /// [`PhotonFormat::Full`]. Only in scenes with [`crate::Features::SHADING_NORMALS`].
    pub shading_normals: bool,
    /// Queries are for the reflection of glossy surfaces: photons are weighted by its BSDF, that of the
    /// [`crate::ReflectionLobe`] whose bits are in [`crate::Query::media`] and [`crate::Query::coat`], towards
    /// [`crate::Query::offset_or_wo`] and about [`crate::Query::shading_normal`]. An area correction counts glossy surfaces, all metals
    /// included. Needs [`PhotonFormat::Full`], and [`crate::RadianceEstimator::weighs_reflections`]. Not with
    /// [`Search::Paper`].
    pub reflection: bool,
    /// With `reflection`, in scenes with [`crate::Features::ANISOTROPY`]: [`crate::Query::path`] may have that of a surface.
    pub anisotropy: bool,
    /// With `reflection`, in scenes with [`crate::Features::SHEEN`]: it may be that of a sheen.
    pub sheen: bool,
    /// With `reflection`, where [`crate::Settings::caustic_roughness`] lets some queries count photons of all lights and others
    /// do not: a photon counts if [`crate::gloss_caustics::counts`] says so of [`crate::Photon::direction`] and
    /// [`crate::Query::offset_or_wo`].
    pub marked: bool,
}

impl EstimateParams {
    /// Parameters for `search` with defaults: each query's own radius, the constant kernel, and no photon
    /// rejected for its normal or its distance from the query's plane.
    ///
    /// Use struct update to change some of them: `EstimateParams { min_normal_cosine: 0.7,
    /// ..EstimateParams::new(Search::Radius) }`.
    #[must_use]
    pub const fn new(search: Search) -> Self {
        Self {
            search,
            kernel: Kernel::Constant,
            radius_scale: 1.0,
            min_normal_cosine: -1.0,
            max_plane_distance: 1.0,
            shading_normals: false,
            reflection: false,
            anisotropy: false,
            sheen: false,
            marked: false,
        }
    }

    /// Whether photons are rejected for their distance from the query's plane.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.max_plane_distance < 1.0
    }

    /// Checks `max_plane_distance`, alone and against the search.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] for a plane distance that is not a positive number, or below 1 with a
    /// search other than [`Search::Radius`].
    pub fn validate(&self) -> Result<()> {
        // Negated, so that NaN is refused too.
        if !(self.max_plane_distance > 0.0) {
            return Err(Error::InvalidSetting {
                name: "max-plane-distance",
                value: self.max_plane_distance.to_string(),
                hint: "must be greater than 0; with 1, all photons in the ball count",
            });
        }
        if !self.is_flat() || self.search == Search::Radius {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "max-plane-distance",
            value: format!("{}, with {:?}", self.max_plane_distance, self.search),
            hint: "is a share of a given radius: use the radius estimator, or 1",
        })
    }

    /// [`Self::validate`], for a map with this photon format: [`Search::Paper`], shading normals and reflections need
    /// the directions of photons.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`].
    pub fn validate_for(&self, photon_format: PhotonFormat) -> Result<()> {
        self.validate()?;
        let paper = matches!(self.search, Search::Paper { .. });
        if paper && self.reflection {
            return Err(Error::InvalidSetting {
                name: "the paper's estimator",
                value: "used for the reflection of glossy surfaces".into(),
                hint: "its equation has no BSDF: use another search",
            });
        }
        if !(paper || self.shading_normals || self.reflection) || photon_format == PhotonFormat::Full {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: match (paper, self.reflection) {
                (true, _) => "the paper's estimator",
                (false, true) => "an estimate of a reflection",
                (false, false) => "an estimate with shading normals",
            },
            value: format!("used with a map that stores {}", photon_format.name()),
            hint: "it needs the directions of photons: use the full photon format",
        })
    }

    /// [`Self::validate`], for [`crate::RadianceEstimator::estimate_with_moments`].
    ///
    /// # Errors
    /// [`Error::InvalidSetting`], also for any search but [`Search::Radius`].
    pub fn validate_moments(&self) -> Result<()> {
        if self.search != Search::Radius {
            return Err(Error::InvalidSetting {
                name: "errors",
                value: format!("enabled, with {:?}", self.search),
                hint: "can be estimated only with the radius estimator",
            });
        }
        self.validate()
    }
}

/// Which photons near a query count.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: every backend must implement each.
pub enum Search {
    /// All photons within the radius.
    Radius,
    /// The `k` nearest photons within the radius. If there are k, the farthest sets the radius and does not
    /// count itself, which makes the estimate unbiased: (k−1)/(π r_k²). If there are fewer, all count, with
    /// the full radius.
    KNearest {
        /// ≥ 2.
        k: u32,
    },
    /// Only the nearest photon within the radius, ties broken by the lower index: [`crate::Estimate::flux`] is its
    /// power, as it is. For maps of values known at points, such as irradiance.
    NearestPhoton,
    /// Equation (2) of Lin and Wang 2010: the `max` nearest photons within the radius, each times its
    /// cosine and `factor`, divided by π r²; 0 with fewer than `threshold`.
    Paper {
        /// ≥ 1.
        max: u32,
        /// Minimum number of photons.
        threshold: u32,
        /// Scale factor.
        factor: f32,
    },
}

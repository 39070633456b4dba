//! What a user chooses.

pub(crate) mod budget;
pub(crate) mod kernel;
pub(crate) mod option_names;
pub(crate) mod preset;

use crate::error::{Error, Result};
use crate::settings::kernel::Kernel;

/// How photons are arranged for search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum IndexKind {
    /// Left-balanced kd-tree, split at the median: the paper's first.
    Median,
    /// kd-tree split by the Voxel Volume Heuristic: the paper's second.
    Vvh,
    /// Order of Morton codes: the quickest to build.
    #[default]
    Morton,
}

/// How the photons near a query become an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimator {
    /// All within a radius that shrinks from pass to pass.
    Radius {
        /// Radius of the first pass, user space, > 0 and finite; `None`: derived for each map from
        /// the density of its photons.
        radius: Option<f64>,
    },
    /// The `k` nearest, of which the farthest only sets the radius.
    Knn {
        /// How many, ≥ 2.
        k: u32,
        /// None farther than this counts, user space, > 0; `None`: no limit but the scene.
        max_radius: Option<f64>,
    },
    /// Equation (2) of Lin and Wang 2010, with the errors that it has.
    Paper(Paper),
}

/// The free numbers of Lin and Wang 2010.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper {
    /// At most this many photons; the radius shrinks to the farthest of them. ≥ 1.
    pub max: u32,
    /// Radius of the sphere S(P, r), user space, > 0; `None`: derived as for the others.
    pub radius: Option<f64>,
    /// With fewer photons than this the estimate is 0.
    pub threshold: u32,
    /// The free scale `factor`.
    pub factor: f32,
    /// Whether the finished colour is clamped to `[0, 1]`.
    pub clamp: bool,
}

impl Default for Paper {
    fn default() -> Self {
        Self { max: 200, radius: None, threshold: 8, factor: 1.0, clamp: true }
    }
}

/// Where direct light comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Direct {
    /// Shadow rays to points on the lights.
    #[default]
    Nee,
    /// A photon map of its own.
    Photons,
    /// It is left out.
    None,
}

/// Where light that has been scattered diffusely before comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Indirect {
    /// Straight from the global map.
    #[default]
    Map,
    /// From the maps at where rays from the query land (Jensen 1996).
    Gather,
    /// It is left out.
    None,
}

/// What an estimate's flux is divided by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Area {
    /// The disc, wherever it hangs over the end of its surface: too dark there.
    #[default]
    Disc,
    /// What of the disc lies on the surface, found by a few dozen rays a query: [`crate::area`].
    /// Estimates where final-gather rays land are corrected only with [`Settings::irradiance_every`].
    Surface,
}

/// Whose radius an estimate has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Bandwidth {
    /// That of its map and pass.
    #[default]
    Shared,
    /// Times a factor of its pixel's, from the noise and bias of earlier passes, so that their sum is
    /// least. Passes are then no longer independent of which ones were rendered before. For
    /// [`Settings::errors`] alone, and not with [`Indirect::Gather`].
    PerPixel,
}

/// How paths are shared out among threads. The result is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Scheduling {
    /// A fixed quota for each.
    Static,
    /// From a shared counter, so that all finish together.
    #[default]
    Dynamic,
}

/// Which random numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RandomKind {
    /// A counter-based generator: independent for every path and dimension.
    #[default]
    Counter,
    /// The paper's linear congruential one, started at the number of the path.
    Lcg,
    /// Light, point and direction that a photon leaves by from Sobol's sequence, scrambled anew for
    /// each pass, so that the photons of a pass leave no gaps; all else as with the counter.
    Sobol,
}

/// Which paths of light fill the map of caustics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CausticPhotons {
    /// Aimed if no other map is filled, as many as [`Settings::photons`]; or if no more than a twentieth of
    /// the light could meet mirrors or glass, a quarter as many. Otherwise [`CausticPhotons::Shared`].
    #[default]
    Auto,
    /// Those that fill the other maps too.
    Shared,
    /// So many of their own in each pass, ≥ 1, aimed at mirrors and glass.
    Aimed(u32),
}

/// What a user chooses. Lengths are in user space.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Paths emitted per pass, ≥ 1.
    pub photons: u32,
    /// How photons become an estimate.
    pub estimator: Estimator,
    /// Factor on radii that are derived, > 0 and finite: below 1 for sharp caustics, above for smooth light.
    pub radius_factor: f64,
    /// How they are weighted.
    pub kernel: Kernel,
    /// What they are spread over.
    pub area: Area,
    /// Whose radius they have.
    pub bandwidth: Bandwidth,
    /// How they are arranged.
    pub index: IndexKind,
    /// Where direct light comes from.
    pub direct: Direct,
    /// Where indirect light comes from.
    pub indirect: Indirect,
    /// Whether light that came only by mirrors and glass is included.
    pub caustics: bool,
    /// Which paths it comes by.
    pub caustic_photons: CausticPhotons,
    /// Longest path, counted in surfaces met, ≥ 1; for photons and for camera paths.
    pub max_bounces: u32,
    /// Key of all random numbers.
    pub seed: u64,
    /// How fast radii shrink from pass to pass, in `(0, 1]`; 1 keeps them.
    pub alpha: f64,
    /// How paths are shared out among threads.
    pub scheduling: Scheduling,
    /// Which random numbers.
    pub random: RandomKind,
    /// Shadow rays per query and pass, ≥ 1.
    pub shadow_rays: u32,
    /// Final-gather rays per query and pass, ≥ 1.
    pub gather_rays: u32,
    /// Irradiance is found once a pass at the places of every so-manieth photon, and final-gather rays
    /// take that of the nearest (Christensen 1999), ≥ 1; `None`: each ray asks the maps. Smaller is
    /// finer; there all photons within a radius count alike. For [`Indirect::Gather`] alone, and not with
    /// [`Settings::errors`].
    pub irradiance_every: Option<u32>,
    /// A photon counts if its surface's normal and the query's have at least this cosine, in
    /// `[-1, 1]`.
    pub min_normal_cosine: f32,
    /// A photon counts if its distance from the query's plane is at most this share of the radius, in
    /// `(0, 1]`; 1: whatever lies in the ball. Below 1 a sheet beside the surface no longer shines
    /// through, but a ball of less than `radius / (2 share)` loses its rim (Jensen 2001 flattens the ball
    /// likewise). For [`Estimator::Radius`] alone.
    pub max_plane_distance: f32,
    /// Photons that a map may hold; `None`: as many as land.
    pub photon_capacity: Option<u64>,
    /// Bytes that backend and pipeline may hold for the scene, the picture and the photons; `None`: as
    /// many as it takes. Passes then have fewer photons than [`Settings::photons`] if need be, which
    /// [`crate::Facts`] says: render more of them.
    pub memory: Option<u64>,
    /// Whether the film keeps what tells the error of each pixel: [`crate::ErrorPixel`]. For
    /// [`Estimator::Radius`] alone. The picture is the same.
    pub errors: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            photons: 200_000,
            estimator: Estimator::Radius { radius: None },
            radius_factor: 1.0,
            kernel: Kernel::Epanechnikov,
            area: Area::default(),
            bandwidth: Bandwidth::default(),
            index: IndexKind::default(),
            direct: Direct::default(),
            indirect: Indirect::default(),
            caustics: true,
            caustic_photons: CausticPhotons::default(),
            max_bounces: 64,
            seed: 0,
            alpha: 2.0 / 3.0,
            scheduling: Scheduling::default(),
            random: RandomKind::default(),
            shadow_rays: 2,
            gather_rays: 16,
            irradiance_every: None,
            min_normal_cosine: 0.7,
            max_plane_distance: 1.0,
            photon_capacity: None,
            memory: None,
            errors: false,
        }
    }
}

impl Settings {
    /// As Lin and Wang 2010 have it, errors included: equation (2), the LCG, the median kd-tree,
    /// static quotas.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            estimator: Estimator::Paper(Paper::default()),
            kernel: Kernel::Constant,
            index: IndexKind::Median,
            scheduling: Scheduling::Static,
            random: RandomKind::Lcg,
            caustic_photons: CausticPhotons::Shared,
            alpha: 1.0,
            ..Self::default()
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] names the first that makes no sense.
    pub fn validate(&self) -> Result<()> {
        let ensure = |good: bool, name, value: String, hint| {
            if good { Ok(()) } else { Err(Error::InvalidSetting { name, value, hint }) }
        };
        let length = |name, radius: Option<f64>| match radius {
            Some(r) => ensure(r > 0.0 && r.is_finite(), name, r.to_string(), "must be above 0 and finite"),
            None => Ok(()),
        };
        ensure(self.photons > 0, "photons", self.photons.to_string(), "at least 1 is needed")?;
        length("radius-factor", Some(self.radius_factor))?;
        let aimed = self.caustic_photons != CausticPhotons::Aimed(0);
        ensure(aimed, "caustic-photons", "0".into(), "at least 1 is needed; to leave caustics out, say so")?;
        match self.estimator {
            Estimator::Radius { radius } => length("radius", radius)?,
            Estimator::Knn { k, max_radius } => {
                ensure(k >= 2, "k", k.to_string(), "at least 2 are needed: the farthest photon only sets the radius")?;
                length("radius", max_radius)?;
            }
            Estimator::Paper(paper) => {
                ensure(paper.max >= 1, "k", paper.max.to_string(), "at least 1 is needed")?;
                length("radius", paper.radius)?;
                let good = paper.factor.is_finite() && paper.factor >= 0.0;
                ensure(good, "factor", paper.factor.to_string(), "must be at least 0 and finite")?;
            }
        }
        if self.errors && !matches!(self.estimator, Estimator::Radius { .. }) {
            return Err(Error::InvalidSetting {
                name: "errors",
                value: format!("asked of {:?}", self.estimator),
                hint: "what an error is told by are estimates within two radii: take the estimator of a radius",
            });
        }
        if self.area == Area::Surface && matches!(self.estimator, Estimator::Paper(_)) {
            return Err(Error::InvalidSetting {
                name: "area",
                value: format!("surface, with {:?}", self.estimator),
                hint: "the paper's estimator divides by its disc: take another, or area disc",
            });
        }
        if let Kernel::Cone { slope } = self.kernel {
            ensure(
                slope >= 1.0 && slope.is_finite(),
                "slope of the cone",
                slope.to_string(),
                "must be at least 1 and finite",
            )?;
        }
        ensure(self.max_bounces >= 1, "max-bounces", self.max_bounces.to_string(), "at least 1 is needed")?;
        let alpha = self.alpha;
        ensure(alpha > 0.0 && alpha <= 1.0, "alpha", alpha.to_string(), "must be above 0 and at most 1")?;
        ensure(self.shadow_rays >= 1, "shadow-rays", self.shadow_rays.to_string(), "at least 1 is needed")?;
        ensure(self.gather_rays >= 1, "gather-rays", self.gather_rays.to_string(), "at least 1 is needed")?;
        if self.bandwidth == Bandwidth::PerPixel {
            let hint = "asks for errors, and for light that is not gathered elsewhere";
            ensure(self.errors && self.indirect != Indirect::Gather, "bandwidth", "per pixel".into(), hint)?;
        }
        if let Some(every) = self.irradiance_every {
            let name = "irradiance-every";
            ensure(every >= 1, name, every.to_string(), "at least 1 is needed")?;
            let gathers = self.indirect == Indirect::Gather;
            ensure(gathers, name, format!("{every}, with {:?}", self.indirect), "is for final gathering: ask for it")?;
            let hint = "cannot tell errors: leave one of the two out";
            ensure(!self.errors, name, format!("{every}, with errors"), hint)?;
        }
        let cosine = self.min_normal_cosine;
        ensure((-1.0..=1.0).contains(&cosine), "min-normal-cosine", cosine.to_string(), "must lie between -1 and 1")?;
        let plane = self.max_plane_distance;
        let hint = "must be above 0 and at most 1, and 1 with estimators other than that of a radius";
        let good = plane == 1.0 || (plane > 0.0 && plane < 1.0 && matches!(self.estimator, Estimator::Radius { .. }));
        ensure(good, "max-plane-distance", plane.to_string(), hint)?;
        Ok(())
    }
}

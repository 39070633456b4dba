//! //! Settings that a user chooses.

pub(crate) mod budget;
pub(crate) mod kernel;
pub(crate) mod option_names;
pub(crate) mod preset;
pub(crate) mod rule;
#[cfg(feature = "serde")]
mod serialized;

use crate::error::{Error, Result};
use crate::settings::kernel::Kernel;
use crate::shown::number;

/// How photons are arranged for searching.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
// Exhaustive: every backend must build each.
pub enum IndexKind {
    /// Left-balanced kd-tree, split at the median: the first of Lin and Wang 2010.
    Median,
    /// kd-tree split by the Voxel Volume Heuristic: the second of Lin and Wang 2010.
    Vvh,
    /// Photons sorted by Morton code: the fastest to build.
    #[default]
    Morton,
}

/// How radiance is estimated from the photons near a query.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: the program has options for the parameters of each.
pub enum Estimator {
    /// All photons within a radius that shrinks from pass to pass.
    Radius {
        /// Radius of the first pass, user space, > 0 and finite; `None`: derived for each map from the
        /// density of its photons.
        radius: Option<f64>,
    },
    /// The `k` nearest photons, of which the farthest only sets the radius.
    Knn {
        /// Number of photons, ≥ 2.
        k: u32,
        /// Largest search radius, user space, > 0; `None`: limited only by the size of the scene.
        max_radius: Option<f64>,
    },
    /// Equation (2) of Lin and Wang 2010, including its errors.
    Paper(Paper),
}

impl Estimator {
    /// Whether pictures are clamped to `[0, 1]`, which [`Paper::clamp`] asks for.
    pub(crate) fn clamps(&self) -> bool {
        matches!(self, Self::Paper(paper) if paper.clamp)
    }
}

/// Parameters of the estimator of Lin and Wang 2010.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
// Exhaustive: written as a literal with `..Paper::default()`.
pub struct Paper {
    /// Maximum number of photons; the radius shrinks to the farthest of them. ≥ 1.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::count"))]
    pub max: u32,
    /// Radius of the sphere S(P, r), user space, > 0; `None`: derived, as for the other estimators.
    pub radius: Option<f64>,
    /// With fewer photons than this the estimate is 0.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::count"))]
    pub threshold: u32,
    /// The scale factor `factor`.
    pub factor: f32,
    /// Whether the final colour is clamped to `[0, 1]`.
    pub clamp: bool,
}

impl Default for Paper {
    fn default() -> Self {
        Self { max: 200, radius: None, threshold: 8, factor: 1.0, clamp: true }
    }
}

/// How direct light is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Direct {
    /// By shadow rays to points on the lights (next-event estimation).
    #[default]
    Nee,
    /// From a photon map of direct light.
    Photons,
    /// Not at all: direct light is left out.
    None,
}

/// How indirect light, which has been scattered diffusely before, is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Indirect {
    /// Estimated directly from the global map.
    #[default]
    Map,
    /// By final gathering: estimated from the maps where rays from the query hit a surface (Jensen 1996).
    Gather,
    /// Not at all: indirect light is left out.
    None,
}

/// The area that an estimate's flux is divided by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Area {
    /// The whole disc, even where it extends past the edge of its surface: estimates are too dark there.
    #[default]
    Disc,
    /// The part of the disc that lies on the surface, estimated with a few dozen rays per query:
    /// [`crate::area`]. Final-gather rays find irradiance at every fourth photon, divided by the area there, or at as many
    /// as [`Settings::irradiance_every`] says; in scenes with vertex normals, and with error estimates, each ray has probes of
    /// its own, and a pass takes several times as long.
    Surface,
}

/// What the radius of an estimate depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Bandwidth {
    /// The map and the pass alone.
    #[default]
    Shared,
    /// The radius of map and pass, times a factor for each pixel that minimises the sum of noise and bias
    /// as measured in earlier passes. Passes then depend on which passes were rendered before. Requires
    /// [`Settings::errors`]; not available with [`Indirect::Gather`].
    PerPixel,
}

/// How paths are distributed over threads. The result is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
// Exhaustive: the CPU backend must implement each.
pub enum Scheduling {
    /// A fixed number of paths for each thread.
    Static,
    /// From a shared counter, so that all threads finish together.
    #[default]
    Dynamic,
}

/// Which random numbers are used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RandomKind {
    /// A counter-based generator: independent for every path and dimension.
    #[default]
    Counter,
    /// The linear congruential generator of Lin and Wang 2010, seeded with the path index.
    Lcg,
}

/// Which light paths fill the caustic map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum CausticPhotons {
    /// Aimed, if at most half of the light can meet mirrors, glass or glossy surfaces ([`crate::ProjectionMap::WORTH`]), and
    /// most of that light smooth ones, or if it is at most a twentieth of the light, where all light of an environment counts:
    /// [`Settings::photons`] times ten times the share that can, but at least a quarter as many and at most twice as many. If no
    /// other map is filled: as many, whatever the share. Otherwise [`CausticPhotons::Shared`].
    #[default]
    Auto,
    /// The paths that fill the other maps too.
    Shared,
    /// This many separate paths per pass, ≥ 1, aimed at mirrors and glass (a projection map).
    Aimed(u32),
}

/// Settings that a user chooses. Lengths are in user space.
///
/// With the feature `serde` they are read and written, for example as JSON: an object of fields, all of which are
/// optional. Choices are written as in the program's options (`"index": "morton"`, `"kernel": "constant"`,
/// `"caustic_photons": 100000`), estimators also with parameters (`"estimator": {"knn": {"k": 50}}`). An unknown field is
/// an error; ranges are checked by [`Settings::validate`], that is, by the renderer. `serde_json` reads numbers of more than
/// 15 digits with an error of one rounding, unless its feature `float_roundtrip` is on.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
// Exhaustive: written as a literal with `..Settings::default()`, which stays valid when fields are added.
pub struct Settings {
    /// Paths emitted per pass, ≥ 1.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::count"))]
    pub photons: u32,
    /// How radiance is estimated from photons.
    pub estimator: Estimator,
    /// Factor on derived radii, in `[1e-6, 1e6]`: below 1 for sharp caustics, above 1 for smooth light.
    pub radius_factor: f64,
    /// How photons are weighted by distance.
    pub kernel: Kernel,
    /// The area that an estimate's flux is divided by.
    pub area: Area,
    /// Whether all pixels share the radius of an estimate.
    pub bandwidth: Bandwidth,
    /// How photons are arranged for searching.
    pub index: IndexKind,
    /// How direct light is computed.
    pub direct: Direct,
    /// How indirect light is computed.
    pub indirect: Indirect,
    /// Whether light that reached a diffuse surface only by way of mirrors and glass is included.
    pub caustics: bool,
    /// Which light paths fill the caustic map.
    pub caustic_photons: CausticPhotons,
    /// `Some(r)`, r in `[0, 1]`: where every part of a glossy reflection (coat or metal, clearcoat, sheen) has at least the
    /// roughness r, it shows light of all lights that arrives by way of perfect mirrors or smooth glass from photons, in
    /// [`crate::Layer::Caustic`], where camera paths that follow the reflection would find it by chance, if the light is
    /// small. `None`: only light of point, spot and directional lights, which no camera path finds
    /// ([`crate::GlossCaustics`]). Without effect if [`Settings::caustics`] is false, and with [`Estimator::Paper`].
    pub caustic_roughness: Option<f32>,
    /// Maximum path length, counted in surfaces met, in `[1, 65536]`; for photon paths and camera paths. Light beyond it, and
    /// after too many total reflections ([`crate::most_total_reflections`]), is missing, and such paths are counted
    /// ([`crate::FilmTally`]); the default lets 40 panes of clear glass, one behind another, pass all of it.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::count"))]
    pub max_bounces: u32,
    /// Key of all random numbers.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::count"))]
    pub seed: u64,
    /// How fast radii shrink from pass to pass, in `(0, 1]`; 1: they do not shrink.
    pub alpha: f64,
    /// How paths are distributed over threads.
    pub scheduling: Scheduling,
    /// Which random numbers are used.
    pub random: RandomKind,
    /// Camera samples of each pixel in a pass, in `[1, 4096]`: camera paths from points that are spread evenly in the pixel, with
    /// direct light, whose mean counts as that of one. Photons are read for the first of them alone, so that many pay where little
    /// of the light is theirs.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::count"))]
    pub camera_samples: u32,
    /// Shadow rays per query and camera sample, in `[1, 4096]`.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::count"))]
    pub shadow_rays: u32,
    /// Final-gather rays per query and pass, in `[1, 4096]`.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::count"))]
    pub gather_rays: u32,
    /// `Some(n)`, n ≥ 1: irradiance is precomputed once per pass at the position of every n-th photon, and
    /// final-gather rays use the value of the nearest such point within half a radius (Christensen 1999), and else estimate
    /// from the maps. These estimates weight all photons within the radius equally. `None`: each final-gather ray
    /// estimates from the maps. Only with [`Indirect::Gather`], and not with [`Settings::errors`].
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::optional_count"))]
    pub irradiance_every: Option<u32>,
    /// A photon counts if the cosine between its surface's normal and the query's is at least this, in
    /// `[-1, 1]`.
    pub min_normal_cosine: f32,
    /// A photon counts if its distance from the query's plane is at most this share of the radius, in `(0,
    /// 1]`; 1: all photons in the ball count. Below 1, light of a nearby parallel surface does not leak
    /// through; with [`Area::Disc`], on a sphere with a radius of less than `radius / (2 share)`, photons near the edge of
    /// the disc are missed (Jensen 2001 flattens the search sphere likewise). Below 1 only with
    /// [`Estimator::Radius`]. `None`: [`Settings::plane_distance`].
    pub max_plane_distance: Option<f32>,
    /// Maximum number of photons per map; `None`: no limit.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::optional_count"))]
    pub photon_capacity: Option<u64>,
    /// Maximum number of bytes that backend and pipeline allocate for the scene, the picture and the
    /// photons; `None`: no limit. If necessary, passes have fewer photons than [`Settings::photons`], which
    /// [`crate::Facts`] reports: render more passes then.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serialized::optional_count"))]
    pub memory: Option<u64>,
    /// Whether the film stores the error statistics of each pixel: [`crate::ErrorPixel`]. Only with
    /// [`Estimator::Radius`]. The picture is the same.
    pub errors: bool,
    /// Whether camera rays that hit no surface see nothing in place of the environment; mirrors, glass and light are
    /// not affected. With [`crate::Film::alpha`], the picture can be put before another background.
    pub transparent_background: bool,
    /// Whether shadow rays from visible points of meshes with vertex normals start outside the mesh, so that coarse meshes
    /// do not shade themselves in blocks: [`crate::shadow_terminator`]. Light by photons then differs from light by shadow
    /// rays near the shadow terminator. Other scenes are not affected.
    pub terminator_offset: bool,
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
            caustic_roughness: None,
            max_bounces: 1024,
            seed: 0,
            alpha: 2.0 / 3.0,
            scheduling: Scheduling::default(),
            random: RandomKind::default(),
            camera_samples: 1,
            shadow_rays: 2,
            gather_rays: 16,
            irradiance_every: None,
            min_normal_cosine: 0.7,
            max_plane_distance: None,
            photon_capacity: None,
            memory: None,
            errors: false,
            transparent_background: false,
            terminator_offset: true,
        }
    }
}

impl Settings {
    /// [`Settings::max_plane_distance`], or its default: a quarter where discs are divided by the area that lies within, else 1.
    #[must_use]
    pub fn plane_distance(&self) -> f32 {
        let is_flat = self.area == Area::Surface && matches!(self.estimator, Estimator::Radius { .. });
        self.max_plane_distance.unwrap_or(if is_flat { 0.25 } else { 1.0 })
    }

    /// The settings of Lin and Wang 2010, including its errors: equation (2), the LCG, the median kd-tree,
    /// static scheduling.
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
            terminator_offset: false,
            ..Self::default()
        }
    }

    /// Checks the range of every setting, and combinations that exclude each other.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] names the first invalid setting.
    pub fn validate(&self) -> Result<()> {
        let ensure = |good: bool, name, value: String, hint| {
            if good { Ok(()) } else { Err(Error::InvalidSetting { name, value, hint }) }
        };
        let length = |name, radius: Option<f64>| match radius {
            Some(r) => ensure(r > 0.0 && r.is_finite(), name, number(r), "must be above 0 and finite"),
            None => Ok(()),
        };
        ensure(self.photons > 0, "photons", self.photons.to_string(), "at least 1 is needed")?;
        let factor = self.radius_factor;
        let hint = "must lie between 1e-6 and 1e6";
        ensure((1e-6..=1e6).contains(&factor), "radius-factor", number(factor), hint)?;
        let aimed = self.caustic_photons != CausticPhotons::Aimed(0);
        ensure(aimed, "caustic-photons", "0".into(), "at least 1 is needed; to leave caustics out, turn them off")?;
        if let Some(roughness) = self.caustic_roughness {
            let hint = "must lie between 0 and 1; without it, only lights without extent have photons for reflections";
            ensure((0.0..=1.0).contains(&roughness), "caustic-roughness", roughness.to_string(), hint)?;
        }
        match self.estimator {
            Estimator::Radius { radius } => length("radius", radius)?,
            Estimator::Knn { k, max_radius } => {
                ensure(k >= 2, "k", k.to_string(), "at least 2 are needed: the farthest photon only sets the radius")?;
                length("radius", max_radius)?;
            }
            Estimator::Paper(paper) => {
                ensure(paper.max >= 1, "k", paper.max.to_string(), "at least 1 is needed")?;
                length("radius", paper.radius)?;
                let good = (0.0..=1e6).contains(&paper.factor);
                ensure(good, "factor", paper.factor.to_string(), "must lie between 0 and 1e6")?;
            }
        }
        if self.errors && !matches!(self.estimator, Estimator::Radius { .. }) {
            return Err(Error::InvalidSetting {
                name: "errors",
                value: format!("enabled, with {:?}", self.estimator),
                hint: "errors are estimated by comparing two radii: use the radius estimator",
            });
        }
        if self.area == Area::Surface && matches!(self.estimator, Estimator::Paper(_)) {
            return Err(Error::InvalidSetting {
                name: "area",
                value: format!("surface, with {:?}", self.estimator),
                hint: "the paper's estimator divides by the area of its disc: use another estimator, or area disc",
            });
        }
        // Beyond these numbers, which nobody needs in one pass, a pass would not end.
        let count = |name, value: u32, most, hint| ensure((1..=most).contains(&value), name, value.to_string(), hint);
        count("max-bounces", self.max_bounces, 65_536, "must lie between 1 and 65536")?;
        let alpha = self.alpha;
        ensure(alpha > 0.0 && alpha <= 1.0, "alpha", number(alpha), "must be above 0 and at most 1")?;
        let hint = "must lie between 1 and 4096; for more samples, render more passes";
        count("camera-samples", self.camera_samples, 4096, hint)?;
        count("shadow-rays", self.shadow_rays, 4096, "must lie between 1 and 4096; for more rays, render more passes")?;
        count("gather-rays", self.gather_rays, 4096, "must lie between 1 and 4096; for more rays, render more passes")?;
        if self.bandwidth == Bandwidth::PerPixel {
            let hint = "needs errors to be enabled, and indirect light that is not computed by final gathering";
            ensure(self.errors && self.indirect != Indirect::Gather, "bandwidth", "per pixel".into(), hint)?;
        }
        if let Some(every) = self.irradiance_every {
            let name = "irradiance-every";
            ensure(every >= 1, name, every.to_string(), "at least 1 is needed")?;
            let gathers = self.indirect == Indirect::Gather;
            ensure(gathers, name, format!("{every}, with {:?}", self.indirect), "needs indirect gather")?;
            let hint = "does not support error estimates: turn one of the two off";
            ensure(!self.errors, name, format!("{every}, with errors"), hint)?;
        }
        let cosine = self.min_normal_cosine;
        ensure((-1.0..=1.0).contains(&cosine), "min-normal-cosine", cosine.to_string(), "must lie between -1 and 1")?;
        let plane = self.plane_distance();
        let hint = "must be above 0 and at most 1, and exactly 1 with estimators other than radius";
        let good = plane == 1.0 || (plane > 0.0 && plane < 1.0 && matches!(self.estimator, Estimator::Radius { .. }));
        ensure(good, "max-plane-distance", plane.to_string(), hint)?;
        Ok(())
    }
}

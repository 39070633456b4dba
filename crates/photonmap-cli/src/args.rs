//! The options of `render`.

use std::path::PathBuf;
use std::time::Duration;

use clap::Parser;
use photon_core::{
    Area, Bandwidth, Budget, CausticPhotons, Direct, Estimator, IndexKind, Indirect, Kernel, Paper, Plan, Preset,
    RandomKind, Settings, Sharing,
};

use crate::fault::Fault;
use crate::tonemap::ToneMap;

mod names;

pub use names::{
    AreaName, BackendName, BandwidthName, DirectName, EstimatorName, IndexName, IndirectName, PresetName, RngName,
    SharingName,
};

/// Passes where neither `--passes` nor `--time` says otherwise: a finished picture of the default
/// scene, well within a minute on two cores.
pub const PASSES: u32 = 32;

/// Renders a scene by photon mapping.
#[derive(Debug, Parser)]
#[command(name = "render", version, about)]
pub struct Args {
    /// A .gltf, .glb, .obj or .ply file, or the name of a built-in scene.
    #[arg(default_value = "cornell-glass")]
    pub scene: String,
    /// Picture to write, .exr or .png; may be given twice. Default: NAME.png in this folder.
    #[arg(short, long)]
    pub output: Vec<PathBuf>,
    /// List the built-in scenes.
    #[arg(long)]
    pub list: bool,
    /// List the devices that Vulkan offers, and what each lacks.
    #[arg(long)]
    pub devices: bool,
    /// Lights, materials and cameras that the file lacks (see docs/overrides.md).
    #[arg(long, value_name = "FILE.toml")]
    pub overrides: Option<PathBuf>,
    /// Where to render.
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    pub backend: BackendName,
    /// Pixels across and down.
    #[arg(long, value_name = "WxH", default_value = "512x512", value_parser = size)]
    pub size: (u32, u32),
    /// The camera of that name; default: the first.
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Settings for a need: photons by the picture's size, passes and radii; whatever else is given counts.
    #[arg(long, value_enum)]
    pub preset: Option<PresetName>,
    /// Paths emitted per pass; `k` and `M` are understood [default: 200k].
    #[arg(long, value_name = "N", value_parser = count)]
    pub photons: Option<u32>,
    /// Passes [default: 32, those of the preset, or as many as --time allows].
    #[arg(long, value_name = "N")]
    pub passes: Option<u32>,
    /// Paths emitted altogether, in whole passes; `k` and `M` are understood.
    #[arg(long, value_name = "N", value_parser = total)]
    pub total_photons: Option<u64>,
    /// Seconds from start to finish, as nearly as whole passes allow. Unless --passes, --radius or a budget is given,
    /// radii are adapted, and what the preset `final` says of --area and --bandwidth is the default.
    #[arg(long, value_name = "SECONDS")]
    pub time: Option<f64>,
    /// Stop when errors are claimed to be at most this fraction of a pixel's radiance, or of a tenth of the
    /// picture's mean where the pixel is darker; --passes and --time are then limits.
    #[arg(long, value_name = "E")]
    pub target_error: Option<f64>,
    /// In which share of the pixels of which anything is claimed.
    #[arg(long, value_name = "SHARE", default_value_t = 0.95)]
    pub share: f64,
    /// Tell the error of each pixel: stderr, bias, claimed and flag of an EXR. --target-error does so too.
    #[arg(long)]
    pub errors: bool,
    /// How photons become light.
    #[arg(long, value_enum, default_value_t = EstimatorName::Radius)]
    pub estimator: EstimatorName,
    /// Photons per estimate, for knn and paper [default: 50, paper 200].
    #[arg(long, value_name = "N")]
    pub k: Option<u32>,
    /// Search radius of the first pass, in the scene's unit of length [default: derived].
    #[arg(long, value_name = "R")]
    pub radius: Option<f64>,
    /// Factor on radii that are derived: below 1 for sharp caustics, above for smooth light [default: 1].
    #[arg(long, value_name = "F")]
    pub radius_factor: Option<f64>,
    /// constant, epanechnikov, cone, cone:SLOPE or biweight [default: epanechnikov, paper constant].
    #[arg(long, value_name = "NAME", value_parser = kernel)]
    pub kernel: Option<Kernel>,
    /// What their flux is divided by: the disc about a point, or what of it lies on the surface
    /// [default: disc, or by --preset or --time].
    #[arg(long, value_enum)]
    pub area: Option<AreaName>,
    /// How far from a point's plane they may lie, in radii: below 1 no other sheet shines through [default: 1].
    #[arg(long, value_name = "SHARE")]
    pub max_plane_distance: Option<f32>,
    /// Whose radius they have: one for a map, or one for each pixel, from its own noise and bias; the latter
    /// tells errors too [default: shared, or by --preset or --time].
    #[arg(long, value_enum)]
    pub bandwidth: Option<BandwidthName>,
    /// How photons are arranged.
    #[arg(long, value_enum)]
    pub index: Option<IndexName>,
    /// Light that was scattered before: read from the map, gathered, or left out [default: map].
    #[arg(long, value_enum)]
    pub indirect: Option<IndirectName>,
    /// Light straight from the lamps: by shadow rays, by photons, or left out.
    #[arg(long, value_enum, default_value_t = DirectName::Nee)]
    pub direct: DirectName,
    /// Paths per pass that are aimed at mirrors and glass, for caustics: a number, auto, or shared for none
    /// besides --photons [default: auto, paper shared].
    #[arg(long, value_name = "N", value_parser = caustic_photons)]
    pub caustic_photons: Option<CausticPhotons>,
    /// Surfaces that a path may meet [default: 64].
    #[arg(long, value_name = "N")]
    pub max_bounces: Option<u32>,
    /// Key of all random numbers.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Threads, on the CPU [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// How paths are shared out among threads [default: dynamic, paper static].
    #[arg(long, value_enum)]
    pub sharing: Option<SharingName>,
    /// Random numbers of photons [default: counter, paper lcg].
    #[arg(long, value_enum)]
    pub rng: Option<RngName>,
    /// Exposure of the PNG, in stops.
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true)]
    pub exposure: f32,
    /// Curve of the PNG.
    #[arg(long, value_enum, default_value_t = ToneMap::Neutral)]
    pub tonemap: ToneMap,
    /// Report to write; `-` for stdout.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Whatever a loader approximates or leaves out is an error.
    #[arg(long)]
    pub strict: bool,
    /// Most memory that the process may take, such as 2GiB: passes get smaller, and more.
    #[arg(long, value_name = "SIZE", value_parser = crate::memory::parse)]
    pub memory: Option<u64>,
    /// Say what the scene needs, what is left out and why, and render nothing.
    #[arg(long)]
    pub explain: bool,
    /// How fast radii shrink from pass to pass, above 0 and at most 1; 1 keeps them [default: 2/3].
    #[arg(long, value_name = "ALPHA")]
    pub alpha: Option<f64>,
    /// Shadow rays per query and pass [default: 2].
    #[arg(long, value_name = "N")]
    pub shadow_rays: Option<u32>,
    /// Final-gather rays per query and pass [default: 8].
    #[arg(long, value_name = "N")]
    pub gather_rays: Option<u32>,
    /// Find irradiance beforehand at every so-manieth photon, for final-gather rays to take the nearest's.
    #[arg(long, value_name = "N")]
    pub irradiance_every: Option<u32>,
    /// Least photons of an estimate, for paper.
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub paper_threshold: u32,
    /// Free scale of an estimate, for paper.
    #[arg(long, value_name = "F", default_value_t = 1.0)]
    pub paper_factor: f32,
}

impl Args {
    /// The library's settings.
    ///
    /// # Errors
    /// [`Fault::Input`] names the option whose value makes no sense.
    pub fn settings(&self) -> Result<Settings, Fault> {
        let paper = self.estimator == EstimatorName::Paper;
        let pixels = u64::from(self.size.0) * u64::from(self.size.1);
        let base = match self.preset() {
            Some(preset) => Settings::preset(preset, pixels),
            None if paper => Settings { gather_rays: 8, ..Settings::paper() },
            None => Settings { gather_rays: 8, ..Settings::default() },
        };
        let estimator = match self.estimator {
            EstimatorName::Radius => Estimator::Radius { radius: self.radius },
            EstimatorName::Knn => Estimator::Knn { k: self.k.unwrap_or(50), max_radius: self.radius },
            EstimatorName::Paper => Estimator::Paper(Paper {
                max: self.k.unwrap_or(200),
                radius: self.radius,
                threshold: self.paper_threshold,
                factor: self.paper_factor,
                clamp: true,
            }),
        };
        if paper && self.preset.is_some() {
            return Err(Fault::input("--preset: the paper has numbers of its own; leave out one of the two"));
        }
        if self.k == Some(0) {
            return Err(Fault::input("--k is 0, but at least 1 is needed (2 for knn)"));
        }
        if self.passes == Some(0) {
            return Err(Fault::input("--passes is 0, but at least 1 is needed"));
        }
        if self.time.is_some_and(|time| !(time > 0.0 && time.is_finite())) {
            let time = self.time.unwrap_or_default();
            return Err(Fault::input(format!("--time is {time}, but must be above 0 and finite")));
        }
        if !self.exposure.is_finite() {
            return Err(Fault::input(format!("--exposure is {}, but must be finite", self.exposure)));
        }
        // What is left of a time is spent best with radii that suit it, which the errors tell.
        let irradiance_every = self.irradiance_every.or(base.irradiance_every);
        let derived = matches!(estimator, Estimator::Radius { radius: None }) && irradiance_every.is_none();
        let adapts = derived && self.passes.is_none() && self.time.is_some();
        let indirect = self.indirect.map_or(base.indirect, |indirect| match indirect {
            IndirectName::Map => Indirect::Map,
            IndirectName::Gather => Indirect::Gather,
            IndirectName::None => Indirect::None,
        });
        // What is measured to be best in a time is what the last preset has.
        let timed = adapts && self.target_error.is_none() && self.total_photons.is_none() && self.preset.is_none();
        let kind = if timed { Settings::preset(Preset::Final, pixels) } else { base.clone() };
        let bandwidth = match self.bandwidth {
            Some(BandwidthName::Shared) => Bandwidth::Shared,
            Some(BandwidthName::PerPixel) => Bandwidth::PerPixel,
            // Light that is gathered elsewhere has no radius of the pixel's own, nor have the nearest photons.
            None if indirect == Indirect::Gather || !matches!(estimator, Estimator::Radius { .. }) => Bandwidth::Shared,
            None => kind.bandwidth,
        };
        let settings = Settings {
            errors: self.errors || self.target_error.is_some() || adapts || bandwidth == Bandwidth::PerPixel,
            photons: self.photons.unwrap_or(base.photons),
            estimator,
            radius_factor: self.radius_factor.unwrap_or(base.radius_factor),
            kernel: self.kernel.unwrap_or(base.kernel),
            index: self.index.map_or(base.index, |index| match index {
                IndexName::Median => IndexKind::Median,
                IndexName::Vvh => IndexKind::Vvh,
                IndexName::Morton => IndexKind::Morton,
            }),
            direct: match self.direct {
                DirectName::Nee => Direct::Nee,
                DirectName::Photons => Direct::Photons,
                DirectName::None => Direct::None,
            },
            indirect,
            bandwidth,
            area: self.area.map_or(kind.area, |area| match area {
                AreaName::Disc => Area::Disc,
                AreaName::Surface => Area::Surface,
            }),
            max_plane_distance: self.max_plane_distance.unwrap_or(base.max_plane_distance),
            caustic_photons: self.caustic_photons.unwrap_or(base.caustic_photons),
            max_bounces: self.max_bounces.unwrap_or(base.max_bounces),
            seed: self.seed,
            alpha: if paper { base.alpha } else { self.alpha.unwrap_or(base.alpha) },
            sharing: self.sharing.map_or(base.sharing, |sharing| match sharing {
                SharingName::Static => Sharing::Static,
                SharingName::Dynamic => Sharing::Dynamic,
            }),
            random: self.rng.map_or(base.random, |rng| match rng {
                RngName::Counter => RandomKind::Counter,
                RngName::Lcg => RandomKind::Lcg,
                RngName::Sobol => RandomKind::Sobol,
            }),
            shadow_rays: self.shadow_rays.unwrap_or(base.shadow_rays),
            gather_rays: self.gather_rays.unwrap_or(base.gather_rays),
            irradiance_every,
            ..base
        };
        settings.validate()?;
        self.plan(None).validate()?;
        Ok(settings)
    }

    /// The preset, if one is asked for.
    fn preset(&self) -> Option<Preset> {
        self.preset.map(|preset| match preset {
            PresetName::Preview => Preset::Preview,
            PresetName::Balanced => Preset::Balanced,
            PresetName::Final => Preset::Final,
        })
    }

    /// When to stop; `time` is what is left of `--time`.
    #[must_use]
    pub fn plan(&self, time: Option<Duration>) -> Plan {
        let until = match (self.target_error, self.total_photons, time, self.passes) {
            (Some(target), ..) => Budget::Error { target, share_of_pixels: self.share },
            (None, Some(photons), ..) => Budget::Photons(photons),
            (None, None, Some(time), _) => Budget::Time(time),
            (None, None, None, passes) => {
                Budget::Passes(passes.unwrap_or_else(|| self.preset().map_or(PASSES, Preset::passes)))
            }
        };
        Plan { first: 0, until, most_passes: self.passes, most_time: time }
    }
}

fn total(text: &str) -> Result<u64, String> {
    count(text).map(u64::from).or_else(|_| match text.parse::<u64>() {
        Ok(number) if number > 0 => Ok(number),
        _ => Err("give a whole number such as 200000000, 200k or 200M".to_owned()),
    })
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let parsed = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    let (width, height) = parsed.ok_or("give two whole numbers with an x between, such as 640x480")?;
    photon_core::check_size(width, height).map_err(|error| error.to_string())?;
    Ok((width, height))
}

fn count(text: &str) -> Result<u32, String> {
    let (digits, factor) = match text.strip_suffix(['k', 'K']) {
        Some(digits) => (digits, 1e3),
        None => text.strip_suffix(['m', 'M']).map_or((text, 1.0), |digits| (digits, 1e6)),
    };
    let number = digits.parse::<f64>().map_err(|_| "give a number such as 200000, 200k or 1.5M")? * factor;
    if number.fract() == 0.0 && (1.0..f64::from(u32::MAX)).contains(&number) {
        Ok(number as u32)
    } else {
        Err(format!("{number} is out of range: give a whole number from 1 to {}", u32::MAX - 1))
    }
}

fn caustic_photons(text: &str) -> Result<CausticPhotons, String> {
    match text {
        "auto" => Ok(CausticPhotons::Auto),
        "shared" => Ok(CausticPhotons::Shared),
        _ => count(text).map(CausticPhotons::Aimed).map_err(|why| format!("{why}; or auto, or shared")),
    }
}

fn kernel(text: &str) -> Result<Kernel, String> {
    let kernel = match text {
        "constant" => Kernel::Constant,
        "epanechnikov" => Kernel::Epanechnikov,
        "biweight" => Kernel::Biweight,
        "cone" => Kernel::Cone { slope: 1.0 },
        _ => {
            let slope = text.strip_prefix("cone:").and_then(|slope| slope.parse().ok());
            let slope = slope.filter(|slope: &f32| *slope >= 1.0 && slope.is_finite());
            let slope = slope
                .ok_or("choose constant, epanechnikov, cone, cone:SLOPE with a slope of at least 1, or biweight")?;
            Kernel::Cone { slope }
        }
    };
    Ok(kernel)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(arguments: &[&str]) -> Result<Settings, Fault> {
        let all = std::iter::once("render").chain(arguments.iter().copied());
        Args::try_parse_from(all).map_err(Fault::input)?.settings()
    }

    #[test]
    fn options_reach_the_settings() {
        let s = settings(&["--estimator", "knn", "--k", "70", "--photons", "1.5M", "--index", "vvh"]).unwrap();
        assert_eq!((s.photons, s.index), (1_500_000, IndexKind::Vvh));
        assert_eq!(s.estimator, Estimator::Knn { k: 70, max_radius: None });
        assert_eq!(settings(&["--max-plane-distance", "0.1"]).unwrap().max_plane_distance, 0.1);
        assert_eq!(settings(&["--caustic-photons", "50k"]).unwrap().caustic_photons, CausticPhotons::Aimed(50_000));
        assert_eq!(settings(&["--caustic-photons", "shared"]).unwrap().caustic_photons, CausticPhotons::Shared);
        assert_eq!(settings(&["--kernel", "cone:1.1"]).unwrap().kernel, Kernel::Cone { slope: 1.1 });
    }

    #[test]
    fn the_paper_brings_its_habits_unless_told_otherwise() {
        let s = settings(&["--estimator", "paper"]).unwrap();
        assert_eq!((s.random, s.sharing, s.index), (RandomKind::Lcg, Sharing::Static, IndexKind::Median));
        assert_eq!(s.caustic_photons, CausticPhotons::Shared);
        let s = settings(&["--estimator", "paper", "--rng", "counter", "--index", "morton"]).unwrap();
        assert_eq!((s.random, s.index), (RandomKind::Counter, IndexKind::Morton));
    }

    #[test]
    fn a_preset_is_overruled_by_what_is_given() {
        let expected = Settings::preset(Preset::Final, 64 * 32);
        let asked = ["--preset", "final", "--size", "64x32"];
        assert_eq!(settings(&asked).unwrap(), expected);
        let more = [&asked[..], &["--photons", "7k", "--indirect", "gather"]].concat();
        let shared = Settings { bandwidth: Bandwidth::Shared, errors: false, ..expected };
        let given = Settings { photons: 7000, indirect: Indirect::Gather, ..shared };
        assert_eq!(settings(&more).unwrap(), given);
        assert!(settings(&[&more[..], &["--bandwidth", "per-pixel"]].concat()).is_err());
        let nearest = settings(&[&asked[..], &["--estimator", "knn"]].concat()).unwrap();
        assert_eq!((nearest.bandwidth, nearest.errors, nearest.area), (Bandwidth::Shared, false, Area::Surface));
        assert_eq!(settings(&[&asked[..], &["--area", "disc"]].concat()).unwrap().area, Area::Disc);
        let args = Args::try_parse_from([&["render"], &asked[..]].concat()).unwrap();
        assert_eq!(args.plan(None).until, Budget::Passes(Preset::Final.passes()));
        assert!(settings(&["--preset", "final", "--estimator", "paper"]).is_err());
    }

    #[test]
    fn limits_and_targets_become_a_plan() {
        let plan =
            |arguments: &[&str], time| Args::try_parse_from([&["render"], arguments].concat()).unwrap().plan(time);
        assert_eq!(plan(&[], None).until, Budget::Passes(PASSES));
        let second = Some(Duration::from_secs(1));
        let timed = plan(&["--passes", "7"], second);
        assert_eq!((timed.until, timed.passes()), (Budget::Time(Duration::from_secs(1)), 7));
        let error = plan(&["--target-error", "0.05"], second);
        assert_eq!(error.until, Budget::Error { target: 0.05, share_of_pixels: 0.95 });
        assert_eq!((error.time(), error.passes()), (second, u32::MAX - 1));
        assert_eq!(plan(&["--total-photons", "3M"], None).until, Budget::Photons(3_000_000));
        assert!(settings(&["--errors"]).unwrap().errors && settings(&["--target-error", "0.1"]).unwrap().errors);
    }

    #[test]
    fn a_time_is_spent_as_was_measured_to_be_best() {
        let of = |arguments: &[&str]| {
            let s = settings(&[&["--time", "5"], arguments].concat()).unwrap();
            (s.area, s.bandwidth)
        };
        assert_eq!(of(&[]), (Area::Surface, Bandwidth::PerPixel));
        assert_eq!(of(&["--indirect", "gather"]), (Area::Surface, Bandwidth::Shared));
        assert_eq!(of(&["--area", "disc"]), (Area::Disc, Bandwidth::PerPixel));
        assert_eq!(of(&["--bandwidth", "shared"]), (Area::Surface, Bandwidth::Shared));
        for given in [
            ["--target-error", "0.1"],
            ["--total-photons", "1M"],
            ["--preset", "preview"],
            ["--passes", "7"],
            ["--radius", "0.1"],
        ] {
            assert_eq!(of(&given), (Area::Disc, Bandwidth::Shared), "{given:?}");
        }
        assert!(settings(&["--time", "5"]).unwrap().errors);
    }

    #[test]
    fn absurd_values_are_refused() {
        for bad in [
            vec!["--k", "0"],
            vec!["--estimator", "knn", "--k", "1"],
            vec!["--radius", "0"],
            vec!["--radius", "inf"],
            vec!["--radius=-1"],
            vec!["--radius-factor", "0"],
            vec!["--photons", "0"],
            vec!["--caustic-photons", "0"],
            vec!["--caustic-photons", "many"],
            vec!["--photons", "1.5"],
            vec!["--size", "0x0"],
            vec!["--size", "12"],
            vec!["--passes", "0"],
            vec!["--time", "0"],
            vec!["--time", "nan"],
            vec!["--target-error", "0"],
            vec!["--target-error", "nan"],
            vec!["--target-error", "0.1", "--share", "1.5"],
            vec!["--target-error", "0.1", "--estimator", "knn"],
            vec!["--total-photons", "0"],
            vec!["--kernel", "box"],
            vec!["--kernel", "cone:0.5"],
            vec!["--alpha", "0"],
            vec!["--max-plane-distance", "0"],
            vec!["--max-bounces", "0"],
            vec!["--exposure", "nan"],
            vec!["--backend", "cuda"],
        ] {
            assert!(settings(&bad).is_err(), "{bad:?}");
        }
    }
}

//! The options of `photonmap render` and `photonmap explain`, in the groups that `--help` shows.
//!
//! Options marked `hide_short_help` are listed only by `--help`; `-h` shows what a first picture needs. Those marked
//! `hide_long_help`, too, are described in the manual page, and named by `--set`.

use std::path::PathBuf;

use clap::Args;
use photon_core::{
    Area, Bandwidth, CausticPhotons, Direct, Estimator, IndexKind, Indirect, Kernel, Preset, RandomKind, Scheduling,
    View,
};
use photon_scene::{LightUnits, Scene, SceneError, ThinLens};

use super::environment::EnvironmentArgs;
use super::values::{PassRange, caustic_photons, choice, count, light_units, passes, seconds, size, total, whole};
use crate::backend::BackendName;
use crate::exposure::Exposure;
use crate::tonemap::ToneMap;

/// The scene to render.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Scene")]
pub struct SceneArgs {
    /// A .gltf, .glb, .obj, .ply or .stl file, or the name of a built-in scene.
    #[arg(default_value = "cornell-glass")]
    pub scene: String,
    /// File with lights, materials and cameras to add or change (see docs/scene-files.md), or `auto`.
    ///
    /// `auto` writes one to begin with beside the scene file, named as it but with the extension .toml: all materials and
    /// cameras with their values, commented out. A file of that name is not overwritten, but an error.
    #[arg(long, value_name = "FILE.toml|auto")]
    pub overrides: Option<PathBuf>,
    /// Units of the lights of a glTF file, other than surfaces: `standard` for cd and lux, as Blender exports by default
    /// (they are divided by 683 lm/W), or `unitless` for W/sr and W/m² [default: that of the override file, else unitless].
    #[arg(long, value_name = "UNITS", value_parser = light_units(), hide_short_help = true, hide_long_help = true)]
    pub light_units: Option<LightUnits>,
    /// Light from infinitely far away.
    #[command(flatten)]
    pub environment: EnvironmentArgs,
    /// Treat everything that is approximated, assumed or left out as an error.
    #[arg(long, hide_short_help = true)]
    pub strict: bool,
}

/// Size and camera of the picture.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Picture")]
pub struct PictureArgs {
    /// Width and height in pixels, or the side of a square.
    #[arg(long, value_name = "WxH|N", default_value = "512x512", value_parser = size)]
    pub size: (u32, u32),
    /// Name of the camera [default: the scene's first].
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Diameter of the lens of a perspective camera, in units of the scene; 0 is a pinhole [default: that of the camera].
    ///
    /// What is not at the distance of --focus is blurred: at distance z to a disc of the diameter
    /// `DIAMETER · |z - DISTANCE| / DISTANCE`.
    #[arg(
        long,
        value_name = "DIAMETER",
        requires = "focus",
        allow_negative_numbers = true,
        hide_short_help = true,
        hide_long_help = true
    )]
    pub aperture: Option<f64>,
    /// Distance along the direction of view of the plane that is in focus, in units of the scene.
    #[arg(
        long,
        value_name = "DISTANCE",
        requires = "aperture",
        allow_negative_numbers = true,
        hide_short_help = true,
        hide_long_help = true
    )]
    pub focus: Option<f64>,
}

/// The output files.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct OutputArgs {
    /// Picture to write, .exr or .png; may be given more than once [default: SCENE.png in the current folder; with --film
    /// none].
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Exposure of the PNG, in stops, or `auto`.
    ///
    /// `auto` makes the mean of the logarithm of the luminance that of a grey of 18 %: of the pixels at least half
    /// covered by surfaces (all, if there are none) and not black, without the darkest and the brightest tenth. It is
    /// printed. An EXR is not affected.
    #[arg(long, value_name = "EV|auto", default_value = "auto", allow_negative_numbers = true)]
    pub exposure: Exposure,
    /// Tone curve of the PNG.
    #[arg(long, value_enum, default_value_t = ToneMap::Neutral, hide_short_help = true)]
    pub tonemap: ToneMap,
    /// Make the background transparent: alpha is the share of camera rays that hit a surface.
    ///
    /// An environment still lights the scene, but is seen in mirrors and through glass alone. In an EXR, channel A is added,
    /// and colours are premultiplied; in a PNG, they are not.
    #[arg(long, hide_short_help = true)]
    pub transparent: bool,
    /// Denoise the finished picture by Open Image Denoise 2 (to install it: pip install pyoidn).
    ///
    /// It is guided by albedos and normals. With --errors, the mean of red, green and blue stays within the claimed error of
    /// the pixel, where there is one. An EXR says so; its layers are not denoised.
    #[arg(long, conflicts_with = "transparent")]
    pub denoise: bool,
    /// Write a report in JSON: counters, times, memory, warnings; `-` for standard output.
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    pub json: Option<PathBuf>,
}

/// Quality of the picture, and stopping criteria.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Quality and time")]
pub struct BudgetArgs {
    /// Settings for a purpose: a quick look, everyday work, or a finished picture. Options given explicitly take
    /// precedence.
    ///
    /// `preview` makes four passes, or with --backend cpu as many as end within two seconds from the start, at least one; not
    /// with --film or --grain, where it makes four.
    #[arg(long, value_parser = choice::<Preset>(Preset::ALL.map(Preset::name)))]
    pub preset: Option<Preset>,
    /// Number of passes, or a range such as 64..128 [default: 32, that of the preset, or as many as --time allows].
    ///
    /// Passes depend on their index alone: ranges can be rendered on several machines (see --film and `photonmap merge`).
    #[arg(long, value_name = "N|A..B", value_parser = passes)]
    pub passes: Option<PassRange>,
    /// Time limit in seconds, or such as 5min, from start to finished file.
    ///
    /// Passes are rendered until the time is used up.
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_negative_numbers = true)]
    pub time: Option<f64>,
    /// Stop at this relative error, such as 0.05.
    ///
    /// The error is an estimated bound for each pixel, relative to its radiance, or to a tenth of the picture's mean
    /// where the pixel is darker. --passes and --time are then upper limits.
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    pub target_error: Option<f64>,
    /// Fraction of the pixels with an error estimate that must reach --target-error.
    #[arg(long, value_name = "FRACTION", default_value_t = 0.95, hide_short_help = true, hide_long_help = true)]
    pub share: f64,
    /// Total number of photon paths, in whole passes; the suffixes `k` and `M` are accepted.
    #[arg(long, value_name = "N", value_parser = total, hide_short_help = true, hide_long_help = true)]
    pub total_photons: Option<u64>,
    /// Estimate the error of each pixel: channels stderr, bias, claimed and flag of an EXR. Implied by
    /// --target-error.
    #[arg(long, hide_short_help = true)]
    pub errors: bool,
}

/// How photons are traced.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Photons")]
pub struct PhotonArgs {
    /// Photon paths emitted per pass; the suffixes `k` and `M` are accepted [default: half a path
    /// per pixel, or that of --preset, --time or --target-error].
    #[arg(long, value_name = "N", value_parser = count, hide_short_help = true)]
    pub photons: Option<u32>,
    /// Paths per pass aimed at mirrors and glass by a projection map, for caustics: a number, `auto`, or `shared` for
    /// no paths besides --photons [default: auto, with --estimator paper shared].
    #[arg(long, value_name = "N", value_parser = caustic_photons, hide_short_help = true, hide_long_help = true)]
    pub caustic_photons: Option<CausticPhotons>,
    /// Reflections at least this rough (0 to 1) show caustics of area lights and environments from photons, instead of by
    /// chance [default: none do; those of point, spot and directional lights are always from photons].
    #[arg(long, value_name = "R", hide_short_help = true, hide_long_help = true)]
    pub caustic_roughness: Option<f32>,
    /// Maximum length of a path, in surface hits [default: 1024].
    #[arg(long, value_name = "N", value_parser = whole, hide_short_help = true, hide_long_help = true)]
    pub max_bounces: Option<u32>,
    /// Seed of all random numbers: the same seed gives the same picture.
    #[arg(long, value_name = "N", default_value_t = 0, hide_short_help = true, hide_long_help = true)]
    pub seed: u64,
    /// Random number generator of photons: counter-based, or the linear congruential generator of Lin and Wang 2010 [default: counter, with --estimator paper lcg].
    #[arg(long, value_parser = choice::<RandomKind>(RandomKind::ALL.map(RandomKind::name)), hide_short_help = true, hide_long_help = true)]
    pub rng: Option<RandomKind>,
    /// How paths are scheduled on threads: static quotas, or a shared counter (dynamic); the picture is the same
    /// [default: dynamic, with --estimator paper static].
    #[arg(long, alias = "sharing", value_parser = choice::<Scheduling>(Scheduling::ALL.map(Scheduling::name)), hide_short_help = true, hide_long_help = true)]
    pub scheduling: Option<Scheduling>,
}

/// How radiance is estimated from photons.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Density estimation")]
pub struct EstimateArgs {
    /// Radiance estimate: all photons within a radius that shrinks from pass to pass, the k nearest, or equation (2)
    /// of Lin and Wang 2010.
    #[arg(long, default_value = "radius", value_parser = choice::<Estimator>(Estimator::NAMES), hide_short_help = true, hide_long_help = true)]
    pub estimator: Estimator,
    /// Photons per estimate, for knn and paper [default: 50, paper 200].
    #[arg(long, value_name = "N", value_parser = whole, hide_short_help = true, hide_long_help = true)]
    pub k: Option<u32>,
    /// Search radius of the first pass, in the scene's unit of length [default: from the photon density].
    #[arg(long, value_name = "R", hide_short_help = true, hide_long_help = true)]
    pub radius: Option<f64>,
    /// Factor on derived radii: below 1 for sharper caustics, above 1 for smoother light [default: 1].
    #[arg(long, value_name = "F", hide_short_help = true, hide_long_help = true)]
    pub radius_factor: Option<f64>,
    /// How fast radii shrink from pass to pass, above 0 and at most 1; 1 keeps them constant [default: 2/3].
    #[arg(long, value_name = "ALPHA", hide_short_help = true, hide_long_help = true)]
    pub alpha: Option<f64>,
    /// Weight of photons by distance [default: epanechnikov, with --estimator paper constant].
    #[arg(long, value_parser = choice::<Kernel>(Kernel::ALL.map(Kernel::name)), hide_short_help = true, hide_long_help = true)]
    pub kernel: Option<Kernel>,
    /// Area that the flux is divided by: the disc around the point, or the part of it that lies on the surface, which
    /// removes dark edges [default: surface; disc with --preset preview or --estimator paper].
    #[arg(long, value_parser = choice::<Area>(Area::ALL.map(Area::name)), hide_short_help = true, hide_long_help = true)]
    pub area: Option<Area>,
    /// One radius for each photon map, or one for each pixel from its own noise and bias, which also estimates errors
    /// [default: shared, or that of --preset or --time].
    #[arg(long, value_parser = choice::<Bandwidth>(Bandwidth::ALL.map(Bandwidth::name)), hide_short_help = true, hide_long_help = true)]
    pub bandwidth: Option<Bandwidth>,
    /// Largest distance of a photon from the tangent plane, in radii; values below 1 keep light from leaking through
    /// thin walls [default: 0.25 with --area surface and --estimator radius, else 1].
    #[arg(long, value_name = "F", hide_short_help = true, hide_long_help = true)]
    pub max_plane_distance: Option<f32>,
    /// Data structure of the photon map: left-balanced kd-tree, kd-tree by the Voxel Volume Heuristic, or Morton
    /// order [default: morton, with --estimator paper median].
    #[arg(long, value_parser = choice::<IndexKind>(IndexKind::ALL.map(IndexKind::name)), hide_short_help = true, hide_long_help = true)]
    pub index: Option<IndexKind>,
    /// With --estimator paper: minimum number of photons of an estimate.
    #[arg(long, value_name = "N", default_value_t = 8, hide_short_help = true, hide_long_help = true)]
    pub paper_threshold: u32,
    /// With --estimator paper: its free scale factor.
    #[arg(long, value_name = "F", default_value_t = 1.0, hide_short_help = true, hide_long_help = true)]
    pub paper_factor: f32,
}

/// Which light is computed, and how.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Direct and indirect light")]
pub struct LightArgs {
    /// Direct light: by shadow rays (next event estimation), from a photon map, or none.
    #[arg(long, default_value = "nee", value_parser = choice::<Direct>(Direct::ALL.map(Direct::name)), hide_short_help = true, hide_long_help = true)]
    pub direct: Direct,
    /// Indirect light: from the global photon map, by final gathering, or none [default: map].
    #[arg(long, value_parser = choice::<Indirect>(Indirect::ALL.map(Indirect::name)), hide_short_help = true)]
    pub indirect: Option<Indirect>,
    /// Camera paths with direct light per pixel and pass, up to 4096; photons are read for the first alone [default: 1].
    #[arg(long, value_name = "N", value_parser = whole, hide_short_help = true, hide_long_help = true)]
    pub camera_samples: Option<u32>,
    /// Shadow rays per visible point and camera path [default: 2].
    #[arg(long, value_name = "N", value_parser = whole, hide_short_help = true, hide_long_help = true)]
    pub shadow_rays: Option<u32>,
    /// Start shadow rays at the triangles of meshes with vertex normals, not outside the mesh.
    ///
    /// Coarse meshes then have a blocky edge of the shadow on their own dark side, as light by photons has.
    #[arg(long, hide_short_help = true, hide_long_help = true)]
    pub no_terminator_offset: bool,
    /// Final-gather rays per visible point and pass [default: 16].
    #[arg(long, value_name = "N", value_parser = whole, hide_short_help = true, hide_long_help = true)]
    pub gather_rays: Option<u32>,
    /// Precompute irradiance at every N-th photon, for final-gather rays to look up.
    #[arg(long, value_name = "N", value_parser = whole, hide_short_help = true, hide_long_help = true)]
    pub irradiance_every: Option<u32>,
}

/// Backend, threads and memory.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Machine")]
pub struct MachineArgs {
    /// Backend that computes.
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    pub backend: BackendName,
    /// Vulkan devices: indices or parts of names as in `photonmap devices`, separated by commas, or `all` for all GPUs.
    ///
    /// Several devices render blocks of --grain passes. If they are of one kind, the picture does not depend on their number.
    /// Passes are then given by --passes, --total-photons or --target-error, as with --film.
    #[arg(long, value_name = "A,B,…|all", value_delimiter = ',', hide_short_help = true)]
    pub device: Vec<String>,
    /// Number of threads on the CPU [default: all cores].
    #[arg(long, value_name = "N", hide_short_help = true)]
    pub threads: Option<usize>,
    /// Limit on the memory of the process, such as 2GiB; passes then have fewer photons, and there are more passes.
    ///
    /// Loading may use half of the limit less the picture, or without a limit, half of the memory that is available. Textures that
    /// do not fit are halved, which is reported; if that is not enough, loading fails.
    #[arg(long, value_name = "SIZE", value_parser = crate::memory::parse, hide_short_help = true)]
    pub memory: Option<u64>,
}

impl MachineArgs {
    /// Whether `--device` may choose several devices.
    pub(crate) fn several(&self) -> bool {
        self.device.len() > 1 || self.device == ["all"]
    }
}

impl PictureArgs {
    /// The camera of a scene, with the lens of the options.
    ///
    /// # Errors
    /// [`SceneError`] for an unknown camera or a lens out of range.
    pub fn view(&self, scene: &Scene) -> Result<View, SceneError> {
        let ((width, height), name) = (self.size, self.camera.as_deref());
        let camera = match self.aperture.zip(self.focus) {
            Some((diameter, focus_distance)) => {
                scene.camera_with_lens(name, ThinLens::new(diameter, focus_distance), width, height)?
            }
            None => scene.camera(name, width, height)?,
        };
        Ok(View { camera, width, height })
    }
}

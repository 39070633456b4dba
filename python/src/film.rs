//! Films, with what their passes depend on.

use std::io::Cursor;
use std::path::Path;

use numpy::{IntoPyArray, PyArray1};
use photon_image::denoise::Denoiser;
use photon_image::exposure::{Exposure, measured};
use photon_image::png_file::{self, Picture};
use photon_image::tonemap::ToneMap;
use photon_image::{atomic_write, exr_file};
use photonmap::film::{FilmInfo, load, load_from, save, save_to};
use photonmap::{Blocks, ErrorTarget, Film, FilmTally, Layer, MapKind, Tally};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::Failure;
use crate::settings::parse;

/// Sums of passes.
#[pyclass(module = "photonmap._photonmap")]
pub(crate) struct RawFilm {
    pub(crate) film: Film,
    pub(crate) info: FilmInfo,
    /// Why it cannot be stored as a film file.
    pub(crate) refused: Option<String>,
}

/// The tone curves, by name.
const CURVES: [(&str, ToneMap); 5] = [
    ("none", ToneMap::None),
    ("reinhard", ToneMap::Reinhard),
    ("aces", ToneMap::Aces),
    ("neutral", ToneMap::Neutral),
    ("agx", ToneMap::Agx),
];

/// Name of a film in memory, in messages.
const IN_MEMORY: &str = "film in memory";

#[pymethods]
impl RawFilm {
    /// Reads a film file.
    #[staticmethod]
    fn load(py: Python<'_>, path: &str) -> PyResult<Self> {
        let (film, info) = py.detach(|| load(Path::new(path)).map_err(Failure::from))?;
        Ok(Self { film, info, refused: None })
    }

    /// Reads the bytes of a film file.
    #[staticmethod]
    fn from_bytes(bytes: &[u8], refused: Option<String>) -> PyResult<Self> {
        let read = load_from(Cursor::new(bytes), bytes.len() as u64, Path::new(IN_MEMORY));
        let (film, info) = read.map_err(Failure::from)?;
        Ok(Self { film, info, refused })
    }

    /// The bytes of a film file, and why it must not be stored as one.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyBytes>, Option<String>)> {
        let mut bytes = Cursor::new(Vec::new());
        save_to(&mut bytes, &self.film, &self.info, Path::new(IN_MEMORY)).map_err(Failure::from)?;
        Ok((PyBytes::new(py, bytes.get_ref()), self.refused.clone()))
    }

    #[getter]
    fn width(&self) -> u32 {
        self.film.width
    }

    #[getter]
    fn height(&self) -> u32 {
        self.film.height
    }

    #[getter]
    fn passes(&self) -> u32 {
        self.film.passes
    }

    /// The passes: seed, first, end.
    fn ranges(&self) -> Vec<(u64, u32, u32)> {
        self.film.contains.ranges().map(|(seed, range)| (seed, range.start, range.end)).collect()
    }

    /// Whether its only pass was cut short.
    #[getter]
    fn cut(&self) -> bool {
        self.film.cut
    }

    /// Radii of the first pass.
    fn radii(&self) -> Vec<f32> {
        self.info.key.radii()
    }

    /// Passes of a block.
    #[getter]
    fn grain(&self) -> u32 {
        self.info.key.grain()
    }

    /// Names of the backends that rendered it.
    fn backends(&self) -> Vec<String> {
        self.info.makers.iter().map(|maker| maker.backend.clone()).collect()
    }

    /// Fates of the paths: number of passes that were counted, paths that were not aimed, aimed ones, photons stored in maps,
    /// truncated camera paths.
    #[expect(clippy::type_complexity, reason = "taken apart by one method")]
    fn counts(&self) -> (u32, Vec<(&'static str, u64)>, Vec<(&'static str, u64)>, Vec<(&'static str, u64)>, u64) {
        let FilmTally { passes, photons, aimed, truncated_camera_paths, .. } = &self.film.tally;
        let of = |tally: &Tally| {
            vec![
                ("emitted", tally.emitted),
                ("absorbed", tally.absorbed),
                ("escaped", tally.escaped),
                ("terminated", tally.terminated),
                ("truncated", tally.truncated),
                ("dropped", tally.dropped),
            ]
        };
        let stored = self.film.tally.stored();
        let stored = MapKind::ALL.iter().map(|kind| (kind.name(), stored[*kind])).collect();
        (*passes, of(photons), of(aimed), stored, *truncated_camera_paths)
    }

    /// A layer, `beauty`, `normal` or `albedo`: rows of pixels from the top, RGB or XYZ, flat.
    fn colors<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let layer = Layer::ALL.into_iter().find(|layer| layer.name() == name);
        let values = match (layer, name) {
            (Some(layer), _) => self.film.layer(layer),
            (None, "beauty") => self.film.beauty(),
            (None, "normal") => self.film.normal(),
            (None, "albedo") => self.film.albedo(),
            (None, other) => return Err(Failure::input(format!("a film has no layer {other:?}")).into()),
        };
        Ok(values.into_flattened().into_pyarray(py))
    }

    /// `error`, `alpha` or `depth`; flat.
    fn numbers<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let values = match name {
            "error" => self.film.standard_error(),
            "alpha" => self.film.alpha(),
            "depth" => self.film.depth(),
            other => return Err(Failure::input(format!("a film has no numbers {other:?}")).into()),
        };
        Ok(values.into_pyarray(py))
    }

    /// Half the width of the confidence interval of each pixel; infinite where there is no estimate. `None` without error
    /// statistics.
    fn bounds<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f32>>> {
        let intervals = self.film.confidence_intervals()?;
        Some(intervals.iter().map(|interval| interval.half_width as f32).collect::<Vec<_>>().into_pyarray(py))
    }

    /// Adds the next block, of the same render.
    fn merge(&mut self, py: Python<'_>, other: &Self) -> PyResult<()> {
        py.detach(|| {
            other.info.check(&self.info.key, &self.info.scene, Path::new("block")).map_err(Failure::from)?;
            self.film.merge(&other.film)?;
            other.info.makers.iter().for_each(|maker| self.info.add_maker(maker));
            let backend = self.info.makers.first().map(|maker| maker.backend.clone());
            self.info.in_order &=
                other.info.in_order && self.info.makers.iter().all(|maker| Some(&maker.backend) == backend.as_ref());
            self.info.contains = self.film.contains.clone();
            Ok::<_, Failure>(())
        })?;
        Ok(())
    }

    /// The blocks of passes `first..end` that remain after this film: the next pass. `path` is for messages.
    fn next_pass(&self, first: u32, end: u32, grain: u32, seed: u64, path: &str) -> PyResult<u32> {
        next(Blocks::new(first..end, grain), Some(&self.film), seed)
            .map_err(|error| Failure::input(format!("{path}: {error}")).into())
    }

    /// Whether the film of blocks of `grain` passes is to be examined now, and the error of this share of the pixels is at most
    /// `target`.
    fn is_reached(&self, py: Python<'_>, settings: &str, target: f64, share: f64, grain: u32) -> PyResult<bool> {
        let settings = parse(settings)?;
        Ok(py.detach(|| {
            let target = ErrorTarget::new(target, share, &settings)?;
            let forecast = target.examine(&self.film, grain, self.film.passes, 0.0).map_err(Failure::from)?;
            Ok::<_, Failure>(forecast.is_some_and(|forecast| forecast.is_reached()))
        })?)
    }

    /// Raises an error unless a film can be continued by the passes of `other`.
    fn check_key(&self, other: &Self, path: &str) -> PyResult<()> {
        Ok(self.info.check(&other.info.key, &other.info.scene, Path::new(path)).map_err(Failure::from)?)
    }

    /// Writes a film file.
    fn save(&self, py: Python<'_>, path: &str) -> PyResult<()> {
        if let Some(why) = &self.refused {
            return Err(Failure::input(format!("{path}: {why}")).into());
        }
        Ok(py.detach(|| save(Path::new(path), &self.film, &self.info).map_err(Failure::from))?)
    }

    /// The denoised picture, flat; `environment`: the folder of the running Python, where the denoiser may be installed.
    fn denoised<'py>(&self, py: Python<'py>, environment: &str) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let (colors, _) = py.detach(|| self.shown(Some(environment)))?;
        Ok(colors.into_flattened().into_pyarray(py))
    }

    /// Writes an EXR; denoised if there is an `environment`, see [`Self::denoised`].
    fn save_exr(&self, py: Python<'_>, path: &str, environment: Option<&str>) -> PyResult<()> {
        let settings: Vec<String> = self.info.key.settings().map(|(name, value)| format!("{name}: {value}")).collect();
        let makers: Vec<&str> = self.info.makers.iter().map(|maker| maker.device.as_str()).collect();
        let attributes = [
            ("photon:scene", self.info.scene.clone()),
            ("photon:passes", self.film.contains.to_string()),
            ("photon:photons_per_pass", self.info.key.photons().to_string()),
            ("photon:settings", settings.join(", ")),
            ("photon:device", makers.join(", ")),
        ];
        let mut attributes = attributes.map(|(name, value)| (name.to_owned(), value)).to_vec();
        Ok(py.detach(|| {
            let (colors, note) = self.shown(environment)?;
            attributes.extend(note.map(|note| ("photon:denoised".to_owned(), note)));
            let written = exr_file::write_as(Path::new(path), &self.film, colors, self.is_transparent(), &attributes);
            written.map_err(Failure::from)
        })?)
    }

    /// The bytes of a PNG; exposure in stops, `None`: automatic; denoised as an EXR.
    fn png<'py>(
        &self,
        py: Python<'py>,
        exposure: Option<f32>,
        curve: &str,
        environment: Option<&str>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        if exposure.is_some_and(|stops| !stops.is_finite()) {
            return Err(Failure::input("exposure must be finite, or None for an automatic one").into());
        }
        let known = CURVES.iter().find(|(name, _)| *name == curve);
        let Some((_, curve)) = known else {
            let names = CURVES.map(|(name, _)| name).join(", ");
            return Err(Failure::input(format!("tonemap is {curve:?}, but must be one of {names}")).into());
        };
        let bytes = py.detach(|| {
            let (colors, _) = self.shown(environment)?;
            let picture = Picture::of(&self.film, colors, self.is_transparent());
            let exposure = exposure.map_or(Exposure::Auto, Exposure::Stops);
            let stops = exposure.stops(&measured(&picture.colours, &self.film.alpha()));
            let mut bytes = Vec::new();
            let encoded = png_file::encode(&mut bytes, &picture, *curve, stops);
            encoded.map(|()| bytes).map_err(|why| Failure::device(format!("the PNG cannot be encoded: {why}")))
        })?;
        Ok(PyBytes::new(py, &bytes))
    }
}

impl RawFilm {
    fn is_transparent(&self) -> bool {
        self.info.key.settings().any(|setting| setting == ("transparent_background", "true"))
    }

    /// The colours of a picture, and how they were denoised, if there is an environment of Python.
    fn shown(&self, environment: Option<&str>) -> Result<(Vec<[f32; 3]>, Option<String>), Failure> {
        let Some(environment) = environment else { return Ok((self.film.beauty(), None)) };
        if self.is_transparent() {
            return Err(Failure::input("films with a transparent background cannot be denoised"));
        }
        let denoiser = Denoiser::load_from(Some(Path::new(environment)));
        // Neither the film nor an argument is wrong.
        let denoised = denoiser.and_then(|library| library.denoise(&self.film));
        denoised.map(|denoised| (denoised.pixels, Some(denoised.note))).map_err(|why| Failure::device(why.to_string()))
    }
}

/// The next pass after a film, or the end of the range if it has all.
fn next(blocks: photonmap::Result<Blocks>, film: Option<&Film>, seed: u64) -> photonmap::Result<u32> {
    let blocks = blocks?;
    let Some(film) = film else { return Ok(blocks.passes().start) };
    Ok(blocks.remaining(&film.contains, seed)?.map_or(blocks.passes().end, |rest| rest.passes().start))
}

/// Checks a range of passes and their grain.
#[pyfunction]
pub(crate) fn check_blocks(first: u32, end: u32, grain: u32) -> PyResult<()> {
    next(Blocks::new(first..end, grain), None, 0).map(drop).map_err(|error| Failure::from(error).into())
}

/// Checks that a file can be written, before anything is rendered.
#[pyfunction]
pub(crate) fn check_writable(path: &str) -> PyResult<()> {
    Ok(atomic_write::check(Path::new(path)).map_err(|fault| Failure::file(fault.to_string()))?)
}

/// Writes bytes atomically.
#[pyfunction]
pub(crate) fn write_bytes(path: &str, bytes: &[u8]) -> PyResult<()> {
    Ok(atomic_write::write_bytes(Path::new(path), bytes).map_err(Failure::from)?)
}

//! Films: sums over passes.

use std::ffi::c_char;
use std::path::Path;

use photon_image::denoise::Denoiser;
use photon_image::exposure::{Exposure, measured};
use photon_image::png_file::Picture;
use photon_image::tonemap::ToneMap;
use photon_image::{exr_file, png_file};
use photonmap::film::{self as files, FilmFileError, FilmInfo};
use photonmap::{ConfidenceInterval, Film, Layer};

use crate::error::{Fault, PmStatus, Result, call, free};
use crate::pointer;

/// The picture: radiance, W/(m² sr), linear RGB. The sum of the four layers below. 3 numbers a pixel.
pub const PM_LAYER_PICTURE: u32 = 0;
/// Lights that are seen directly, or by way of mirrors and glass alone. 3 numbers a pixel.
pub const PM_LAYER_EMISSION: u32 = 1;
/// Light that comes straight from a light to the visible surface. 3 numbers a pixel.
pub const PM_LAYER_DIRECT: u32 = 2;
/// Light that comes there by way of mirrors and glass alone. 3 numbers a pixel.
pub const PM_LAYER_CAUSTIC: u32 = 3;
/// Light that was scattered diffusely before. 3 numbers a pixel.
pub const PM_LAYER_INDIRECT: u32 = 4;
/// Mean normal of the first surface, or 0. 3 numbers a pixel.
pub const PM_LAYER_NORMAL: u32 = 5;
/// Mean albedo of the first surface, or 0. 3 numbers a pixel.
pub const PM_LAYER_ALBEDO: u32 = 6;
/// Mean distance to the first surface, user space; infinite where there is none. 1 number a pixel.
pub const PM_LAYER_DEPTH: u32 = 7;
/// Share of the camera rays that hit a surface. 1 number a pixel.
pub const PM_LAYER_ALPHA: u32 = 8;
/// Standard error of the mean of RGB, W/(m² sr); infinite before the second pass. 1 number a pixel.
pub const PM_LAYER_STANDARD_ERROR: u32 = 9;
/// Estimated bias of the mean of RGB, W/(m² sr); only with the setting `errors`. 1 number a pixel.
pub const PM_LAYER_BIAS: u32 = 10;
/// Error map: half the width of the 95 % confidence interval of the mean of RGB, W/(m² sr), infinite where there is no
/// estimate; only with the setting `errors`. 1 number a pixel.
pub const PM_LAYER_HALF_WIDTH: u32 = 11;

/// Numbers a pixel of a layer: 3 or 1; 0 if there is no such layer.
#[unsafe(no_mangle)]
pub extern "C" fn pm_layer_channels(layer: u32) -> u32 {
    match layer {
        PM_LAYER_PICTURE..=PM_LAYER_ALBEDO => 3,
        PM_LAYER_DEPTH..=PM_LAYER_HALF_WIDTH => 1,
        _ => 0,
    }
}

/// Sums over passes. Several threads may read it at once.
#[derive(Debug)]
pub struct PmFilm {
    pub(crate) film: Film,
    pub(crate) info: FilmInfo,
    pub(crate) transparent: bool,
}

/// Facts about a film.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmFilmInfo {
    /// sizeof(PmFilmInfo); set before the call.
    pub size: usize,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Number of passes.
    pub passes: u32,
    /// Not 0: its only pass was cut short.
    pub cut: u32,
    /// Not 0: there is an error map.
    pub errors: u32,
    /// Passes whose photons were counted: fewer than `passes` if some are from a file without counts.
    pub counted: u32,
    /// Paths that were emitted in these passes, aimed ones included.
    pub paths: u64,
    /// Photons that they stored.
    pub photons: u64,
}

// SAFETY: `repr(C)`, begins with its size, and has only numbers.
unsafe impl pointer::Versioned for PmFilmInfo {
    const NAME: &'static str = "PmFilmInfo";
    /// The first version ended with `errors` and four bytes of padding.
    const LEAST: usize = std::mem::offset_of!(Self, paths);
}

/// Fills in `*info`, whose size has to be set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_film_info(film: *const PmFilm, info: *mut PmFilmInfo) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle.
        let film = &unsafe { pointer::shared(film, "film") }?.film;
        let tally = &film.tally;
        let found = PmFilmInfo {
            size: size_of::<PmFilmInfo>(),
            width: film.width,
            height: film.height,
            passes: film.passes,
            cut: film.cut.into(),
            errors: film.errors.is_some().into(),
            counted: tally.passes,
            paths: tally.photons.emitted.saturating_add(tally.aimed.emitted),
            photons: tally.stored().values().fold(0, |sum: u64, &of| sum.saturating_add(of)),
        };
        // SAFETY: the caller's struct.
        unsafe { pointer::write(info, &found) }
    })
}

/// Adds the passes of `other`, which stays as it is. Scene, view, settings and device have to be the same, apart from the
/// seed, and no pass may be in both.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_film_merge(film: *mut PmFilm, other: *const PmFilm) -> PmStatus {
    call(|| {
        if !film.is_null() && std::ptr::eq(film, other) {
            return Err(Fault::new(
                PmStatus::Film,
                "a film cannot be merged with itself: its passes would count twice",
            ));
        }
        // SAFETY: the caller's handles, which are two.
        let (film, other) = unsafe { (pointer::exclusive(film, "film")?, pointer::shared(other, "other")?) };
        other.info.key.check(&film.info.key, Path::new("the other film"))?;
        film.film.merge(&other.film).map_err(|error| Fault::new(PmStatus::Film, error))?;
        film.info.in_order = false;
        other.info.makers.iter().for_each(|maker| film.info.add_maker(maker));
        Ok(())
    })
}

/// Copies one of PM_LAYER_…: rows from the top, the numbers of a pixel beside each other.
///
/// `count` is the length of `values`, and has to be width times height times pm_layer_channels().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_film_layer(film: *const PmFilm, layer: u32, values: *mut f32, count: usize) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle.
        let film = &unsafe { pointer::shared(film, "film") }?.film;
        let channels = pm_layer_channels(layer) as usize;
        if channels == 0 {
            return Err(Fault::argument(format!("layer is {layer}, but there are 0 to {PM_LAYER_HALF_WIDTH}")));
        }
        let expected = film.pixels.len() * channels;
        if count != expected {
            return Err(Fault::argument(format!("count is {count}, but the layer has {expected} numbers")));
        }
        // SAFETY: the caller's array of `count` elements.
        let values = unsafe { pointer::array_mut(values, count, "values") }?;
        let triples = match layer {
            PM_LAYER_PICTURE => film.beauty(),
            PM_LAYER_EMISSION => film.layer(Layer::Emission),
            PM_LAYER_DIRECT => film.layer(Layer::Direct),
            PM_LAYER_CAUSTIC => film.layer(Layer::Caustic),
            PM_LAYER_INDIRECT => film.layer(Layer::Indirect),
            PM_LAYER_NORMAL => film.normal(),
            PM_LAYER_ALBEDO => film.albedo(),
            _ => {
                values.copy_from_slice(&numbers(film, layer)?);
                return Ok(());
            }
        };
        values.copy_from_slice(triples.as_flattened());
        Ok(())
    })
}

/// A layer of one number a pixel.
fn numbers(film: &Film, layer: u32) -> Result<Vec<f32>> {
    let of = |number: fn(&ConfidenceInterval) -> f64| {
        let intervals = film.confidence_intervals();
        let missing = || Fault::argument("the film has no error estimates; render with the setting \"errors\": true");
        intervals.map(|all| all.iter().map(|one| number(one) as f32).collect()).ok_or_else(missing)
    };
    match layer {
        PM_LAYER_DEPTH => Ok(film.depth()),
        PM_LAYER_ALPHA => Ok(film.alpha()),
        PM_LAYER_STANDARD_ERROR => Ok(film.standard_error()),
        PM_LAYER_BIAS => of(|interval| interval.bias),
        _ => of(|interval| interval.half_width),
    }
}

/// Copies the picture, denoised by Open Image Denoise 2 with PM_LAYER_ALBEDO and PM_LAYER_NORMAL, as the program does by --denoise:
/// rows from the top, 3 numbers a pixel. Where there is an error map, the mean of RGB stays within it.
///
/// `count` is the length of `values`, and has to be 3 times width times height. The library is looked for in the packages of
/// Python, where `pip install pyoidn` puts it, and by the system; or the environment variable PHOTON_OIDN has its path. Without
/// it, the status is PM_STATUS_NO_DEVICE. Films with a transparent background cannot be denoised.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_film_denoise(film: *const PmFilm, values: *mut f32, count: usize) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle.
        let PmFilm { film, transparent, .. } = unsafe { pointer::shared(film, "film") }?;
        let expected = film.pixels.len() * 3;
        if count != expected {
            return Err(Fault::argument(format!("count is {count}, but the picture has {expected} numbers")));
        }
        // SAFETY: the caller's array of `count` elements.
        let values = unsafe { pointer::array_mut(values, count, "values") }?;
        if *transparent {
            return Err(Fault::argument("films with a transparent background cannot be denoised"));
        }
        let denoiser = Denoiser::load().map_err(|why| Fault::new(PmStatus::NoDevice, why))?;
        let denoised = denoiser.denoise(film).map_err(|why| Fault::new(PmStatus::Device, why))?;
        values.copy_from_slice(denoised.pixels.as_flattened());
        Ok(())
    })
}

/// Copies the automatic exposure of the picture, in stops: the one that the program uses, for pm_film_write(). It brings the
/// log-average luminance of surfaces, without the darkest and the brightest tenth, to 0.18.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_film_exposure(film: *const PmFilm, stops: *mut f32) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle and number.
        let (PmFilm { film, .. }, stops) =
            unsafe { (pointer::shared(film, "film")?, pointer::array_mut(stops, 1, "stops")?) };
        stops[0] = Exposure::Auto.stops(&measured(&film.beauty(), &film.alpha()));
        Ok(())
    })
}

/// Writes a picture or a film file; the ending decides. The file is replaced when it is complete. The path is UTF-8.
///
/// .exr: all layers, linear. .png: the picture, tone-mapped, 8 bits; `exposure` in stops, finite:
/// that of pm_film_exposure(), for example. .film: the sums, to be
/// merged or continued by the program photonmap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_film_write(film: *const PmFilm, path: *const c_char, exposure: f32) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle and text.
        let (handle, path) = unsafe { (pointer::shared(film, "film")?, Path::new(pointer::text(path, "path")?)) };
        let PmFilm { film, info, transparent } = handle;
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
        match ending.as_str() {
            "exr" => {
                let passes = ("photon:passes".to_owned(), film.contains.to_string());
                Ok(exr_file::write(path, film, *transparent, &[passes])?)
            }
            "png" if exposure.is_finite() => {
                Ok(png_file::write(path, &Picture::new(film, *transparent), ToneMap::Neutral, exposure)?)
            }
            "png" => Err(Fault::argument(format!("exposure is {exposure}, but has to be finite"))),
            "film" => Ok(files::save(path, film, info)?),
            _ => {
                let path = path.display();
                Err(Fault::argument(format!("{path}: the name has to end in .exr, .png or .film")))
            }
        }
    })
}

/// Reads a film file. `*film` is to be freed with pm_film_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_film_load(path: *const c_char, film: *mut *mut PmFilm) -> PmStatus {
    call(|| {
        // SAFETY: the caller's text, and pointer to a handle.
        unsafe {
            pointer::hand_out(film, || {
                let path = pointer::text(path, "path")?;
                let (film, info) = files::load(Path::new(path)).map_err(|error: FilmFileError| Fault::from(error))?;
                let transparent = info.key.settings().any(|setting| setting == ("transparent_background", "true"));
                Ok(PmFilm { film, info, transparent })
            })
        }
    })
}

/// Frees a film; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_film_free(film: *mut PmFilm) {
    // SAFETY: the caller's handle.
    free(|| unsafe { pointer::free(film) });
}

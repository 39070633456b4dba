//! Settings for `--time` with error estimates where photons bring little of the light, as of a model in the open under a sky.

use photon_core::{
    Area, Bandwidth, Budget, CausticPhotons, Choice, Direct, Estimator, Features, Film, Pipeline, Settings,
    TransportBackend, render,
};
use photon_scene::Scene;

use crate::args::SettingsArgs;
use crate::fault::Fault;

/// Below this share of the light, fewer photons are better.
const SOME: f64 = 0.2;

/// Below this share, discs in place of the areas of surfaces are better too: what is missing at edges is little of the pixel.
const LITTLE: f64 = 0.1;

/// The paths of a pass are divided by this.
const FEWER: u32 = 8;

/// Width of the picture in which the share is measured, its paths, and its passes.
const WIDTH: u32 = 64;
const PATHS: u32 = 16_384;
const PASSES: u32 = 2;

/// The settings for this scene: with `--time`, an environment, error estimates (without them, trials choose), and neither
/// `--photons` nor `--area`, a small picture tells which share of the light photons bring. If it is little, paths are fewer, and areas may be those of discs, so that the time
/// is spent on camera paths and shadow rays. The choice depends on scene and settings alone.
///
/// # Errors
/// Those of rendering.
pub(super) fn choose<B: TransportBackend>(
    on: B,
    args: &SettingsArgs,
    scene: &Scene,
    settings: Settings,
) -> Result<(B, Settings), Fault> {
    let is_open = Features::of(&scene.view()).contains(Features::ENVIRONMENT);
    let is_given = args.photon.photons.is_some() || args.estimate.area.is_some();
    // Radii have to be derived, so that those of fewer photons are larger.
    let is_derived =
        matches!(settings.estimator, Estimator::Radius { radius: None }) && settings.irradiance_every.is_none();
    let is_left_to_us = is_derived && !is_given && args.is_timed() && args.purpose().is_none();
    if !is_open || !is_left_to_us || settings.photons / FEWER < Choice::MIN_PHOTONS {
        return Ok((on, settings));
    }
    let mut picture = args.picture.clone();
    let (width, height) = picture.size;
    picture.size = (WIDTH, (WIDTH * height.min(4 * width) / width.max(1)).max(1));
    let small = Settings {
        photons: PATHS,
        caustic_photons: match settings.caustic_photons {
            CausticPhotons::Aimed(_) => CausticPhotons::Aimed(PATHS),
            other => other,
        },
        area: Area::Disc,
        bandwidth: Bandwidth::Shared,
        errors: false,
        ..settings.clone()
    };
    let mut pilot = Pipeline::new(on, &scene.view(), picture.view(scene)?, small)?;
    render(&mut pilot, Budget::passes(PASSES), &mut ())?;
    let share = share(&photon_core::Render::film(&mut pilot)?, settings.direct == Direct::Photons);
    let on = pilot.into_backend()?;
    if share >= SOME {
        return Ok((on, settings));
    }
    let photons = settings.photons / FEWER;
    let area = if share < LITTLE { Area::Disc } else { settings.area };
    let discs = if area == settings.area { "" } else { " and areas of discs" };
    say!(
        "photons bring {:.0} % of the light of the surfaces: {photons} paths a pass{discs}, unless --photons or --area is given",
        100.0 * share
    );
    Ok((on, Settings { photons, area, ..settings }))
}

/// The share of the light that photons bring, as a mean over the pixels that show a surface, so that bright pixels count no
/// more than others. Direct light may be that of photons, or of shadow rays.
fn share(film: &Film, direct_by_photons: bool) -> f64 {
    let shares = film.pixels.iter().filter(|pixel| pixel.hits > 0).filter_map(|pixel| {
        let [emission, direct, caustic, indirect] = pixel.layers.map(|layer| layer.iter().sum::<f64>());
        let all = emission + direct + caustic + indirect;
        let photons = caustic + indirect + if direct_by_photons { direct } else { 0.0 };
        (all > 0.0).then(|| photons / all)
    });
    let (sum, count) = shares.fold((0.0, 0_u32), |(sum, count), share| (sum + share, count + 1));
    if count > 0 { sum / f64::from(count) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_a_mean_over_surfaces() {
        let mut film = Film::new(4, 1, photon_core::Units::default()).unwrap();
        assert!(share(&film, false) == 0.0);
        // Background, two surfaces, and a black one.
        film.pixels[0].layers[0] = [100.0; 3];
        for (pixel, layers) in [(1, [0.0, 3.0, 0.5, 0.5]), (2, [50.0, 0.0, 0.0, 50.0]), (3, [0.0; 4])] {
            film.pixels[pixel].hits = 1;
            film.pixels[pixel].layers = layers.map(|value| [value; 3]);
        }
        assert!((share(&film, false) - 0.375).abs() < 1e-12);
        assert!((share(&film, true) - 0.75).abs() < 1e-12);
    }
}

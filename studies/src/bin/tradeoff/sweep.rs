//! The settings that are measured: each varied by itself, from a baseline setting.

use photon_core::{
    Area, Bandwidth, Budget, CausticPhotons, Direct, Estimator, IndexKind, Indirect, Kernel, RandomKind, Scheduling,
    Settings,
};
use photonmap_cli::fault::Fault;

use crate::engine::{Engine, Subject};
use crate::measure::{self, Run};
use crate::records::{Row, Shot};
use crate::truth::Truth;

/// One setting.
#[derive(Clone, Debug)]
struct Point {
    /// Which option is varied.
    knob: &'static str,
    /// Its value.
    value: String,
    settings: Settings,
    passes: u32,
}

/// Passes of the baseline setting.
pub(crate) const PASSES: u32 = 16;

/// The baseline setting. A scene whose reference is only that of scattered light shows nothing else.
pub(crate) fn base(scene: &str, photons: u32) -> Settings {
    let direct = if scene == "integrating-sphere" { Direct::None } else { Direct::Nee };
    Settings { photons, direct, ..Settings::default() }
}

/// All of them.
fn points(base: &Settings) -> Vec<Point> {
    let mut points = Vec::new();
    let mut add = |knob, value: &str, settings: Settings, passes| {
        points.push(Point { knob, value: value.to_owned(), settings, passes });
    };
    let with = |change: &dyn Fn(&mut Settings)| {
        let mut settings = base.clone();
        change(&mut settings);
        settings
    };
    for passes in [1, 4, PASSES, 4 * PASSES] {
        add("passes", &passes.to_string(), base.clone(), passes);
    }
    // The same number of photons in fewer, larger passes, or in more, smaller ones.
    add("photons per pass", "x1/4", with(&|s| s.photons /= 4), 4 * PASSES);
    add("photons per pass", "x4", with(&|s| s.photons *= 4), PASSES / 4);
    for factor in [0.25, 0.5, 0.71, 1.41, 2.0] {
        add("radii", &format!("x{factor}"), with(&|s| s.radius_factor = factor), PASSES);
    }
    add("radii", "x0.5, passes x4", with(&|s| s.radius_factor = 0.5), 4 * PASSES);
    add("radii", "x2, passes 4", with(&|s| s.radius_factor = 2.0), PASSES / 4);
    for alpha in [0.8, 1.0] {
        add("alpha", &format!("{alpha:.2}"), with(&|s| s.alpha = alpha), PASSES);
    }
    add("kernel", "constant", with(&|s| s.kernel = Kernel::Constant), PASSES);
    for passes in [PASSES, 4 * PASSES] {
        add("area", &format!("surface, {passes} passes"), with(&|s| s.area = Area::Surface), passes);
    }
    add("plane", "a quarter of the radius", with(&|s| s.max_plane_distance = Some(0.25)), PASSES);
    add("caustics", "shared", with(&|s| s.caustic_photons = CausticPhotons::Shared), PASSES);
    let as_many = CausticPhotons::Aimed(base.photons);
    add("caustics", "as many aimed", with(&|s| s.caustic_photons = as_many), PASSES);
    for k in [20, 50, 200] {
        let estimator = Estimator::Knn { k, max_radius: None };
        add("estimator", &format!("{k} nearest"), with(&|s| s.estimator = estimator), PASSES);
    }
    add("estimator", "paper", Settings { photons: base.photons, direct: base.direct, ..Settings::paper() }, PASSES);
    for (name, index) in [("median", IndexKind::Median), ("VVH", IndexKind::Vvh)] {
        add("index", name, with(&|s| s.index = index), PASSES);
    }
    let gather = |rays: u32| with(&move |s| (s.indirect, s.gather_rays) = (Indirect::Gather, rays));
    add("indirect", "gather, 4 rays, 4 passes", gather(4), PASSES / 4);
    add("indirect", "gather, 4 rays", gather(4), PASSES);
    add("indirect", "gather, 16 rays", gather(16), PASSES);
    add("indirect", "gather, 4 rays, passes x4", gather(4), 4 * PASSES);
    let fewer = Settings { photons: base.photons / 4, ..gather(4) };
    add("indirect", "gather, 4 rays, 1/4 photons, passes x4", fewer, 4 * PASSES);
    let places = Settings { irradiance_every: Some(4), ..gather(16) };
    add("indirect", "gather, 16 rays to places", places, PASSES);
    let per_pixel = with(&|s| (s.bandwidth, s.errors) = (Bandwidth::PerPixel, true));
    for (area, name) in [(Area::Disc, "per pixel"), (Area::Surface, "per pixel, area surface")] {
        for passes in [PASSES, 4 * PASSES] {
            add("bandwidth", &format!("{name}, {passes} passes"), Settings { area, ..per_pixel.clone() }, passes);
        }
    }
    add("sharing", "static", with(&|s| s.scheduling = Scheduling::Static), PASSES);
    add("generator", "LCG", with(&|s| s.random = RandomKind::Lcg), PASSES);
    add("errors", "told", with(&|s| s.errors = true), PASSES);
    add("errors", "told, passes x4", with(&|s| s.errors = true), 4 * PASSES);
    add("photons per pass", "x2, 4 passes", with(&|s| s.photons *= 2), 4);
    let twice = with(&|s| (s.area, s.photons) = (Area::Surface, 2 * s.photons));
    add("area", "surface, 64 passes, photons x2", twice, 4 * PASSES);
    points
}

/// Passes and photons of the longest run.
pub(crate) fn longest(base: &Settings) -> (u32, u64) {
    let all = points(base);
    let photons = all.iter().map(|point| u64::from(point.passes) * u64::from(point.settings.photons)).max();
    (all.iter().map(|point| point.passes).max().unwrap_or(1), photons.unwrap_or(1))
}

/// Every setting with that many seeds. Seeds are the outer loop, so that other load on the machine
/// affects all settings; each setting runs once before, to exclude one-time work.
pub(crate) fn rows(
    engine: &mut Engine,
    subject: &Subject,
    (base, seeds): (&Settings, u32),
    truth: &Truth,
) -> Result<Vec<Row>, Fault> {
    let points = points(base);
    let mut runs: Vec<Vec<Run>> = points.iter().map(|_| Vec::new()).collect();
    for (number, (point, runs)) in points.iter().zip(&mut runs).enumerate() {
        engine.films(subject, (&point.settings, point.passes), seeds, |film, details| {
            runs.push(Run::new(film, details.seconds, details.outcome.paths));
        })?;
        crate::progress(&format!("{}: setting {} of {}", subject.name, number + 1, points.len()));
    }
    let row = |(point, runs): (Point, Vec<Run>)| Row {
        knob: point.knob.to_owned(),
        value: point.value,
        passes: point.passes,
        summary: measure::summarise(&runs, truth),
    };
    Ok(points.into_iter().zip(runs).map(row).collect())
}

/// The settings whose pictures are shown: option and value.
const SHOWN: [(&str, &str); 5] =
    [("passes", "16"), ("radii", "x0.5"), ("area", "surface, 16 passes"), ("estimator", "paper"), ("passes", "64")];

/// A picture with each of these, with the same seed.
pub(crate) fn shots(engine: &mut Engine, subject: &Subject, base: &Settings) -> Result<Vec<Shot>, Fault> {
    let shown = |point: &Point| SHOWN.iter().position(|&(knob, value)| knob == point.knob && value == point.value);
    let mut points: Vec<(usize, Point)> =
        points(base).into_iter().filter_map(|point| Some((shown(&point)?, point))).collect();
    points.sort_by_key(|(place, _)| *place);
    let shot = |(_, point): (usize, Point)| {
        let settings = Settings { seed: 1, ..point.settings };
        let (film, details) = engine.film(subject, &settings, Budget::Passes(point.passes))?;
        let name = if point.knob == "passes" {
            format!("{} passes", point.value)
        } else {
            format!("{}: {}", point.knob, point.value)
        };
        Ok(Shot { name, seconds: details.seconds, pixels: film.beauty() })
    };
    points.into_iter().map(shot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_that_is_shown_is_one_of_a_setting() {
        let all = points(&base("ring", 4000));
        assert!(SHOWN.iter().all(|(knob, value)| all.iter().any(|p| p.knob == *knob && p.value == *value)));
    }

    #[test]
    fn every_setting_makes_sense_and_is_tried_once() {
        let all = points(&base("ring", 4000));
        for (i, point) in all.iter().enumerate() {
            point.settings.validate().unwrap();
            assert!(all[..i].iter().all(|p| (&p.settings, p.passes) != (&point.settings, point.passes)), "{point:?}");
        }
    }
}

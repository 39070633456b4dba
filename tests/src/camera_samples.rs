//! Several camera samples in a pass.

use photon_core::{Direct, Film, Indirect, Layer, Render as _, Settings};
use photon_scene::builtin;

use crate::harness::{TestBackend, film, per_pass, renderer};
use crate::stats::{assert_agrees, moments, standard_error};

fn settings(camera_samples: u32, seed: u64) -> Settings {
    Settings { photons: 2000, camera_samples, seed, ..Settings::default() }
}

/// The expected picture is that of one sample: difference of two means over independent passes, `√(s₁²/n₁ + s₂²/n₂)`.
pub fn means_are_those_of_one_sample<T: TestBackend>() {
    let mut cases = vec![("sky", Direct::Nee), ("cornell-glass", Direct::Nee), ("cornell-glass", Direct::Photons)];
    if T::ONE_OF == 1 {
        cases.push(("fog", Direct::Nee));
    }
    for (name, direct) in cases {
        let scene = builtin(name).unwrap().build().unwrap();
        let of =
            |samples, seed, passes| per_pass::<T>(&scene, &Settings { direct, ..settings(samples, seed) }, passes, 12);
        let (one, several) = (of(1, 1, 24), of(5, 2, 12));
        let error = standard_error(&one).hypot(standard_error(&several));
        assert_agrees(&format!("{name}, {direct}"), moments(&several).0, moments(&one).0, error, 0.0);
    }
}

/// What is read from maps has the bits of one sample; the first samples of two passes that have them have the same light.
pub fn maps_are_read_for_the_first_sample<T: TestBackend>() {
    let scene = builtin("cornell-glass").unwrap().build().unwrap();
    let of = |samples| film::<T>(&scene, &settings(samples, 3), 2, 24);
    let (one, three) = (of(1), of(3));
    assert_eq!((one.camera_samples, three.camera_samples), (1, 3));
    for (layer, is_read) in [(Layer::Caustic, true), (Layer::Indirect, true), (Layer::Direct, false)] {
        assert_eq!(one.layer(layer) == three.layer(layer), is_read, "{}", layer.name());
    }
}

/// Without photons, the variance of a pass is at most that of one sample over their number, since their points are spread evenly.
/// Compared pixel by pixel where no light source is seen: edges of these have most of it. Pixels are independent, so that the mean
/// of the differences has the standard error of their spread.
pub fn noise_falls_with_their_number<T: TestBackend>() {
    let scene = builtin("cornell").unwrap().build().unwrap();
    let light = |samples, seed| Settings { indirect: Indirect::None, caustics: false, ..settings(samples, seed) };
    let [one, four] = [(1, 5), (4, 6)].map(|(samples, seed)| film::<T>(&scene, &light(samples, seed), 16, 24));
    let is_light = |film: &Film| film.layer(Layer::Emission).into_iter().map(|emitted| emitted != [0.0; 3]);
    let lights: Vec<bool> = is_light(&one).zip(is_light(&four)).map(|(one, four)| one || four).collect();
    // Variance of a pass over 16.
    let variance = |film: &Film| film.standard_error().into_iter().map(|error| f64::from(error).powi(2));
    let pairs: Vec<_> = variance(&one).zip(variance(&four)).zip(&lights).filter(|(_, light)| !**light).collect();
    let gaps = |factor: f64| pairs.iter().map(|((one, four), _)| factor * four - one).collect::<Vec<_>>();
    let z = |gaps: &[f64]| moments(gaps).0 / standard_error(gaps);
    let (quarter, same) = (gaps(4.0), gaps(1.0));
    assert!(z(&quarter) <= 4.5, "{}", z(&quarter));
    assert!(z(&same) < -4.5, "equal variances go unnoticed: {}", z(&same));
}

/// Opacity, depth, normals and albedo are means over all samples; passes add up, and are counted once.
pub fn first_surfaces_are_means<T: TestBackend>() {
    let scene = builtin("sky").unwrap().build().unwrap();
    let of = |samples, seed, passes| film::<T>(&scene, &settings(samples, seed), passes, 16);
    let (one, several) = (of(1, 7, 32), of(8, 8, 4));
    // Pixels are independent: the mean of their differences has the standard error of its spread.
    let values = |film: &Film| -> [Vec<f64>; 3] {
        let depth = film.depth().into_iter().map(|depth| if depth.is_finite() { f64::from(depth) } else { 0.0 });
        [
            film.alpha().into_iter().map(f64::from).collect(),
            depth.collect(),
            film.albedo().into_iter().map(|[red, ..]| f64::from(red)).collect(),
        ]
    };
    for (found, expected) in values(&several).into_iter().zip(values(&one)) {
        let gaps: Vec<f64> = found.iter().zip(&expected).map(|(found, expected)| found - expected).collect();
        assert_agrees("first surface", moments(&gaps).0, 0.0, standard_error(&gaps), 1e-6 * moments(&expected).0);
    }
    assert!(several.alpha().iter().all(|&alpha| (0.0..=1.0).contains(&alpha)));
    assert!(several.pixels.iter().any(|pixel| pixel.hits > u64::from(several.passes)));
    let mut renderer = renderer::<T>(&scene, &settings(8, 8), 16);
    let mut parts: Option<Film> = None;
    for pass in 0..4 {
        renderer.pass(pass, &mut ()).unwrap();
        if pass % 2 == 1 {
            let block = renderer.take().unwrap();
            match &mut parts {
                Some(parts) => parts.merge(&block).unwrap(),
                None => parts = Some(block),
            }
        }
    }
    let parts = parts.unwrap();
    assert_eq!((parts.alpha(), parts.passes, &parts.contains), (several.alpha(), 4, &several.contains));
}

//! Invalid settings are refused by name; presets are valid.

use photon_core::{Area, Bandwidth, CausticPhotons, Error, Estimator, Indirect, Paper, Preset, Settings};

#[test]
fn presets_are_valid() {
    let presets = Preset::ALL.into_iter().flat_map(|preset| [0, 4096, u64::MAX].map(|n| Settings::preset(preset, n)));
    for settings in presets.chain([Settings::default(), Settings::paper()]) {
        settings.validate().unwrap();
    }
}

/// A quarter of the radius only where areas and radii allow it.
#[test]
fn the_plane_distance_has_a_default() {
    let of = |area, estimator, given| {
        Settings { area, estimator, max_plane_distance: given, ..Settings::default() }.plane_distance()
    };
    let (radius, knn) = (Estimator::Radius { radius: None }, Estimator::Knn { k: 9, max_radius: None });
    assert_eq!([of(Area::Surface, radius, None), of(Area::Surface, radius, Some(0.5))], [0.25, 0.5]);
    assert_eq!([of(Area::Disc, radius, None), of(Area::Surface, knn, None)], [1.0, 1.0]);
}

#[test]
fn nonsense_is_refused_by_name() {
    let base = Settings::default;
    let knn = |k, max_radius| Settings { estimator: Estimator::Knn { k, max_radius }, ..base() };
    let radius = |r| Settings { estimator: Estimator::Radius { radius: Some(r) }, ..base() };
    let paper = |paper| Settings { estimator: Estimator::Paper(paper), ..base() };
    let cases = [
        ("photons", Settings { photons: 0, ..base() }),
        ("caustic-photons", Settings { caustic_photons: CausticPhotons::Aimed(0), ..base() }),
        ("caustic-roughness", Settings { caustic_roughness: Some(-0.1), ..base() }),
        ("caustic-roughness", Settings { caustic_roughness: Some(1.1), ..base() }),
        ("caustic-roughness", Settings { caustic_roughness: Some(f32::NAN), ..base() }),
        ("k", knn(0, None)),
        ("k", knn(1, None)),
        ("radius", knn(5, Some(0.0))),
        ("radius", radius(0.0)),
        ("radius", radius(-1.0)),
        ("radius", radius(f64::INFINITY)),
        ("radius", radius(f64::NAN)),
        ("radius-factor", Settings { radius_factor: 0.0, ..base() }),
        ("radius-factor", Settings { radius_factor: f64::NAN, ..base() }),
        ("radius-factor", Settings { radius_factor: 1e308, ..base() }),
        ("k", paper(Paper { max: 0, ..Paper::default() })),
        ("radius", paper(Paper { radius: Some(f64::NAN), ..Paper::default() })),
        ("factor", paper(Paper { factor: f32::NAN, ..Paper::default() })),
        ("factor", paper(Paper { factor: f32::MAX, ..Paper::default() })),
        ("max-bounces", Settings { max_bounces: 0, ..base() }),
        ("max-bounces", Settings { max_bounces: u32::MAX, ..base() }),
        ("alpha", Settings { alpha: 0.0, ..base() }),
        ("alpha", Settings { alpha: f64::NAN, ..base() }),
        ("camera-samples", Settings { camera_samples: 0, ..base() }),
        ("camera-samples", Settings { camera_samples: 4097, ..base() }),
        ("shadow-rays", Settings { shadow_rays: 0, ..base() }),
        ("shadow-rays", Settings { shadow_rays: 1 << 31, ..base() }),
        ("gather-rays", Settings { gather_rays: 0, ..base() }),
        ("gather-rays", Settings { gather_rays: 4097, ..base() }),
        ("area", Settings { area: Area::Surface, ..paper(Paper::default()) }),
        ("bandwidth", Settings { bandwidth: Bandwidth::PerPixel, ..base() }),
        ("bandwidth", Settings { bandwidth: Bandwidth::PerPixel, errors: true, indirect: Indirect::Gather, ..base() }),
        ("irradiance-every", Settings { irradiance_every: Some(0), indirect: Indirect::Gather, ..base() }),
        ("irradiance-every", Settings { irradiance_every: Some(4), ..base() }),
        (
            "irradiance-every",
            Settings { irradiance_every: Some(4), indirect: Indirect::Gather, errors: true, ..base() },
        ),
        ("min-normal-cosine", Settings { min_normal_cosine: f32::NAN, ..base() }),
        ("max-plane-distance", Settings { max_plane_distance: Some(f32::NAN), ..base() }),
        ("max-plane-distance", Settings { max_plane_distance: Some(0.0), ..base() }),
        ("max-plane-distance", Settings { max_plane_distance: Some(1.5), ..base() }),
        (
            "max-plane-distance",
            Settings { max_plane_distance: Some(0.5), estimator: Estimator::Knn { k: 9, max_radius: None }, ..base() },
        ),
    ];
    for (culprit, settings) in cases {
        match settings.validate() {
            Err(Error::InvalidSetting { name, .. }) => assert_eq!(name, culprit),
            other => panic!("{culprit}: {other:?}"),
        }
    }
}

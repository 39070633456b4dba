//! Settings that make no sense are refused by name; presets make sense.

use photon_core::{CausticPhotons, Error, Estimator, Kernel, Paper, Settings};

#[test]
fn presets_are_valid() {
    for settings in [Settings::default(), Settings::preview(), Settings::final_quality(), Settings::paper()] {
        settings.validate().unwrap();
    }
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
        ("k", knn(0, None)),
        ("k", knn(1, None)),
        ("radius", knn(5, Some(0.0))),
        ("radius", radius(0.0)),
        ("radius", radius(-1.0)),
        ("radius", radius(f64::INFINITY)),
        ("radius", radius(f64::NAN)),
        ("k", paper(Paper { max: 0, ..Paper::default() })),
        ("radius", paper(Paper { radius: Some(f64::NAN), ..Paper::default() })),
        ("factor", paper(Paper { factor: f32::NAN, ..Paper::default() })),
        ("slope of the cone", Settings { kernel: Kernel::Cone { slope: 0.5 }, ..base() }),
        ("max-bounces", Settings { max_bounces: 0, ..base() }),
        ("alpha", Settings { alpha: 0.0, ..base() }),
        ("alpha", Settings { alpha: f64::NAN, ..base() }),
        ("shadow-rays", Settings { shadow_rays: 0, ..base() }),
        ("gather-rays", Settings { gather_rays: 0, ..base() }),
        ("min-normal-cosine", Settings { min_normal_cosine: f32::NAN, ..base() }),
    ];
    for (culprit, settings) in cases {
        match settings.validate() {
            Err(Error::InvalidSetting { name, .. }) => assert_eq!(name, culprit),
            other => panic!("{culprit}: {other:?}"),
        }
    }
}

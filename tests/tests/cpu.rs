//! The suite on the CPU.

use photon_core::{Bandwidth, Fixed, Indirect, Pipeline, Render as _, Settings, View};
use photon_tests::backends::OnCpu;
use photon_tests::harness::TestBackend as _;

photon_tests::whole_suite!(OnCpu);

#[test]
fn final_gathering_in_a_sunny_room() {
    photon_tests::debias::d9_final_gathering_in_a_sunny_room::<OnCpu>();
}

/// A renderer whose settings are decided makes the bits of one that was made with these settings. The first pass is in no film, and
/// decides the same every time.
#[test]
fn decided_settings_make_the_same_bits() {
    for (name, seconds, decided) in [
        ("ring", None, (Bandwidth::PerPixel, Indirect::Map, Some(8))),
        ("two-rooms", Some(1e9), (Bandwidth::Shared, Indirect::Gather, None)),
        ("cornell", Some(1e9), (Bandwidth::Shared, Indirect::Map, None)),
        ("sky", None, (Bandwidth::Shared, Indirect::Map, Some(8))),
    ] {
        let scene = photon_scene::builtin(name).unwrap().build().unwrap();
        let view = View { camera: scene.camera(None, 24, 24).unwrap(), width: 24, height: 24 };
        let settings = Settings { gather_rays: 2, seed: 5, ..Settings::default() };
        let fixed = Fixed { bandwidth: name == "sky", ..Fixed::default() };
        let made = || Pipeline::for_time(OnCpu::make(2), &scene.view(), view, &settings, (seconds, fixed)).unwrap();
        let ((mut renderer, found), (_, again)) = (made(), made());
        let found = found.unwrap().settings;
        // Within a time, samples are decided by seconds too.
        let again = match seconds {
            Some(_) => Settings {
                camera_samples: found.camera_samples,
                shadow_rays: found.shadow_rays,
                ..again.unwrap().settings
            },
            None => again.unwrap().settings,
        };
        assert_eq!(found, again, "{name}: facts of the light are the same every time");
        assert_eq!((found.bandwidth, found.indirect), (decided.0, decided.1), "{name}");
        assert!(decided.2.is_none_or(|rays| found.shadow_rays == rays), "{name}");
        assert_eq!(found.photons, 4 * 24 * 24, "{name}: a small picture has few paths");
        let mut fixed = Pipeline::new(OnCpu::make(2), &scene.view(), view, found.clone()).unwrap();
        let other = Settings { shadow_rays: found.shadow_rays + 1, ..found };
        let mut other = Pipeline::new(OnCpu::make(2), &scene.view(), view, other).unwrap();
        for pass in 0..2 {
            for renderer in [&mut renderer, &mut fixed, &mut other] {
                renderer.pass(pass, &mut ()).unwrap();
            }
        }
        let pixels = renderer.film().unwrap().pixels;
        assert_eq!(pixels, fixed.film().unwrap().pixels, "{name}");
        assert_ne!(pixels, other.film().unwrap().pixels, "{name}: another setting goes unnoticed");
    }
}

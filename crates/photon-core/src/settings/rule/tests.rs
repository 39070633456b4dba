//! The rule, fact by fact.

use super::*;

const OPEN: Fixed =
    Fixed { photons: false, area: false, bandwidth: false, indirect: false, shadow_rays: false, camera_samples: false };

fn within(seconds: Option<f64>, is_gpu: bool, fixed: Fixed) -> Circumstances {
    Circumstances { seconds, pixels: 512 * 512, is_gpu, fixed }
}

/// Paths, radii per pixel, final gathering, and shadow rays.
fn decided(first: FirstPass, within: &Circumstances) -> (u32, bool, bool, u32) {
    let settings = Settings::default().for_time(within, &first);
    settings.validate().unwrap();
    assert_eq!(settings.area, Area::Surface);
    let per_pixel = settings.bandwidth == Bandwidth::PerPixel;
    assert_eq!(settings.errors, per_pixel, "statistics are kept for radii per pixel alone");
    (settings.photons, per_pixel, settings.indirect == Indirect::Gather, settings.shadow_rays)
}

#[test]
fn each_fact_decides_its_setting() {
    let (cpu, gpu) = (within(Some(60.0), false, OPEN), within(Some(60.0), true, OPEN));
    let plain = FirstPass { direct: 0.4, indirect: 0.6, seconds_left: 60.0, ..FirstPass::default() };
    let caustics = FirstPass { caustic_pixels: 0.05, ..plain };
    let lit = FirstPass { direct: 0.61, ..plain };
    let indirect = FirstPass { indirect: 0.7, direct: 0.3, ..plain };
    // A pass with 16 rays takes 1.6 s: 32 of them and the kernels fit, or just not.
    let dear = FirstPass { photon_seconds: 0.1, other_seconds: 0.1, gather_ray_seconds: 1.4 / 16.0, ..indirect };
    for (first, on_cpu, on_gpu) in [
        (plain, (65_536, false, false, 1), (400_000, true, false, 1)),
        (caustics, (65_536, true, false, 1), (400_000, true, false, 1)),
        // Eight passes take 60 s, or a little longer.
        (FirstPass { other_seconds: 7.5, ..caustics }, (65_536, true, false, 1), (400_000, true, false, 1)),
        (FirstPass { other_seconds: 7.6, ..caustics }, (65_536, false, false, 1), (400_000, true, false, 1)),
        (indirect, (65_536, false, true, 1), (400_000, false, true, 1)),
        // 32 passes leave a quarter of a second for more paths, which take a tenth.
        (dear, (65_536, false, true, 1), (800_000, false, true, 1)),
        (FirstPass { compile_seconds: 9.0, ..dear }, (65_536, false, false, 1), (400_000, true, false, 1)),
    ] {
        assert_eq!(decided(first, &cpu), on_cpu, "{first:?}");
        assert_eq!(decided(first, &gpu), on_gpu, "{first:?}");
    }
    // Within a time, shadow rays depend on noise, of which there is none here.
    let rays = |first, is_gpu| decided(first, &within(None, is_gpu, OPEN)).3;
    assert_eq!([rays(plain, false), rays(lit, false), rays(lit, true)], [2, 8, 8]);
    // A number of passes has no time that final gathering could pay in.
    assert!(!decided(indirect, &within(None, false, OPEN)).2);
    let fixed = within(Some(60.0), true, Fixed::ALL);
    assert_eq!(
        Settings::default().for_time(&fixed, &FirstPass { caustic_pixels: 1.0, ..indirect }),
        Settings::default()
    );
}

#[test]
fn camera_samples_and_shadow_rays_balance_time_and_noise() {
    let found = |first: FirstPass, fixed: Fixed| {
        let of = |within: &Circumstances| {
            let found = Settings { shadow_rays: 3, ..Settings::default() }.for_time(within, &first);
            (found.camera_samples, found.shadow_rays)
        };
        assert_eq!(of(&within(None, false, OPEN)), (1, 3), "a number of passes has no time to save");
        of(&within(Some(9.0), false, fixed))
    };
    // Seconds of what is done once, of a camera path and of a shadow ray; noise of the three.
    let first = |[once_seconds, camera_seconds, shadow_ray_seconds]: [f64; 3], [map, camera, shadow]: [f64; 3]| {
        let noise = FirstPass { map_noise: map, camera_noise: camera, shadow_noise: shadow, ..FirstPass::default() };
        let (alone_seconds, alone_ray_seconds) = (once_seconds + camera_seconds, shadow_ray_seconds);
        let alone = FirstPass { alone_seconds, alone_ray_seconds, ..noise };
        FirstPass { once_seconds, camera_seconds, shadow_ray_seconds, seconds_left: 1e9, ..alone }
    };
    let open = |seconds, noise| found(first(seconds, noise), OPEN);
    // A sample has 4 rays, as 4^(5/2) is 4 · (12 + 4) / 2, and takes 8 s; its variance is 1.5.
    assert_eq!(open([400.0, 4.0, 1.0], [1.0, 1.0, 4.0]), (9, 4), "√(400 · 1.5 / 8)");
    let some = first([400.0, 4.0, 1.0], [1.0, 1.0, 4.0]);
    assert_eq!(found(some, Fixed { camera_samples: true, ..OPEN }), (1, 17), "(4 · (1212 + 17) / 4)^(2/5)");
    assert_eq!(found(some, Fixed { shadow_rays: true, ..OPEN }), (10, 3), "√(400 · (1 + 4 · 3^(−3/2)) / 7)");
    assert_eq!(found(some, Fixed { shadow_rays: true, camera_samples: true, ..OPEN }), (1, 3));
    // One sample: all noise is of maps, or of what shadow rays find.
    assert_eq!(open([9.0, 1.0, 1.0], [1.0, 0.0, 0.0]), (1, 1));
    assert_eq!(open([9.0, 1.0, 1.0], [1.0, 0.0, 10.0]), (1, 8), "(10 · (30 + 8) / 2)^(2/5)");
    // Many: no noise is of maps; and as many as there is time for, in as many passes as of a preview.
    assert_eq!(open([9.0, 1.0, 1.0], [0.0, 1.0, 0.0]), (64, 1));
    let passes = f64::from(Preset::Preview.passes());
    let short = FirstPass { seconds_left: 19.0 * passes, ..first([9.0, 1.0, 1.0], [0.0, 1.0, 0.0]) };
    assert_eq!(found(short, OPEN), (5, 1));
    // Nothing at all.
    assert_eq!(open([0.0; 3], [0.0; 3]), (1, 1));
}

#[test]
fn paths_are_fewer_in_small_pictures_and_short_times() {
    let few = Circumstances { pixels: 100, ..within(Some(9.0), false, OPEN) };
    assert_eq!(Settings::default().for_first_pass(&few).photons, 400);
    assert_eq!(Settings::default().for_first_pass(&Circumstances { is_gpu: true, ..few }).photons, 3200);
    let photons = |photon_seconds, other_seconds, seconds_left| {
        let first = FirstPass { photon_seconds, other_seconds, seconds_left, ..FirstPass::default() };
        decided(first, &within(Some(9.0), false, OPEN)).0
    };
    assert_eq!(photons(1.5, 0.5, 8.0), 65_536);
    assert_eq!(photons(1.5, 0.5, 5.0), 32_768);
    // By powers of two.
    assert_eq!(photons(1.5, 0.5, 6.0), 32_768);
    assert_eq!(photons(1.5, 0.5, 7.0), 65_536);
    // Fewer paths do not help if the rest of a pass takes longer.
    assert_eq!(photons(1.5, 1.5, 0.0), 65_536);
    assert_eq!(photons(2.0, 0.5, -1.0), 16_384);
    assert_eq!(photons(0.0, 0.0, 0.0), 65_536);
}

/// Without noise, camera samples and shadow rays are those of a number of passes.
#[test]
fn noise_that_was_not_measured_decides_nothing() {
    let within = within(Some(9.0), true, OPEN);
    for (direct, rays) in [(0.6, SHADOW_RAYS), (0.2, Settings::default().shadow_rays)] {
        let first = FirstPass {
            direct,
            indirect: 0.4,
            lacks_noise: true,
            camera_noise: 1.0,
            seconds_left: 9.0,
            ..FirstPass::default()
        };
        let settings = Settings::default().for_time(&within, &first);
        assert_eq!((settings.camera_samples, settings.shadow_rays), (1, rays));
        let many = Settings { camera_samples: 8, ..Settings::default() };
        assert_eq!(many.for_time(&within, &first).camera_samples, 1);
    }
}

#[test]
fn paths_are_more_on_a_gpu_whose_time_goes_elsewhere() {
    let photons = |photon_seconds, other_seconds, seconds_left, is_gpu| {
        let first = FirstPass { photon_seconds, other_seconds, seconds_left, ..FirstPass::default() };
        decided(first, &within(Some(9.0), is_gpu, OPEN)).0
    };
    assert_eq!(photons(0.1, 0.9, 60.0, true), 8 * 400_000);
    assert_eq!(photons(0.1, 0.9, 60.0, false), 65_536);
    assert_eq!(photons(0.1, 0.19, 60.0, true), 400_000);
    assert_eq!(photons(1e-9, 0.9, 60.0, true), 32 * 512 * 512);
    let few = FirstPass {
        most_paths: Some(500_000),
        photon_seconds: 0.1,
        other_seconds: 0.9,
        seconds_left: 60.0,
        ..FirstPass::default()
    };
    assert_eq!(decided(few, &within(Some(9.0), true, OPEN)).0, 500_000);
    // Four passes still fit: 0.8 s remain of each for photons, or less than nothing.
    assert_eq!(photons(0.1, 1.0, 7.2, true), 8 * 400_000);
    assert_eq!(photons(0.1, 1.0, 5.0, true), 2 * 400_000);
    assert_eq!(photons(0.1, 5.0, 8.0, true), 400_000);
    // Final gathering that was asked for is in the rest already; a limit on memory leaves their number.
    let asked = Settings { indirect: Indirect::Gather, ..Settings::default() };
    let first = FirstPass {
        photon_seconds: 0.1,
        other_seconds: 0.5,
        gather_ray_seconds: 1.0,
        seconds_left: 60.0,
        ..FirstPass::default()
    };
    let given = within(Some(9.0), true, Fixed { indirect: true, ..OPEN });
    assert_eq!(asked.for_time(&given, &first).photons, 4 * 400_000);
    let limited = Settings { memory: Some(1 << 30), ..asked };
    assert_eq!(limited.for_time(&given, &first).photons, 400_000);
    // Time for camera samples and their shadow rays belongs to the rest: 1 + 8 samples of 0.1 + 2 · 0.05 s.
    let first = FirstPass {
        photon_seconds: 0.1,
        once_seconds: 1.1,
        camera_seconds: 0.1,
        shadow_ray_seconds: 0.05,
        ..FirstPass::default()
    };
    let settings = Settings { camera_samples: 8, shadow_rays: 2, ..Settings::default() };
    assert!((first.seconds_of_others(&settings) - 2.6).abs() < 1e-12);
}

#[test]
fn radii_per_pixel_need_an_estimator_that_has_them() {
    let first = FirstPass { caustic_pixels: 1.0, ..FirstPass::default() };
    let of = |settings: Settings| settings.for_time(&within(None, true, OPEN), &first).bandwidth;
    assert_eq!(of(Settings::default()), Bandwidth::PerPixel);
    let knn = Estimator::Knn { k: 50, max_radius: None };
    for other in [
        Settings { estimator: knn, ..Settings::default() },
        Settings { indirect: Indirect::Gather, ..Settings::default() },
        Settings { memory: Some(1 << 30), ..Settings::default() },
    ] {
        assert_eq!(of(other), Bandwidth::Shared);
    }
}

#[test]
fn people_read_settings_and_reasons() {
    let first = FirstPass { caustic_pixels: 0.08, direct: 0.3, indirect: 0.7, ..FirstPass::default() };
    let settings = Settings { photons: 1000, indirect: Indirect::Gather, ..Settings::default() };
    let text = Decision { settings, first }.to_string();
    assert_eq!(text.lines().count(), 2, "{text}");
    assert!(text.contains("1000 paths and 1 camera sample a pass") && text.contains("16 final-gather rays"), "{text}");
    assert!(text.contains("8 % of the pixels show caustics") && text.contains("30 % is direct, 70 %"), "{text}");
}

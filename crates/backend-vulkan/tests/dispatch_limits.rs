//! Work is divided into several dispatches, so that none runs for seconds; the image does not depend on it.
#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use backend_cpu::Cpu;
use backend_vulkan::low_level::{self, DispatchLimits};
use photon_core::{
    Backend, Budget, Estimate, EstimateParams, Film, IndexKind, Indirect, Photon, Pipeline, Query, Render, Search,
    Settings, View, render,
};

fn film(dispatch_limits: DispatchLimits, width: u32, height: u32) -> Film {
    let settings = Settings {
        photons: 3000,
        indirect: Indirect::Gather,
        gather_rays: 5,
        shadow_rays: 7,
        index: IndexKind::Morton,
        ..Settings::default()
    };
    film_of("cornell-glass", settings, dispatch_limits, width, height)
}

fn film_of(scene: &str, settings: Settings, dispatch_limits: DispatchLimits, width: u32, height: u32) -> Film {
    let mut on = low_level::for_tests().unwrap();
    low_level::set_dispatch_limits(&mut on, dispatch_limits);
    let scene = photon_scene::builtin(scene).unwrap().build().unwrap();
    let view = View { camera: scene.camera(None, width, height).unwrap(), width, height };
    let mut renderer = Pipeline::new(on, &scene.view(), view, settings).unwrap();
    render(&mut renderer, Budget::passes(2), &mut ()).unwrap();
    renderer.film().unwrap()
}

/// Largest relative difference of two images.
fn apart(a: &Film, b: &Film) -> f64 {
    let values = |film: &Film| -> Vec<f64> { film.pixels.iter().flat_map(|p| p.layers).flatten().collect() };
    let relative = |(a, b): (f64, f64)| if a == b { 0.0 } else { (a - b).abs() / a.abs().max(b.abs()) };
    values(a).into_iter().zip(values(b)).map(relative).fold(0.0, f64::max)
}

/// Rows and queries may be divided anywhere without changing a bit. If the rays of one query are divided too,
/// sums of a dozen terms are rounded differently, and so are sums over photons, since other queries share a
/// tile.
#[test]
fn pictures_do_not_depend_on_portions() {
    if low_level::for_tests().is_none() {
        return;
    }
    let default = DispatchLimits::default();
    let whole = film(default, 17, 13);
    let rows = DispatchLimits { pixels: 100, places: 300, shadow_rays: 1000, ..default };
    assert!(film(rows, 17, 13).pixels == whole.pixels);
    let rays = DispatchLimits { shadow_rays_of_query: 3, gather_rays: 999, gather_rays_of_query: 2, ..rows };
    assert!(apart(&film(rays, 17, 13), &whole) < 1e-5);
    // The smallest possible limits.
    let tiny = film(default, 6, 5);
    let least = DispatchLimits { pixels: 1, places: 1, shadow_rays: 1, ..default };
    assert!(film(least, 6, 5).pixels == tiny.pixels);
    // A difference is detected.
    let mut other = tiny.clone();
    for pixel in &mut other.pixels {
        pixel.layers[1][0] *= 1.0001;
    }
    assert!(apart(&tiny, &other) > 1e-5);
}

/// Camera samples may be traced together in any number, without changing a bit: rough glass, segments in media beside surfaces,
/// wavelengths.
#[test]
fn pictures_do_not_depend_on_samples_that_are_traced_together() {
    if low_level::for_tests().is_none() {
        return;
    }
    let default = DispatchLimits::default();
    for scene in ["frosted-glass", "ring", "glass-fog", "prism"] {
        let together = 1 << 20;
        let of = |camera_samples, pixels_of_samples| {
            let settings = Settings { photons: 500, camera_samples, ..Settings::default() };
            film_of(scene, settings, DispatchLimits { pixels_of_samples, ..default }, 9, 7)
        };
        let all = of(6, together);
        assert!([1, 2 * 63].map(|limit| of(6, limit).pixels == all.pixels) == [true; 2], "{scene}");
        // A difference is detected.
        assert!(of(5, together).pixels != all.pixels, "{scene}");
    }
}

fn ask<B: Backend>(on: &mut B, photons: &[Photon], queries: &[Query]) -> Vec<Estimate> {
    let mut stages = on.map_stages(IndexKind::Morton).unwrap();
    let there = on.upload("photons", photons).unwrap();
    let asked = on.upload("queries", queries).unwrap();
    let mut estimates = on.alloc("estimates", queries.len() as u64).unwrap();
    let map = stages.builder.build(on, there).unwrap();
    let gather = EstimateParams::new(Search::Radius);
    stages.estimator.estimate(on, &map, &asked, &gather, &mut estimates).unwrap();
    let mut found = Vec::new();
    on.download(&estimates, &mut found).unwrap();
    found
}

/// More queries than one dispatch processes, sorted and unsorted.
#[test]
fn more_queries_than_a_dispatch_takes() {
    let Some(mut on) = low_level::for_tests() else { return };
    let at = |i: u32, side: u32| [(i % side) as f32 / side as f32, 0.0, (i / side) as f32 / side as f32];
    let photons: Vec<_> = (0..900)
        .map(|i| Photon { position: at(i, 30), power: [1.0, (i % 3) as f32, 0.5], ..Photon::default() })
        .collect();
    let query = |i: u64| Query { position: at((i * 7919 % 640_000) as u32, 800), radius: 0.05, ..Query::default() };
    let queries: Vec<Query> = (0..600_000).map(query).collect();
    let expected = ask(&mut Cpu::with_threads(2).unwrap(), &photons, &queries);
    let found = ask(&mut on, &photons, &queries);
    // Sums of halves are exact.
    let differs = expected.iter().zip(&found).position(|(a, b)| a != b);
    assert_eq!(differs.map(|i| (i, expected[i], found[i])), None);
    assert_eq!(found.len(), queries.len());
    assert!(found.iter().all(|estimate| estimate.photons > 0));
}

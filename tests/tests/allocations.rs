//! Fault injection on the CPU: each large allocation of a render fails once. All are typed errors; an allocation that cannot
//! fail would abort this test.
#![allow(unsafe_code, reason = "an allocator that fails")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use backend_cpu::Cpu;
use backend_cpu::index::{IndexError, IndexKind, PointIndex};
use photon_core::{
    Area, Bandwidth, Budget, CausticPhotons, Error, Estimator, Indirect, Pipeline, Render, Settings, View, render,
};
use photon_scene::{MaterialDesc, Scene, SceneBuilder, Surface, shapes};

/// Allocations from this size on fail, bytes.
const LARGE: usize = 64 << 10;

/// Number of large allocations so far.
static COUNT: AtomicU64 = AtomicU64::new(0);
/// Number of the one that fails.
static FAILS: AtomicU64 = AtomicU64::new(u64::MAX);

struct Failing;

/// Whether an allocation that grows to `size` may proceed.
fn allowed(size: usize) -> bool {
    size < LARGE || COUNT.fetch_add(1, Ordering::Relaxed) != FAILS.load(Ordering::Relaxed)
}

// SAFETY: all calls go to the system's allocator unchanged, or fail.
unsafe impl GlobalAlloc for Failing {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        if allowed(layout.size()) { unsafe { System.alloc(layout) } } else { std::ptr::null_mut() }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        if allowed(layout.size()) { unsafe { System.alloc_zeroed(layout) } } else { std::ptr::null_mut() }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as the caller promises.
        if allowed(size) { unsafe { System.realloc(memory, layout, size) } } else { std::ptr::null_mut() }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Failing = Failing;

/// Fails each large allocation of `run` once; returns their number.
fn fail_each(name: &str, mut run: impl FnMut() -> Result<(), Error>) -> u64 {
    for at in 0.. {
        FAILS.store(COUNT.load(Ordering::Relaxed) + at, Ordering::Relaxed);
        let result = run();
        let is_reached = COUNT.load(Ordering::Relaxed) > FAILS.load(Ordering::Relaxed);
        FAILS.store(u64::MAX, Ordering::Relaxed);
        match result {
            Ok(()) => {
                assert!(!is_reached, "{name}: allocation {at} failed, and nobody says so");
                return at;
            }
            Err(error) => {
                assert!(is_reached && matches!(error, Error::OutOfMemory { .. }), "{name}: allocation {at}: {error}");
            }
        }
    }
    unreachable!("a run ends")
}

/// A room with a glass ball, of few triangles: the memory of the library that builds trees is checked, not its own.
fn room() -> Scene {
    let mut scene = SceneBuilder::new();
    let grey = scene.material(MaterialDesc::lambert("grey", [0.5; 3]));
    let lamp = scene.material(MaterialDesc::emissive("lamp", [0.5; 3], [10.0; 3]));
    let glass = Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [1.0; 3], roughness: 0.0 };
    let glass = scene.material(MaterialDesc::new("glass", glass));
    let square = |y: f64, h: f64| [[-h, y, h], [h, y, h], [h, y, -h], [-h, y, -h]];
    scene.quad("floor", square(0.0, 1.0), grey);
    let mut down = square(1.9, 0.4);
    down.reverse();
    scene.quad("lamp", down, lamp);
    let (positions, triangles) = shapes::icosphere(1, [0.0, 0.6, 0.0], 0.4);
    scene.mesh("ball", positions, triangles, glass);
    let camera = scene.frame_camera();
    scene.camera("camera", camera);
    scene.build().expect("a valid scene")
}

fn picture(scene: &Scene, settings: &Settings) -> Result<(), Error> {
    let view = View { camera: scene.camera(None, 96, 96).expect("a camera"), width: 96, height: 96 };
    let mut renderer = Pipeline::new(Cpu::with_threads(2)?, &scene.view(), view, settings.clone())?;
    render(&mut renderer, Budget::passes(2), &mut ())?;
    let film = renderer.film()?;
    film.try_clone().map(drop)
}

fn out_of_memory(error: IndexError) -> Error {
    match error {
        IndexError::OutOfMemory(why) => why.into(),
        other => panic!("{other}"),
    }
}

/// One test, since all threads of a process share its allocator.
#[test]
fn every_large_allocation_may_fail() {
    // A failure that is swallowed must be seen.
    let swallowed = || {
        drop(Vec::<u8>::new().try_reserve_exact(LARGE));
        Ok(())
    };
    assert!(std::panic::catch_unwind(|| fail_each("swallowed", swallowed)).is_err());

    let scene = room();
    let base = Settings {
        photons: 20_000,
        // The memory for choosing where photons are aimed is checked as a whole before.
        caustic_photons: CausticPhotons::Shared,
        area: Area::Surface,
        ..Settings::default()
    };
    let kinds = [
        ("radii per pixel", Settings { bandwidth: Bandwidth::PerPixel, errors: true, ..base.clone() }),
        ("final gathering", Settings { indirect: Indirect::Gather, gather_rays: 1, ..base.clone() }),
        ("k nearest", Settings { estimator: Estimator::Knn { k: 20, max_radius: None }, area: Area::Disc, ..base }),
    ];
    for (name, settings) in kinds {
        let count = fail_each(name, || picture(&scene, &settings));
        assert!(count > 5, "{name}: {count} large allocations");
    }
    let points: Vec<[f32; 3]> =
        (0..20_000).map(|i| [(i % 137) as f32, (i % 211) as f32, i as f32].map(|x| x * 1e-4)).collect();
    let mut rows = vec![0_u32; 8 * points.len()];
    for kind in [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton] {
        let count = fail_each(&format!("{kind:?}"), || {
            let index = PointIndex::build(&points, kind).map_err(out_of_memory)?;
            index.nearest_many(&points, 8, 1.0, &mut rows).map_err(out_of_memory)
        });
        assert!(count > 0, "{kind:?}");
    }
}

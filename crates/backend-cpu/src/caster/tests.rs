use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use photon_core::{
    Area, Backend as _, Batch, Error, Estimator, Film, Indirect, MediaDeposits, Pass, PerMap, Photon, PhotonRay,
    Pipeline, RandomKind, Render, Requirements, Result, SceneView, Scheduling, Settings, TransportBackend as _, View,
    glam::Vec3,
};
use photon_scene::{Accel, ThinLens, builtin};

use super::*;
use crate::Cpu;

/// The built-in ray caster, which counts calls and rays.
struct Counted {
    accel: Accel,
    batches: bool,
    calls: Arc<[AtomicUsize; 2]>,
}

impl RayCaster for Counted {
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        self.accel.nearest(ray)
    }
    fn nearest_where(&self, ray: &Ray, keep: &dyn Fn(&Hit) -> bool) -> Result<Option<Hit>, SkipLimit> {
        self.accel.nearest_where(ray, keep)
    }
    fn nearest_many(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.calls[0].fetch_add(1, Ordering::Relaxed);
        self.calls[1].fetch_add(rays.len(), Ordering::Relaxed);
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.accel.nearest(ray));
    }
    fn prefers_batches(&self) -> bool {
        self.batches
    }
}

/// Two passes of a built-in scene, with the ray caster of `make` if there is one.
fn film<F>(name: &str, settings: &Settings, make: Option<F>) -> Result<Film>
where
    F: Fn(&SceneView<'_>) -> Result<Box<dyn RayCaster>> + Send + 'static,
{
    let scene = builtin(name).unwrap().build().unwrap();
    let lens = ThinLens::new(if name == "gloss" { 0.05 } else { 0.0 }, 3.0);
    let camera = scene.camera_with_lens(None, lens, 24, 16).unwrap();
    let mut cpu = Cpu::with_threads(2)?;
    if let Some(make) = make {
        cpu = cpu.with_caster(make);
    }
    let view = View { camera, width: 24, height: 16 };
    let mut renderer = Pipeline::new(cpu, &scene.view(), view, settings.clone())?;
    for index in 0..2 {
        renderer.pass(index, &mut ())?;
    }
    renderer.film()
}

type Make = fn(&SceneView<'_>) -> Result<Box<dyn RayCaster>>;

fn counted(
    batches: bool,
    calls: &Arc<[AtomicUsize; 2]>,
) -> impl Fn(&SceneView<'_>) -> Result<Box<dyn RayCaster>> + use<> {
    let calls = calls.clone();
    move |view| {
        let accel = Accel::build(view.positions, view.triangles).unwrap();
        Ok(Box::new(Counted { accel, batches, calls: calls.clone() }))
    }
}

#[test]
fn batches_change_no_bit() {
    let plain = Settings { photons: 2000, ..Settings::default() };
    let random = Settings { random: RandomKind::Lcg, scheduling: Scheduling::Static, ..plain.clone() };
    let gather = Settings { indirect: Indirect::Gather, gather_rays: 2, ..plain.clone() };
    for (name, settings) in [("cornell-glass", &random), ("gloss", &plain), ("cornell", &gather)] {
        let expected = film(name, settings, None::<Make>).unwrap();
        for batches in [false, true] {
            let calls = Arc::new([const { AtomicUsize::new(0) }; 2]);
            let found = film(name, settings, Some(counted(batches, &calls))).unwrap();
            assert!(found == expected, "{name}, batches {batches}: another picture");
            let [calls, rays] = [0, 1].map(|at: usize| calls[at].load(Ordering::Relaxed));
            assert_eq!(calls > 0, batches, "{name}");
            assert!(!batches || rays > 20 * calls, "{name}: {rays} rays in {calls} calls");
        }
    }
}

/// The photons of a batch, as they are stored.
fn photons(name: &str, batches: bool) -> PerMap<Vec<Photon>> {
    let scene = builtin(name).unwrap().build().unwrap();
    let (view, settings) = (scene.view(), Settings::default());
    let calls = Arc::new([const { AtomicUsize::new(0) }; 2]);
    let mut cpu = Cpu::with_threads(2).unwrap().with_caster(counted(batches, &calls));
    let mut required = Requirements::of(&view, &settings);
    required.maps = PerMap::splat(true);
    let prepared = cpu.prepare(&view, &required).unwrap();
    let mut stages = cpu.stages(&required, &settings).unwrap();
    let batch =
        Batch { pass: Pass { seed: 1, index: 0, random: RandomKind::Counter, sample: 0, samples: 1 }, paths: 0..5000 };
    let mut rays = cpu.alloc::<PhotonRay>("rays", 5000).unwrap();
    stages.emitter.emit(&mut cpu, &prepared, &batch, &mut rays).unwrap();
    let mut maps = PerMap::from_fn(|kind| cpu.alloc::<Photon>(kind.label(), 50_000).unwrap());
    stages
        .tracer
        .trace(&mut cpu, &prepared, &batch, &rays, maps.each_mut().map(Some), MediaDeposits::default())
        .unwrap();
    assert_eq!(calls[0].load(Ordering::Relaxed) > 0, batches);
    maps.map(|photons| photons.as_slice().to_vec())
}

#[test]
fn photons_of_batches_are_stored_in_the_order_of_their_paths() {
    let (one_by_one, in_batches) = (photons("cornell-glass", false), photons("cornell-glass", true));
    assert!(one_by_one.values().all(|photons| photons.len() > 50));
    assert!(one_by_one == in_batches);
}

#[test]
fn batches_are_not_used_where_surfaces_have_alpha() {
    let calls = Arc::new([const { AtomicUsize::new(0) }; 2]);
    let mut scene = builtin("cornell").unwrap();
    let desc = &mut scene.materials_mut()[0];
    (desc.alpha_mode, desc.alpha) = (photon_scene::AlphaMode::Blend, 0.5);
    let scene = scene.build().unwrap();
    let view = View { camera: scene.camera(None, 8, 8).unwrap(), width: 8, height: 8 };
    let cpu = Cpu::with_threads(1).unwrap().with_caster(counted(true, &calls));
    let settings = Settings { photons: 100, ..Settings::default() };
    Pipeline::new(cpu, &scene.view(), view, settings).unwrap().pass(0, &mut ()).unwrap();
    assert_eq!(calls[0].load(Ordering::Relaxed), 0);
}

/// Gives up on rays that do not start at `from`.
struct GivesUp {
    accel: Accel,
    from: Vec3,
}

impl RayCaster for GivesUp {
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        self.accel.nearest(ray)
    }
    fn nearest_where(&self, ray: &Ray, keep: &dyn Fn(&Hit) -> bool) -> Result<Option<Hit>, SkipLimit> {
        if ray.origin == self.from { self.accel.nearest_where(ray, keep) } else { Err(SkipLimit) }
    }
}

/// Camera paths, final-gather rays and photon paths that end at the limit of surfaces that are not there are counted.
#[test]
fn paths_that_a_caster_gives_up_are_counted() {
    let mut scene = builtin("cornell").unwrap();
    let desc = &mut scene.materials_mut()[0];
    (desc.alpha_mode, desc.alpha) = (photon_scene::AlphaMode::Blend, 0.5);
    let scene = scene.build().unwrap();
    let view = View { camera: scene.camera(None, 8, 8).unwrap(), width: 8, height: 8 };
    let estimator = Estimator::Radius { radius: Some(0.1) };
    let settings =
        Settings { photons: 100, estimator, indirect: Indirect::Gather, gather_rays: 4, ..Settings::default() };
    for from in [Vec3::from(view.camera.origin), Vec3::INFINITY] {
        let make = move |view: &SceneView<'_>| -> Result<Box<dyn RayCaster>> {
            Ok(Box::new(GivesUp { accel: Accel::build(view.positions, view.triangles).unwrap(), from }))
        };
        let cpu = Cpu::with_threads(1).unwrap().with_caster(make);
        let mut pipeline = Pipeline::new(cpu, &scene.view(), view, settings.clone()).unwrap();
        let photon_core::PassEnd::Done(report) = pipeline.pass(0, &mut ()).unwrap() else { unreachable!() };
        let expected = if from.is_finite() { 4 * report.queries } else { 64 };
        assert!(expected > 0 && report.truncated_camera_paths == expected, "{report:?}");
        assert_eq!((report.tally.truncated, report.tally.balances()), (report.tally.emitted, true));
    }
}

/// Counts rays, and knows which triangles are near or does not.
struct Near {
    accel: Accel,
    knows: bool,
    rays: Arc<AtomicUsize>,
}

impl RayCaster for Near {
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        self.rays.fetch_add(1, Ordering::Relaxed);
        self.accel.nearest(ray)
    }
    fn overlapping<'a>(&self, low: Vec3, high: Vec3, room: &'a mut [u32]) -> Option<&'a [u32]> {
        if self.knows { self.accel.overlapping(low, high, room) } else { None }
    }
}

/// Discs that one triangle holds need no probes, and have the same areas: with and without error moments, on surfaces of all
/// kinds, with reflections, and where photons far off the plane do not count.
#[test]
fn areas_without_probes_change_no_bit() {
    // A small radius, since the one derived from so few photons reaches past most triangles.
    let estimator = Estimator::Radius { radius: Some(0.05) };
    let plain = Settings {
        photons: 4000,
        area: Area::Surface,
        estimator,
        max_plane_distance: Some(1.0),
        ..Settings::default()
    };
    for (name, settings) in [
        ("cornell", Settings { errors: true, ..plain.clone() }),
        ("cornell-glass", plain.clone()),
        ("gloss", Settings { errors: true, ..plain.clone() }),
        ("two-rooms", Settings { max_plane_distance: Some(0.1), ..plain.clone() }),
        ("gloss", Settings { max_plane_distance: None, ..plain.clone() }),
    ] {
        let rays = [false, true].map(|knows| {
            let rays = Arc::new(AtomicUsize::new(0));
            let count = rays.clone();
            let make = move |view: &SceneView<'_>| -> Result<Box<dyn RayCaster>> {
                let accel = Accel::build(view.positions, view.triangles).unwrap();
                Ok(Box::new(Near { accel, knows, rays: count.clone() }))
            };
            let found = film(name, &settings, Some(make)).unwrap();
            assert!(found == film(name, &settings, None::<Make>).unwrap(), "{name}, {knows}: another picture");
            rays.load(Ordering::Relaxed)
        });
        // Seventeen rays for each of forty discs, at least.
        assert!(rays[1] + 40 * 17 < rays[0], "{name}: {rays:?} rays");
    }
}

/// Returns the same for every ray, or panics.
#[derive(Clone, Copy)]
struct Faulty(Option<Hit>, bool);

impl RayCaster for Faulty {
    fn nearest(&self, _ray: &Ray) -> Option<Hit> {
        Some(self.0.unwrap_or_else(|| std::panic::resume_unwind(Box::new("its tree is broken"))))
    }
    fn prefers_batches(&self) -> bool {
        self.1
    }
}

#[test]
fn invalid_hits_and_panics_are_errors_by_name() {
    let good = Hit { t: 0.1, primitive: 0, u: 0.2, v: 0.2 };
    let cases = [
        (Some(Hit { t: f32::NAN, ..good }), "t = NaN"),
        (Some(Hit { t: -0.5, ..good }), "t = -0.5"),
        (Some(Hit { t: f32::INFINITY, ..good }), "t = inf"),
        (Some(Hit { primitive: 1 << 20, ..good }), "triangle 1048576, but there are "),
        (Some(Hit { u: f32::NAN, ..good }), "u = NaN"),
        (Some(Hit { v: 1.5, ..good }), "v = 1.5"),
        (None, "panicked: its tree is broken"),
    ];
    let settings = Settings { photons: 500, ..Settings::default() };
    for batches in [false, true] {
        for (hit, culprit) in cases {
            let make = move |_: &SceneView<'_>| Ok(Box::new(Faulty(hit, batches)) as Box<dyn RayCaster>);
            let error = film("cornell", &settings, Some(make)).unwrap_err();
            let Error::Backend { backend, source } = &error else { panic!("{error:?}") };
            let text = format!("{backend}: {source}");
            assert!(text.contains("ray caster") && text.contains(culprit), "{text}");
        }
    }
    // A valid hit is no error.
    let make = move |_: &SceneView<'_>| Ok(Box::new(Faulty(Some(good), true)) as Box<dyn RayCaster>);
    film("cornell", &settings, Some(make)).unwrap();
}

#[test]
fn an_error_is_reported_once_and_hits_beyond_the_end_do_not_count() {
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z, t_max: 1.0 };
    let hit = |t: f32| Hit { t, primitive: 0, u: 0.0, v: 0.0 };
    let checked = Checked::new(Box::new(Faulty(Some(hit(2.0)), false)), 1);
    assert!(checked.nearest(&ray).is_none() && checked.take_error().is_none());
    let checked = Checked::new(Box::new(Faulty(Some(hit(0.5)), false)), 0);
    assert!(checked.nearest(&ray).is_none());
    assert_eq!(checked.nearest_where(&ray, &|_| true), Ok(None));
    assert!(checked.take_error().is_some() && checked.take_error().is_none());
}

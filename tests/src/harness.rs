//! The test interface of a backend, and helpers to run its stages.

use std::any::{Any, TypeId};
use std::cell::RefCell;
use std::collections::HashMap;
use std::marker::PhantomData;
use std::ops::Range;

use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{
    Backend, Batch, Direct, Estimate, EstimateParams, Estimator, Film, IndexKind, Indirect, MediaDeposits, Pass,
    PerMap, Photon, PhotonRay, Pipeline, Query, RandomKind, Render, Requirements, Settings, Stages, Tally,
    TransportBackend, View, octahedral,
};
use photon_scene::{CameraDesc, Projection, Scene, SceneBuilder};

/// A backend under test.
pub trait TestBackend: 'static {
    /// The backend's type.
    type On: TransportBackend + 'static;
    /// Statistical tests trace one of so many photons. A backend whose paths and pictures are compared with those of the CPU, where
    /// the tests run in full, needs fewer to tell a fault of its own; tolerances follow from the standard error.
    const ONE_OF: u32 = 1;
    /// Creates a new backend; `threads` is used where it applies.
    fn make(threads: usize) -> Self::On;
    /// Whether the backend is available; if not, the reason is printed to standard error.
    fn available() -> bool {
        true
    }
    /// Panics if the backend has noticed a fault.
    fn check(_on: &Self::On) {}
}

thread_local! {
    static KEPT: RefCell<HashMap<TypeId, Box<dyn Any>>> = RefCell::default();
}

/// A backend that this test may have used before: opening a device and its kernels takes longer than most renders.
pub fn opened<T: TestBackend>() -> T::On {
    let kept = KEPT.with_borrow_mut(|kept| kept.remove(&TypeId::of::<T>()));
    kept.and_then(|on| on.downcast().ok()).map_or_else(|| T::make(2), |on| *on)
}

/// Drops the backends that were kept, which panics if one has noticed a fault.
pub fn drop_kept() {
    drop(KEPT.take());
}

/// Keeps a backend for [`opened`].
pub fn keep<T: TestBackend>(on: T::On) {
    T::check(&on);
    KEPT.with_borrow_mut(|kept| kept.insert(TypeId::of::<T>(), Box::new(on)));
}

/// A backend for tests that need all photons: of rare events, or whose noise would hide what they look for.
#[derive(Clone, Copy, Debug)]
pub struct InFull<T>(PhantomData<T>);

impl<T: TestBackend> TestBackend for InFull<T> {
    type On = T::On;

    fn make(threads: usize) -> T::On {
        T::make(threads)
    }

    fn check(on: &T::On) {
        T::check(on);
    }
}

/// A deterministic stream of uniform random numbers.
#[derive(Debug)]
pub struct Uniform {
    sampler: Sampler,
    block: u32,
    words: [u32; 4],
    left: usize,
}

impl Uniform {
    /// The stream with this seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let sampler = Sampler::new(RandomKind::Counter, seed, 0, Domain::Gather, 0);
        Self { sampler, block: 0, words: [0; 4], left: 0 }
    }

    /// The next number, in `[0, 1)`.
    pub fn draw(&mut self) -> f64 {
        if self.left == 0 {
            self.words = self.sampler.words(self.block);
            self.block += 1;
            self.left = 4;
        }
        self.left -= 1;
        f64::from(self.words[self.left]) / 4_294_967_296.0
    }
}

/// A photon of unit power that arrived vertically on the plane z = 0.
#[must_use]
pub fn photon_at(position: [f32; 3]) -> Photon {
    let up = octahedral::pack(photon_core::glam::Vec3::Z);
    Photon { position, direction: up, power: [1.0; 3], normal: up }
}

/// A query on the plane z = 0.
#[must_use]
pub fn query_at(position: [f32; 3], radius: f32) -> Query {
    Query { position, radius, normal: [0.0, 0.0, 1.0], throughput: [1.0; 3], ..Query::default() }
}

/// Estimates from a map of `photons` at `queries`.
pub fn estimate<T: TestBackend>(
    kind: IndexKind,
    photons: &[Photon],
    queries: &[Query],
    gather: &EstimateParams,
) -> Vec<Estimate> {
    estimates::<T>(kind, photons, queries, std::slice::from_ref(gather)).concat()
}

/// Estimates from one map of `photons` at `queries`, once per set of parameters.
pub fn estimates<T: TestBackend>(
    kind: IndexKind,
    photons: &[Photon],
    queries: &[Query],
    gathers: &[EstimateParams],
) -> Vec<Vec<Estimate>> {
    let mut on = opened::<T>();
    let found = estimates_on(&mut on, kind, photons, queries, gathers);
    on.reset().unwrap();
    keep::<T>(on);
    found
}

/// The same on a backend of the caller.
pub fn estimates_on<B: TransportBackend>(
    on: &mut B,
    kind: IndexKind,
    photons: &[Photon],
    queries: &[Query],
    gathers: &[EstimateParams],
) -> Vec<Vec<Estimate>> {
    let mut stages = on.map_stages(kind).unwrap();
    let photons = on.upload("photons", photons).unwrap();
    let queries_there = on.upload("queries", queries).unwrap();
    let mut estimates = on.alloc("estimates", queries.len() as u64).unwrap();
    let map = stages.builder.build(on, photons).unwrap();
    let ask = |gather| {
        stages.estimator.estimate(on, &map, &queries_there, gather, &mut estimates).unwrap();
        let mut found = Vec::new();
        on.download(&estimates, &mut found).unwrap();
        found
    };
    gathers.iter().map(ask).collect()
}

/// Settings without indirect light, and with this radius of estimates in every pass.
#[must_use]
pub fn direct_settings(direct: Direct, radius: f64) -> Settings {
    Settings {
        direct,
        indirect: Indirect::None,
        photons: 20_000,
        alpha: 1.0,
        estimator: Estimator::Radius { radius: Some(radius) },
        ..Settings::default()
    }
}

/// Traces photons; returns those of each map, in normalised space, and the tally.
pub fn trace<T: TestBackend>(
    threads: usize,
    scene: &Scene,
    settings: &Settings,
    batches: &[u32],
) -> (PerMap<Vec<Photon>>, Tally) {
    let total: u32 = batches.iter().sum();
    // As many as a path stores in a sealed scene, and no more than a buffer of Vulkan holds.
    let capacity = (u64::from(total) * u64::from(settings.max_bounces.min(256)) + 1).min(1 << 25);
    let mut tracing = Tracing::new(T::make(threads), scene, settings, capacity);
    let mut rays = tracing.on.alloc::<PhotonRay>("rays", u64::from(total)).unwrap();
    let mut first = 0;
    for &count in batches {
        let batch = Batch { pass: tracing.pass, paths: first..first + count };
        tracing.stages.emitter.emit(&mut tracing.on, &tracing.prepared, &batch, &mut rays).unwrap();
        tracing.follow(batch.paths, &rays);
        first += count;
    }
    tracing.end()
}

/// A backend with a prepared scene and buffers for the photons of all maps.
#[expect(missing_debug_implementations, reason = "boxed stages")]
pub struct Tracing<B: TransportBackend> {
    /// The backend.
    pub on: B,
    prepared: B::Scene,
    stages: Stages<B>,
    pass: Pass,
    photons: PerMap<B::Buffer<Photon>>,
}

impl<B: TransportBackend> Tracing<B> {
    /// Prepares the first pass, with room for `capacity` photons in each map.
    pub fn new(mut on: B, scene: &Scene, settings: &Settings, capacity: u64) -> Self {
        let view = scene.view();
        let mut required = Requirements::of(&view, settings);
        required.maps = PerMap::splat(true);
        let prepared = on.prepare(&view, &required).unwrap();
        let stages = on.stages(&required, settings).unwrap();
        let pass = Pass { seed: settings.seed, index: 0, random: settings.random, sample: 0, samples: 1 };
        let photons = PerMap::from_fn(|kind| on.alloc(kind.name(), capacity).unwrap());
        Self { on, prepared, stages, pass, photons }
    }

    /// Traces `rays`, which are the first rays of `paths`.
    pub fn follow(&mut self, paths: Range<u32>, rays: &B::Buffer<PhotonRay>) {
        let deposits = self.photons.each_mut().map(Some);
        let batch = Batch { pass: self.pass, paths };
        self.stages
            .tracer
            .trace(&mut self.on, &self.prepared, &batch, rays, deposits, MediaDeposits::default())
            .unwrap();
    }

    /// The photons of each map, and the tally.
    pub fn end(mut self) -> (PerMap<Vec<Photon>>, Tally) {
        let tally = self.stages.tracer.take_tally(&mut self.on).unwrap();
        let photons = self.photons.map(|buffer| {
            let mut out = Vec::new();
            self.on.download(&buffer, &mut out).unwrap();
            out
        });
        (photons, tally)
    }
}

/// A sum of flux from the tally per emitted path, in watts, mean of RGB.
#[must_use]
pub fn watts(scene: &Scene, tally: &Tally, sum: &photon_core::FluxSum) -> f64 {
    sum.value().iter().sum::<f64>() / 3.0 / tally.emitted as f64 * scene.units().power
}

/// Renders an image of `size × size` pixels with the scene's first camera.
pub fn film<T: TestBackend>(scene: &Scene, settings: &Settings, passes: u32, size: u32) -> Film {
    let mut renderer = renderer::<T>(scene, settings, size);
    for pass in 0..passes {
        renderer.pass(pass, &mut ()).unwrap();
    }
    let film = renderer.film().unwrap();
    keep::<T>(renderer.into_backend().unwrap());
    film
}

/// A pipeline for such an image.
pub fn renderer<T: TestBackend>(scene: &Scene, settings: &Settings, size: u32) -> Pipeline<T::On> {
    let view = View { camera: scene.camera(None, size, size).unwrap(), width: size, height: size };
    Pipeline::new(opened::<T>(), &scene.view(), view, settings.clone()).unwrap()
}

/// Mean over the pixels of each pass, mean of RGB. Passes are independent; the pixels of one pass are not.
pub fn per_pass<T: TestBackend>(scene: &Scene, settings: &Settings, passes: u32, size: u32) -> Vec<f64> {
    let mean = |beauty: &[[f32; 3]]| {
        let sum = beauty.iter().flatten().map(|&c| f64::from(c)).sum::<f64>();
        vec![sum / (3 * beauty.len()) as f64]
    };
    means_per_pass::<T>(scene, settings, (passes, size), mean).swap_remove(0)
}

/// For each of several means over pixels of the picture, its value in each of the `passes`, of [`TestBackend::ONE_OF`] as many
/// photons if radii do not depend on their number.
pub fn means_per_pass<T: TestBackend>(
    scene: &Scene,
    settings: &Settings,
    (passes, size): (u32, u32),
    means: impl Fn(&[[f32; 3]]) -> Vec<f64>,
) -> Vec<Vec<f64>> {
    let mut settings = settings.clone();
    if matches!(settings.estimator, Estimator::Radius { radius: Some(_) }) {
        settings.photons = settings.photons.div_ceil(T::ONE_OF);
    }
    let mut renderer = renderer::<T>(scene, &settings, size);
    let (mut before, mut found) = (Vec::new(), Vec::new());
    for pass in 0..passes {
        renderer.pass(pass, &mut ()).unwrap();
        // The film has the mean over the passes.
        let sums = means(&renderer.film().unwrap().beauty()).into_iter().map(|mean| mean * f64::from(pass + 1));
        for (index, sum) in sums.enumerate() {
            if pass == 0 {
                before.push(0.0);
                found.push(Vec::new());
            }
            found[index].push(sum - std::mem::replace(&mut before[index], sum));
        }
    }
    keep::<T>(renderer.into_backend().unwrap());
    found
}

/// Adds a camera that looks perpendicularly at a small square of half side `half` around `point`, from distance
/// `away` along `normal`.
pub fn look_at_point(builder: &mut SceneBuilder, point: [f64; 3], normal: [f64; 3], away: f64, half: f64) {
    let position = std::array::from_fn(|axis| point[axis] + away * normal[axis]);
    let direction = normal.map(|n| -n);
    let up = if normal[1].abs() > 0.9 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
    let projection = Projection::Orthographic { half_height: half };
    builder.camera("point", CameraDesc::new(position, direction, up, projection));
}

/// A random word as a uniform number in `[0, 1)`, converted as in the kernels.
#[must_use]
pub fn unit(word: u32) -> f32 {
    unit_f32(word)
}

//! Photon tracing, compared with the CPU backend for the same random numbers, and with itself: however paths
//! are distributed, the same photons are stored in the same order.
#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use backend_cpu::Cpu;
use backend_vulkan::low_level::{self, TracePlan};
use photon_core::glam::Vec3;
use photon_core::{
    Batch, MapKind, MediaDeposits, Pass, PerMap, Photon, PhotonRay, RandomKind, Requirements, Scheduling, Settings,
    Tally, TransportBackend,
};
use photon_scene::{Scene, builtin};

const SCENES: [&str; 6] = ["cornell", "cornell-glass", "ring", "pool", "textures", "glass-fog"];
const PATHS: u32 = 20_000;

fn scene(name: &str) -> Scene {
    builtin(name).unwrap().build().unwrap()
}

fn settings() -> Settings {
    Settings { max_bounces: 40, ..Settings::default() }
}

/// Photons and statistics of some paths.
#[derive(Debug, PartialEq)]
struct TraceOutput {
    rays: Vec<PhotonRay>,
    photons: PerMap<Vec<Photon>>,
    in_media: PerMap<Vec<Photon>>,
    tally: Tally,
    /// Number of photons to be stored in each map, on surfaces and in media, whether or not they fit.
    needed: [PerMap<u64>; 2],
}

/// Parameters of a trace.
#[derive(Clone)]
struct How {
    settings: Settings,
    /// Index of the first path of each batch after the first.
    cuts: Vec<u32>,
    capacity: u64,
    random: RandomKind,
    paths: u32,
    /// Whether the direction of each ray is changed by one unit in the last place.
    is_nudged: bool,
    /// Whether photons are stored on surfaces, and in media.
    wanted: [bool; 2],
}

impl Default for How {
    fn default() -> Self {
        let random = RandomKind::Counter;
        Self {
            settings: settings(),
            cuts: Vec::new(),
            capacity: 1 << 20,
            random,
            paths: PATHS,
            is_nudged: false,
            wanted: [true; 2],
        }
    }
}

fn trace<B: TransportBackend>(on: &mut B, scene: &Scene, how: &How) -> TraceOutput {
    let view = scene.view();
    let required = Requirements::of(&view, &how.settings);
    let prepared = on.prepare(&view, &required).unwrap();
    let mut stages = on.stages(&required, &how.settings).unwrap();
    let mut buffers = [(); 2].map(|()| PerMap::from_fn(|kind| on.alloc::<Photon>(kind.name(), how.capacity).unwrap()));
    let mut all = Vec::new();
    let mut starts = vec![0];
    starts.extend(&how.cuts);
    starts.push(how.paths);
    for range in starts.windows(2) {
        let mut rays = on.alloc::<PhotonRay>("rays", u64::from(range[1] - range[0])).unwrap();
        let pass = Pass { seed: 11, index: 3, random: how.random, sample: 0, samples: 1 };
        let batch = Batch { pass, paths: range[0]..range[1] };
        stages.emitter.emit(on, &prepared, &batch, &mut rays).unwrap();
        let mut home = Vec::new();
        on.download(&rays, &mut home).unwrap();
        if how.is_nudged {
            home.iter_mut().for_each(|ray| ray.direction = ray.direction.map(f32::next_up));
            rays = on.upload("rays", &home).unwrap();
        }
        let [mut surfaces, mut media] = buffers.each_mut().map(|maps| maps.each_mut().map(Some));
        if !how.wanted[0] {
            surfaces = PerMap::default();
        }
        if !how.wanted[1] {
            media = PerMap::default();
        }
        // Light straight from a light source leaves no photons in media.
        let onto_surfaces = media[MapKind::Direct].take();
        let media = MediaDeposits { inside: media, onto_surfaces };
        stages.tracer.trace(on, &prepared, &batch, &rays, surfaces, media).unwrap();
        all.extend(home);
    }
    let needed = buffers.each_ref().map(|maps| maps.each_ref().map(|buffer| on.fill(buffer).unwrap().needed));
    let [photons, in_media] = [0, 1].map(|place: usize| {
        PerMap::from_fn(|kind| {
            let mut photons = Vec::new();
            if needed[place][kind] <= how.capacity {
                on.download(&buffers[place][kind], &mut photons).unwrap();
            }
            photons
        })
    });
    let tally = stages.tracer.take_tally(on).unwrap();
    TraceOutput { rays: all, photons, in_media, tally, needed }
}

fn near(a: [f32; 3], b: [f32; 3], bound: f32) -> bool {
    Vec3::from(a).distance(Vec3::from(b)) <= bound
}

/// Largest relative difference of the power of emitted photons. It is exact, except from a textured light: that
/// contains a division, which devices may round.
fn power_bound(scene: &str) -> f32 {
    if scene == "textures" { 1e-6 } else { 0.0 }
}

/// Whether two emitted rays are equal up to rounding, and their power up to `bound` of itself.
fn same_ray(a: &PhotonRay, b: &PhotonRay, bound: f32) -> bool {
    a.path == b.path
        && a.light == b.light
        && near(a.power, b.power, bound * Vec3::from(a.power).length())
        && near(a.origin, b.origin, 1e-5)
        && near(a.direction, b.direction, 1e-5)
}

/// Positions within 1e-4 of the scene's size, and equal power up to rounding.
fn same_photon(a: &Photon, b: &Photon) -> bool {
    near(a.position, b.position, 1e-4) && near(a.power, b.power, 1e-4)
}

/// Fraction of the photons of `a` with a match in `b`, both in path order. A photon that exists in only one of
/// them shifts the following ones, hence the search window.
fn share(a: &[Photon], b: &[Photon]) -> f64 {
    const WINDOW: usize = 64;
    let mut at = 0;
    let mut found = 0_usize;
    for photon in a {
        let rest = &b[at.min(b.len())..(at + WINDOW).min(b.len())];
        if let Some(ahead) = rest.iter().position(|other| same_photon(photon, other)) {
            at += ahead + 1;
            found += 1;
        }
    }
    found as f64 / a.len().max(b.len()).max(1) as f64
}

#[test]
fn photons_are_those_of_the_processor() {
    let Some(mut gpu) = low_level::for_tests() else { return };
    let mut cpu = Cpu::with_threads(2).unwrap();
    for (name, random) in
        SCENES.map(|name| (name, RandomKind::Counter)).into_iter().chain([("cornell", RandomKind::Lcg)])
    {
        let (scene, how) = (scene(name), How { random, ..How::default() });
        let (a, b) = (trace(&mut cpu, &scene, &how), trace(&mut gpu, &scene, &how));
        let nudged = trace(&mut cpu, &scene, &How { is_nudged: true, ..how });
        let bound = power_bound(name);
        let rays = a.rays.iter().zip(&b.rays).filter(|(a, b)| same_ray(a, b, bound)).count();
        assert_eq!(rays, PATHS as usize, "{name}: rays");
        assert!(b.tally.balances(), "{name}: {:?}", b.tally);
        let flux = [&a, &b].map(|traced| traced.tally.flux_emitted.value()[0]);
        assert!((flux[0] - flux[1]).abs() <= f64::from(bound) * flux[0], "{name}: {flux:?}");
        let places = |of: TraceOutput| [of.photons, of.in_media];
        let [a, b, nudged] = [a, b, nudged].map(places);
        assert_eq!(a[1].values().all(|photons| !photons.is_empty()), name == "glass-fog");
        for (place, (kind, ours)) in (0..2).flat_map(|place: usize| a[place].iter().map(move |of| (place, of))) {
            let (map, theirs) = (kind.name(), &b[place][kind]);
            let share = share(ours, theirs);
            let bits = ours.iter().zip(theirs).filter(|(a, b)| a == b).count();
            println!("{name}, {random:?}, {map} map: {} photons, {share:.5} near, {bits} the same", theirs.len());
            // A path that diverges once stays different. Reflection and refraction at curved surfaces amplify rounding
            // errors, of which there is one for each surface: so much also changes if each ray is nudged once.
            let nudged = self::share(ours, &nudged[place][kind]);
            println!("    {nudged:.5} near after a nudge");
            let bound = (0.002 + 3.0 * (1.0 - nudged)).min(0.05);
            assert!(1.0 - share < bound || ours.is_empty(), "{name}: {map} map: {share}");
        }
    }
}

#[test]
fn photons_of_other_paths_are_noticed() {
    let mut cpu = Cpu::with_threads(1).unwrap();
    let scene = scene("cornell");
    let a = trace(&mut cpu, &scene, &How::default());
    let b = trace(&mut cpu, &scene, &How { random: RandomKind::Lcg, ..How::default() });
    let (ours, theirs) = (&a.photons[MapKind::Global], &b.photons[MapKind::Global]);
    assert!(share(ours, theirs) < 0.01);
    let bounds = [power_bound("cornell"), power_bound("textures")];
    assert!(bounds.iter().all(|&bound| !same_ray(&a.rays[5], &b.rays[5], bound)));
    // The least difference of power is noticed where it is exact, and one of 1e-5 everywhere.
    let with_power = |of: fn(f32) -> f32| PhotonRay { power: a.rays[5].power.map(of), ..a.rays[5] };
    assert_eq!(bounds.map(|bound| same_ray(&a.rays[5], &with_power(f32::next_up), bound)), [false, true]);
    assert!(!same_ray(&a.rays[5], &with_power(|power| power * 1.000_01), bounds[1]));
    let mut brighter = ours.clone();
    brighter.iter_mut().for_each(|photon| photon.power[1] *= 1.01);
    assert!(share(ours, &brighter) < 0.1);
}

#[test]
fn the_way_of_sharing_does_not_show() {
    let Some(mut gpu) = low_level::for_tests() else { return };
    let usual = low_level::trace_plan(&gpu);
    let plain =
        TracePlan { group: 32, threads: 1 << 17, quota: 4, busy: 0, shared_groups: 0, surfaces: 16, places: 1 << 20 };
    for (name, max_bounces) in [("cornell-glass", 40), ("ring", 7), ("glass-fog", 40)] {
        let scene = scene(name);
        let how = |scheduling| How { settings: Settings { scheduling, max_bounces, ..settings() }, ..How::default() };
        low_level::set_trace_plan(&mut gpu, plain);
        let first = trace(&mut gpu, &scene, &how(Scheduling::Static));
        assert!(first.needed[0].values().sum::<u64>() > 5000, "{:?}", first.needed);
        for (scheduling, plan) in [
            (Scheduling::Static, plain),
            (Scheduling::Dynamic, plain),
            (Scheduling::Static, usual),
            (Scheduling::Dynamic, usual),
            (Scheduling::Static, TracePlan { threads: 3000, quota: 16, busy: 3, ..plain }),
            (Scheduling::Dynamic, TracePlan { surfaces: 3, busy: 3, ..plain }),
            (
                Scheduling::Dynamic,
                TracePlan { group: 64, threads: 3000, quota: 16, busy: 1000, shared_groups: 2, ..plain },
            ),
            // Chunks that store too many photons are shortened, and finally get a larger buffer.
            (Scheduling::Dynamic, TracePlan { places: 5000, ..plain }),
        ] {
            low_level::set_trace_plan(&mut gpu, plan);
            assert!(trace(&mut gpu, &scene, &how(scheduling)) == first, "{name}: {scheduling:?}, {plan:?}");
        }
        // Batches give the same result, whether or not they coincide with chunks.
        let cuts = vec![1, 77, 9000, 19_999];
        let parts = trace(&mut gpu, &scene, &How { cuts, ..how(Scheduling::Dynamic) });
        assert!(parts == first, "{name}: in batches");
        // Photons of one place are the same without the others.
        let only = |wanted| How { wanted, ..how(Scheduling::Dynamic) };
        let parts = [[true, false], [false, true]].map(|wanted| trace(&mut gpu, &scene, &only(wanted)));
        assert!([&parts[0].photons, &parts[1].in_media] == [&first.photons, &first.in_media], "{name}: one by one");
    }
}

#[test]
fn overflow_counts_what_there_was() {
    let Some(mut gpu) = low_level::for_tests() else { return };
    let scene = scene("cornell-glass");
    let all = trace(&mut gpu, &scene, &How::default());
    let few = trace(&mut gpu, &scene, &How { capacity: 100, cuts: vec![5000], ..How::default() });
    assert_eq!(few.needed, all.needed);
    assert_eq!(few.tally, all.tally);
}

/// Most paths end at the limit on bounces, whatever rounding does to their directions: the state of active
/// paths survives between dispatches.
#[test]
fn long_paths_are_followed_to_their_end() {
    let Some(mut gpu) = low_level::for_tests() else { return };
    let mut cpu = Cpu::with_threads(2).unwrap();
    let scene = photon_scene::furnace(0.999, photon_scene::FurnaceShape::Box).build().unwrap();
    let settings = Settings { max_bounces: 333, ..settings() };
    let how = How { settings, paths: 1000, ..How::default() };
    let (a, b) = (trace(&mut cpu, &scene, &how), trace(&mut gpu, &scene, &how));
    assert!(b.tally.balances());
    assert_eq!((b.tally.truncated, b.tally.surfaces), (a.tally.truncated, a.tally.surfaces));
    assert_eq!(b.needed, a.needed);
}

//! The shipped pipeline, path by path, and scenes to test it on.

use backend_cpu::Cpu;
use photon_core::glam::{DVec3, Vec3};
use photon_core::{
    Backend, Batch, MapKind, MediaDeposits, Pass, PerMap, Photon, PhotonRay, RandomKind, Requirements, Settings,
    TransportBackend, octahedral,
};
use photon_scene::shapes::Shape;
use photon_scene::{LightDesc, MaterialDesc, Scene, shapes};

use crate::twin::{Described, End, Landing, Twin, Wide, emit};

/// The pass that is studied.
pub const PASS: Pass = Pass { seed: 11, index: 0, random: RandomKind::Counter, sample: 0, samples: 1 };

/// A closed room of two metres with a glass ball, a mirror and two lights, in a corner of a scene that is `ratio`
/// times as large, offset by `place` from the user's origin.
#[must_use]
pub fn studio(ratio: f64, place: f64, albedo: f64) -> Described {
    let put = |(positions, triangles): Shape| -> Shape {
        (positions.into_iter().map(|p| p.map(|x| x + place)).collect(), triangles)
    };
    let grey = MaterialDesc::lambert("grey", [albedo, albedo * 0.9, albedo * 0.8]);
    let quad = |y: f64, h: f64| shapes::quad([[-h, y, -h], [h, y, -h], [h, y, h], [-h, y, h]]);
    let wall = shapes::quad([[-0.9, -0.5, -0.8], [-0.9, -0.5, 0.8], [-0.9, 0.5, 0.8], [-0.9, 0.5, -0.8]]);
    let mut meshes = vec![
        (put(shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3]))), grey),
        (put(shapes::icosphere(3, [0.3, -0.5, 0.2], 0.4)), MaterialDesc::glass("glass", 1.5)),
        (put(wall), MaterialDesc::mirror("mirror", [0.9; 3])),
        (put(quad(0.95, 0.25)), MaterialDesc::emissive("light", [0.0; 3], [1.0; 3])),
    ];
    if ratio > 1.0 {
        // Far away and black: it only serves to enlarge the scene.
        let (far, near) = (2.0 * ratio - 1.0, 1.8 * ratio - 1.0);
        let corners = vec![[far; 3], [near, far, far], [far, near, far]];
        meshes.push((put((corners, vec![[0, 1, 2]])), MaterialDesc::lambert("far", [0.0; 3])));
    }
    let position = [-0.3, 0.4, 0.1].map(|x| x + place);
    Described { meshes, lights: vec![LightDesc::Point { position, intensity: [0.1; 3] }] }
}

/// The shipped rays of the first `count` paths.
#[must_use]
pub fn rays(scene: &Scene, count: u32) -> Vec<PhotonRay> {
    let mut shipped = Shipped::new(scene, 1);
    let mut rays = shipped.on.alloc("rays", u64::from(count)).unwrap();
    let batch = Batch { pass: PASS, paths: 0..count };
    let mut stages = shipped.on.stages(&shipped.required, &shipped.settings).unwrap();
    stages.emitter.emit(&mut shipped.on, &shipped.prepared, &batch, &mut rays).unwrap();
    let mut out = Vec::new();
    shipped.on.download(&rays, &mut out).unwrap();
    out
}

/// The shipped CPU backend with a prepared scene.
struct Shipped {
    on: Cpu,
    required: Requirements,
    settings: Settings,
    prepared: <Cpu as TransportBackend>::Scene,
}

impl Shipped {
    fn new(scene: &Scene, max_bounces: u32) -> Self {
        let settings = Settings { max_bounces, seed: PASS.seed, ..Settings::default() };
        let mut on = Cpu::with_threads(1).unwrap();
        let view = scene.view();
        let mut required = Requirements::of(&view, &settings);
        required.maps = PerMap::splat(true);
        let prepared = on.prepare(&view, &required).unwrap();
        Self { on, required, settings, prepared }
    }
}

/// Photons of each path in the order in which they were stored, with their map, and the number of escaped paths.
#[must_use]
pub fn photons(scene: &Scene, rays: &[PhotonRay], max_bounces: u32) -> (Vec<Vec<(MapKind, Photon)>>, u64) {
    let Shipped { mut on, required, settings, prepared } = Shipped::new(scene, max_bounces);
    let mut stages = on.stages(&required, &settings).unwrap();
    let room = rays.len() as u64 * u64::from(max_bounces) + 1;
    let mut buffers = PerMap::from_fn(|kind| on.alloc::<Photon>(kind.name(), room).unwrap());
    // Photons do not record their path, so each path is a batch of its own.
    let mut lengths = Vec::with_capacity(rays.len());
    for (path, ray) in (0_u32..).zip(rays) {
        let deposits = buffers.each_mut().map(Some);
        let one = on.upload("ray", std::slice::from_ref(ray)).unwrap();
        let batch = Batch { pass: PASS, paths: path..path + 1 };
        stages.tracer.trace(&mut on, &prepared, &batch, &one, deposits, MediaDeposits::default()).unwrap();
        lengths.push(buffers.each_ref().map(|buffer| on.fill(buffer).unwrap().length as usize));
    }
    let lost = stages.tracer.take_tally(&mut on).unwrap();
    let maps = buffers.map(|buffer| {
        let mut out = Vec::new();
        on.download(&buffer, &mut out).unwrap();
        out
    });
    let mut before = PerMap::<usize>::default();
    let paths = lengths.into_iter().map(|lengths: PerMap<usize>| {
        // A direct or caustic photon comes first, at most once; all that follow are global.
        let photons = maps
            .iter()
            .flat_map(|(map, photons)| photons[before[map]..lengths[map]].iter().map(move |p| (map, *p)))
            .collect();
        before = lengths;
        photons
    });
    (paths.collect(), lost.escaped + lost.dropped)
}

/// The twin's paths, starting at the light, and the number of escaped ones.
#[must_use]
pub fn twins(wide: &Wide, count: u32, max_bounces: u32) -> (Vec<Vec<Landing>>, u64) {
    let twin = Twin { scene: wide, pass: PASS, max_bounces };
    let mut lost = 0;
    let paths = (0..count).map(|path| {
        let (landings, end) = twin.follow(&emit(wide, PASS, path), path);
        lost += u64::from(end == End::Escaped);
        landings
    });
    (paths.collect(), lost)
}

/// Flux onto upward-facing surfaces, path by path, relative to the truth, minus 1; and the standard error, since
/// paths are independent: `√Σd²` over the sum, with `d` the difference of one path.
#[must_use]
pub fn flux(found: impl Iterator<Item = f64>, truth: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut sum, mut differences, mut squares) = (0.0, 0.0, 0.0);
    for (found, truth) in found.zip(truth) {
        sum += truth;
        differences += found - truth;
        squares += (found - truth) * (found - truth);
    }
    (differences / sum, squares.sqrt() / sum)
}

fn faces_up(normal: DVec3) -> bool {
    normal.y > 0.999
}

/// Flux of each of the twin's paths onto upward-facing surfaces.
pub fn upward(paths: &[Vec<Landing>]) -> impl Iterator<Item = f64> {
    let of = |path: &Vec<Landing>| path.iter().filter(|l| faces_up(l.normal)).map(|l| l.power.element_sum()).sum();
    paths.iter().map(of)
}

/// The same paths, traced by both.
#[derive(Debug)]
pub struct Pair {
    /// Traced in f32.
    pub shipped: Vec<Vec<(MapKind, Photon)>>,
    /// Traced in f64.
    pub twin: Vec<Vec<Landing>>,
    /// Number of shipped paths that escaped from a closed room.
    pub lost: u64,
    /// Length of a metre in normalised space.
    pub metre: f64,
}

/// Differences between two paths at one landing.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// Distance in metres.
    pub apart: f64,
    /// Angle between the directions towards the origin, in radians.
    pub turned: f64,
    /// Relative difference in power.
    pub power: f64,
}

impl Pair {
    /// Traces `count` paths of `described` with both; `narrow` is the scene that the shipped code gets.
    #[must_use]
    pub fn new(described: &Described, narrow: &Described, count: u32, max_bounces: u32) -> Self {
        let scene = described.builder().build().unwrap();
        let ships = narrow.builder().build().unwrap();
        let wide = Wide::exact(&scene, described);
        let (shipped, lost) = photons(&ships, &rays(&ships, count), max_bounces);
        let (twin, escaped) = twins(&wide, count, max_bounces);
        assert_eq!(escaped, 0, "paths of the twin escaped from a closed room");
        Self { shipped, twin, lost, metre: 1.0 / scene.units().scale }
    }

    /// Path by path, the landings that both have; `None` from where they diverge: one ends, or lands in another
    /// map, or more than a twentieth of the room away.
    pub fn meetings(&self) -> impl Iterator<Item = Vec<Option<Meeting>>> {
        self.shipped.iter().zip(&self.twin).map(|(shipped, twin)| {
            let mut together = true;
            let most = shipped.len().max(twin.len());
            (0..most)
                .map(|at| {
                    let (Some((map, photon)), Some(landing)) = (shipped.get(at), twin.get(at)) else {
                        together = false;
                        return None;
                    };
                    let apart = (Vec3::from(photon.position).as_dvec3() - landing.point).length() / self.metre;
                    together &= *map == landing.map && apart < 0.1;
                    let back = octahedral::unpack(photon.direction).as_dvec3();
                    let mean = |power: DVec3| power.element_sum();
                    let power = super::relative(mean(Vec3::from(photon.power).as_dvec3()), mean(landing.power));
                    together.then(|| Meeting { apart, turned: crate::twin::optics::angle(back, landing.back), power })
                })
                .collect()
        })
    }

    /// Fraction of the paths with landing number `at`, from 0, that diverge there or before.
    #[must_use]
    pub fn parted(&self, at: usize) -> f64 {
        let reached: Vec<bool> = self
            .meetings()
            .filter(|path| path.len() > at)
            .map(|path| path[..=at].iter().any(Option::is_none))
            .collect();
        reached.iter().filter(|&&parted| parted).count() as f64 / reached.len().max(1) as f64
    }

    /// The differences at landing number `at`, of paths that both still share.
    #[must_use]
    pub fn at(&self, at: usize) -> Vec<Meeting> {
        self.meetings().filter_map(|path| path.get(at).copied().flatten()).collect()
    }

    /// [`flux`] of the shipped paths.
    #[must_use]
    pub fn flux(&self) -> (f64, f64) {
        let of = |path: &Vec<(MapKind, Photon)>| {
            let up = path.iter().filter(|(_, p)| faces_up(octahedral::unpack(p.normal).as_dvec3()));
            up.map(|(_, p)| Vec3::from(p.power).as_dvec3().element_sum()).sum::<f64>()
        };
        flux(self.shipped.iter().map(of), upward(&self.twin))
    }
}

//! What ships, path by path, and scenes to try it on.

use backend_cpu::Cpu;
use photon_core::glam::{DVec3, Vec3};
use photon_core::{
    Backend, Batch, MapKind, Pass, PerMap, Photon, PhotonRay, RandomKind, Requirements, Settings, TransportBackend,
    octahedral,
};
use photon_scene::shapes::Shape;
use photon_scene::{LightDesc, MaterialDesc, Scene, shapes};

use crate::twin::{Described, End, Landing, Twin, Wide, emit};

/// The pass that the study is of.
pub const PASS: Pass = Pass { seed: 11, index: 0, random: RandomKind::Counter };

/// A closed room of two metres with a ball of glass, a mirror and two lights, in a corner of a scene that is `ratio`
/// times as large, put `place` away from the user's origin.
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
        (put(quad(0.95, 0.25)), MaterialDesc::emissive("lamp", [0.0; 3], [1.0; 3])),
    ];
    if ratio > 1.0 {
        // Far off and black: all it does is to make the scene as large as it is.
        let (far, near) = (2.0 * ratio - 1.0, 1.8 * ratio - 1.0);
        let corners = vec![[far; 3], [near, far, far], [far, near, far]];
        meshes.push((put((corners, vec![[0, 1, 2]])), MaterialDesc::lambert("far", [0.0; 3])));
    }
    let position = [-0.3, 0.4, 0.1].map(|x| x + place);
    Described { meshes, lights: vec![LightDesc::Point { position, intensity: [0.1; 3] }] }
}

/// The shipped rays of so many paths.
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

/// The shipped CPU, ready for a scene.
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
        let required = Requirements { maps: PerMap::splat(true), ..Requirements::of(&view, &settings) };
        let prepared = on.prepare(&view, &required).unwrap();
        Self { on, required, settings, prepared }
    }
}

/// Photons of each path in the order in which they landed, with their map, and how many paths got out.
#[must_use]
pub fn photons(scene: &Scene, rays: &[PhotonRay], max_bounces: u32) -> (Vec<Vec<(MapKind, Photon)>>, u64) {
    let Shipped { mut on, required, settings, prepared } = Shipped::new(scene, max_bounces);
    let mut stages = on.stages(&required, &settings).unwrap();
    let room = rays.len() as u64 * u64::from(max_bounces) + 1;
    let mut buffers = PerMap::from_fn(|kind| on.alloc::<Photon>(kind.name(), room).unwrap());
    // Photons do not say which path they are of: one batch for each.
    let mut lengths = Vec::with_capacity(rays.len());
    for (path, ray) in (0_u32..).zip(rays) {
        let deposits = buffers.each_mut().map(Some);
        let one = on.upload("ray", std::slice::from_ref(ray)).unwrap();
        let batch = Batch { pass: PASS, paths: path..path + 1 };
        stages.tracer.trace(&mut on, &prepared, &batch, &one, deposits).unwrap();
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
        // Direct or caustic comes first, and once at most; all that follow are global.
        let photons = maps
            .iter()
            .flat_map(|(map, photons)| photons[before[map]..lengths[map]].iter().map(move |p| (map, *p)))
            .collect();
        before = lengths;
        photons
    });
    (paths.collect(), lost.escaped + lost.dropped)
}

/// The twin's paths, from the light on, and how many got out.
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

/// What lands on surfaces that face up, path by path, over what lands there in truth, less 1; and the standard error,
/// paths being independent: `√Σd²` over the sum, `d` the difference of one path.
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

/// Flux of each of the twin's paths onto surfaces that face up.
pub fn upward(paths: &[Vec<Landing>]) -> impl Iterator<Item = f64> {
    let of = |path: &Vec<Landing>| path.iter().filter(|l| faces_up(l.normal)).map(|l| l.power.element_sum()).sum();
    paths.iter().map(of)
}

/// Both walks of some paths.
#[derive(Debug)]
pub struct Pair {
    /// By f32.
    pub shipped: Vec<Vec<(MapKind, Photon)>>,
    /// By f64.
    pub twin: Vec<Vec<Landing>>,
    /// Paths of the shipped that got out of a closed room.
    pub lost: u64,
    /// Normalised length of a metre.
    pub metre: f64,
}

/// What two walks have at one landing.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// Metres apart.
    pub apart: f64,
    /// Of the direction that the photon came from, radians.
    pub turned: f64,
    /// Of the power, relative.
    pub power: f64,
}

impl Pair {
    /// Follows `count` paths of `described` twice; `narrow` is what ships of it.
    #[must_use]
    pub fn new(described: &Described, narrow: &Described, count: u32, max_bounces: u32) -> Self {
        let scene = described.builder().build().unwrap();
        let ships = narrow.builder().build().unwrap();
        let wide = Wide::exact(&scene, described);
        let (shipped, lost) = photons(&ships, &rays(&ships, count), max_bounces);
        let (twin, escaped) = twins(&wide, count, max_bounces);
        assert_eq!(escaped, 0, "paths of the twin get out of a closed room");
        Self { shipped, twin, lost, metre: 1.0 / scene.units().scale }
    }

    /// Path by path, the landings that both have; `None` from where they part: one ends, or lands in another map, or
    /// more than a twentieth of the room away.
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

    /// Share of paths with a landing of that number, from 0, which part there or before.
    #[must_use]
    pub fn parted(&self, at: usize) -> f64 {
        let reached: Vec<bool> = self
            .meetings()
            .filter(|path| path.len() > at)
            .map(|path| path[..=at].iter().any(Option::is_none))
            .collect();
        reached.iter().filter(|&&parted| parted).count() as f64 / reached.len().max(1) as f64
    }

    /// What is there of the landings of that number that both have.
    #[must_use]
    pub fn at(&self, at: usize) -> Vec<Meeting> {
        self.meetings().filter_map(|path| path.get(at).copied().flatten()).collect()
    }

    /// [`flux`] of what ships.
    #[must_use]
    pub fn flux(&self) -> (f64, f64) {
        let of = |path: &Vec<(MapKind, Photon)>| {
            let up = path.iter().filter(|(_, p)| faces_up(octahedral::unpack(p.normal).as_dvec3()));
            up.map(|(_, p)| Vec3::from(p.power).as_dvec3().element_sum()).sum::<f64>()
        };
        flux(self.shipped.iter().map(of), upward(&self.twin))
    }
}

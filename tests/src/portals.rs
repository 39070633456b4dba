//! Portals: a closed room with a hole, into which an environment, a sun or a directional light shines. Whatever the portals,
//! each part of the room gets the flux of a closed form.

use std::f64::consts::PI;

use photon_core::glam::{DVec3, Vec3};
use photon_core::{
    Direct, EnvironmentMap, MapKind, Photon, PhotonRay, ProjectionMap, RandomKind, Settings, octahedral,
};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, Sun, shapes};

use crate::equivalence::{assert_start_alike, rays};
use crate::harness::{TestBackend, trace};
use crate::stats::assert_agrees;

/// Half the side of the hole in the roof of a room of side 2 around the origin.
const HALF: f64 = 0.2;
const AREA: f64 = 4.0 * HALF * HALF;

/// The share of photons that start from the disc.
const DISC: f64 = photon_core::portals::DISC_SHARE as f64;

type Quad = [[f64; 3]; 4];

/// A rectangle at this height.
fn level(y: f64, [x, far_x]: [f64; 2], [z, far_z]: [f64; 2]) -> Quad {
    [[x, y, z], [x, y, far_z], [far_x, y, far_z], [far_x, y, z]]
}

fn hole() -> Quad {
    level(1.0, [-HALF, HALF], [-HALF, HALF])
}

/// Portals, with a name: at the hole; none; half of the hole; two that overlap, beyond the hole; one within the room, one
/// that stands in the hole, and one elsewhere.
fn cases() -> [(&'static str, Vec<Quad>); 6] {
    let beside = level(1.0, [-0.1, 0.6], [-0.1, 0.3]);
    let standing = [[0.0, 0.9, -HALF], [0.0, 1.1, -HALF], [0.0, 1.1, HALF], [0.0, 0.9, HALF]];
    [
        ("at the hole", vec![hole()]),
        ("none", vec![]),
        ("half of the hole", vec![level(1.0, [-HALF, 0.0], [-HALF, HALF])]),
        ("overlapping", vec![hole(), beside]),
        ("in the room, and standing", vec![level(-0.3, [-0.7, 0.5], [-0.5, 0.5]), standing]),
        ("elsewhere", vec![level(-1.0, [0.5, 1.5], [0.5, 1.5])]),
    ]
}

/// Lights of which the flux through the hole and onto the roof is known.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lit {
    /// An even environment of radiance 1.
    Environment,
    /// A sun of a radius of 20 degrees at the zenith, of irradiance 1.
    Sun,
    /// A directional light of irradiance 1, at an angle whose cosine is 0.8.
    Directional,
}

impl Lit {
    /// Irradiance of the roof.
    fn on_the_roof(self) -> f64 {
        match self {
            Self::Environment => PI,
            Self::Sun => 1.0,
            Self::Directional => 0.8,
        }
    }
}

/// The room, all walls of which store photons on both sides; with a mirror on the floor if `mirror`.
fn room(lit: Lit, portals: &[Quad], mirror: bool) -> Scene {
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [0.5; 3]));
    let all = [-1.0, 1.0];
    for (x, z) in
        [([-1.0, -HALF], all), ([HALF, 1.0], all), ([-HALF, HALF], [-1.0, -HALF]), ([-HALF, HALF], [HALF, 1.0])]
    {
        builder.quad("roof", level(1.0, x, z), white);
    }
    builder.quad("floor", level(-1.0, all, all), white);
    for (axis, other) in [(0, 2), (2, 0)] {
        for side in all {
            let corner = |a: f64, y: f64| {
                let mut at = [0.0, y, 0.0];
                (at[axis], at[other]) = (side, a);
                at
            };
            builder.quad("wall", [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], white);
        }
    }
    if mirror {
        let mirror = builder.material(MaterialDesc::mirror("mirror", [1.0; 3]));
        let (positions, triangles) = shapes::icosphere(1, [0.0, -0.5, 0.0], 0.2);
        builder.mesh("mirror", positions, triangles, mirror);
    }
    match lit {
        Lit::Environment => builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap()),
        Lit::Sun => builder.sun(Sun::new([0.0, -1.0, 0.0], [1.0; 3]).with_radius_degrees(20.0)),
        Lit::Directional => {
            builder.light("far", LightDesc::Directional { direction: [0.48, -0.8, 0.36], irradiance: [1.0; 3] });
        }
    }
    for (index, [a, b, c, d]) in portals.iter().enumerate() {
        builder.portal(format!("portal {index}"), vec![[*a, *b, *c], [*a, *c, *d]]);
    }
    builder.build().unwrap()
}

/// Sum and standard error, in watts, of the photons that `count` selects, of `paths` paths that store at most one each.
pub(crate) fn flux(scene: &Scene, photons: &[Photon], paths: u32, counts: impl Fn(&Photon) -> bool) -> (f64, f64) {
    let powers = photons.iter().filter(|photon| counts(photon)).map(|photon| f64::from(photon.power[0]));
    let (sum, squares) = powers.fold((0.0, 0.0), |(sum, squares), power| (sum + power, squares + power * power));
    let paths = f64::from(paths);
    let mean = sum / paths;
    // Standard error of the mean over paths, those without a photon included.
    let error = ((squares / paths - mean * mean) / paths).sqrt();
    (mean * scene.units().power, error * scene.units().power)
}

/// Whether a photon arrived from within the room, whose centre is the origin.
fn within(photon: &Photon) -> bool {
    octahedral::unpack(photon.normal).dot(Vec3::from(photon.position)) < 0.0
}

/// Irradiance of the floor at (x, z) from an even environment of radiance 1 that is seen through the hole, two units above:
/// the sum over its four edges of `½ θᵢ nᵢ·n` (Lambert 1760), in f64.
fn through_hole(x: f64, z: f64) -> f64 {
    let at = DVec3::new(x, -1.0, z);
    let corners = hole().map(|corner| (DVec3::from(corner) - at).normalize_or_zero());
    let edges = (0..4).map(|i| (corners[i], corners[(i + 1) % 4]));
    edges.map(|(a, b)| 0.5 * a.angle_between(b) * a.cross(b).normalize_or_zero().y).sum::<f64>().abs()
}

/// The flux of an even environment through the hole onto the middle of the floor, a square of half side `half`, by the
/// midpoint rule with 64 × 64 points.
fn onto_the_floor(half: f64) -> f64 {
    let steps = 64;
    let at = |i: u32| half * (2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0);
    let sum: f64 = (0..steps * steps).map(|i| through_hole(at(i / steps), at(i % steps))).sum();
    sum * (2.0 * half / f64::from(steps)).powi(2)
}

/// The flux that enters is E A for the irradiance E of the roof, and the roof gets E times its area; the middle of the floor
/// gets that of the form factor. Portals change none of these, wherever they are.
pub fn flux_does_not_depend_on_portals<T: TestBackend>() {
    let paths = 60_000;
    for lit in [Lit::Environment, Lit::Sun, Lit::Directional] {
        for (name, portals) in cases() {
            let scene = room(lit, &portals, false);
            let settings = Settings { direct: Direct::Photons, seed: 3, ..Settings::default() };
            let (photons, _) = trace::<T>(2, &scene, &settings, &[paths]);
            let photons = &photons[MapKind::Direct];
            let size = scene.units().scale as f32;
            let what = |part: &str| format!("{lit:?}, portals {name}: {part}");
            let (entered, error) = flux(&scene, photons, paths, within);
            assert_agrees(&what("room"), entered, lit.on_the_roof() * AREA, error, 0.0);
            let on_roof = |photon: &Photon| photon.position[1] * size > 0.999 && !within(photon);
            let (roof, error) = flux(&scene, photons, paths, on_roof);
            assert_agrees(&what("roof"), roof, lit.on_the_roof() * (4.0 - AREA), error, 0.0);
            if lit == Lit::Environment {
                let half = 0.5;
                let [low, high] = [-half, half].map(|c| c as f32);
                let inside = |c: f32| (low..high).contains(&(c * size));
                let on_floor = |photon: &Photon| {
                    let [x, y, z] = photon.position;
                    within(photon) && y * size < -0.999 && inside(x) && inside(z)
                };
                let (floor, error) = flux(&scene, photons, paths, on_floor);
                assert_agrees(&what("floor"), floor, onto_the_floor(half), error, 0.0);
            }
        }
    }
}

/// The share of the photons that enter: of an even environment, A/(4πR²) of those from the disc, as an opening sees half of
/// the directions, and half of those started through the portal. 59 times as many, here.
pub fn more_photons_enter<T: TestBackend>() {
    let paths = 60_000;
    let entering = |portals: &[Quad]| {
        let scene = room(Lit::Environment, portals, false);
        let settings = Settings { direct: Direct::Photons, seed: 4, ..Settings::default() };
        let (photons, _) = trace::<T>(2, &scene, &settings, &[paths]);
        photons[MapKind::Direct].iter().filter(|photon| within(photon)).count() as f64 / f64::from(paths)
    };
    let by_disc = AREA / (4.0 * PI * 3.0);
    for (portals, expected) in [(vec![], by_disc), (vec![hole()], DISC * by_disc + (1.0 - DISC) * 0.5)] {
        let error = (expected * (1.0 - expected) / f64::from(paths)).sqrt();
        assert_agrees(&format!("{} portals", portals.len()), entering(&portals), expected, error, 0.0);
    }
}

/// A sphere within the mirror of the room: its height and its radius.
const MIRROR: (f64, f64) = (-0.5, 0.18);

/// The flux of an even environment of radiance 1 through the hole onto that sphere: the integral over the hole of π (r/d)² cos θ,
/// by the midpoint rule with 64 × 64 points.
fn onto_the_mirror() -> f64 {
    let steps = 64;
    let (height, radius) = (1.0 - MIRROR.0, MIRROR.1);
    let at = |i: u32| HALF * (2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0);
    let irradiance = |x: f64, z: f64| {
        let squared = height * height + x * x + z * z;
        PI * radius * radius / squared * height / squared.sqrt()
    };
    let sum: f64 = (0..steps * steps).map(|i| irradiance(at(i / steps), at(i % steps))).sum();
    sum * (2.0 * HALF / f64::from(steps)).powi(2)
}

/// Mean power, and its standard error, in watts, of the rays that reach that sphere through the hole.
fn hit_the_mirror(scene: &Scene, rays: &[PhotonRay]) -> (f64, f64) {
    let size = scene.units().scale;
    let (half, radius, middle) = (HALF / size, MIRROR.1 / size, DVec3::new(0.0, MIRROR.0 / size, 0.0));
    let powers: Vec<f64> = rays
        .iter()
        .map(|ray| {
            let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from(v).as_dvec3());
            let at = origin + direction * ((1.0 / size - origin.y) / direction.y);
            let enters = direction.y < 0.0 && at.x.abs() < half && at.z.abs() < half;
            let hits = (middle - origin).reject_from_normalized(direction).length() < radius;
            if enters && hits { f64::from(ray.power[0]) * scene.units().power } else { 0.0 }
        })
        .collect();
    let (mean, _) = crate::stats::moments(&powers);
    (mean, crate::stats::standard_error(&powers))
}

/// Photons of the environment that are aimed at a mirror in the room carry as much to it as a closed form says, wherever
/// portals are, and are no noisier than those that start through a portal at the hole.
pub fn aimed_photons_do_not_need_portals<T: TestBackend>() {
    let count = 60_000;
    let mut through_portals = None;
    for (name, portals) in cases() {
        let scene = room(Lit::Environment, &portals, true);
        let projection = ProjectionMap::of(&scene.view());
        assert!(projection.share() < 0.05, "{}", projection.share());
        let settings = Settings { seed: 6, ..Settings::default() };
        let found = |projection| hit_the_mirror(&scene, &rays::<T>(&scene, &settings, projection, count));
        let noise = *through_portals.get_or_insert_with(|| found(None).1);
        let (aimed, error) = found(Some(&projection));
        assert_agrees(&format!("portals {name}"), aimed, onto_the_mirror(), error, 0.0);
        assert!(error < noise, "portals {name}: {error} {noise}");
    }
}

/// Photons of both backends leave alike, in every path but those whose count of portals is decided by rounding.
pub fn photons_leave_alike_through_portals<A: TestBackend, B: TestBackend>() {
    for lit in [Lit::Environment, Lit::Sun, Lit::Directional] {
        for (name, portals) in cases() {
            let scene = room(lit, &portals, true);
            let projection = ProjectionMap::of(&scene.view());
            for (random, projection) in
                [(RandomKind::Counter, None), (RandomKind::Lcg, None), (RandomKind::Counter, Some(&projection))]
            {
                let settings = Settings { seed: 11, random, ..Settings::default() };
                assert_start_alike::<A, B>(
                    &scene,
                    &settings,
                    projection,
                    &format!("{lit:?}, portals {name}, {random:?}"),
                );
            }
        }
    }
}

//! Each stage by itself: the shipped function and its twin on the same shipped numbers.

use photon_core::glam::{DVec3, Vec3};
use photon_core::random::{BLOCK_SURFACES, Domain, Sampler, unit_f32};
use photon_core::{Ray, RayCaster, fresnel, octahedral, offset, sampling};
use photon_scene::{Accel, LightDesc, MaterialDesc, Scene, shapes};

use super::shipped::{PASS, Pair, rays, studio};
use super::{Table, relative, spread};
use crate::twin::optics::{self, angle};
use crate::twin::{Described, Wide, emit};

fn wide(v: [f32; 3]) -> DVec3 {
    Vec3::from(v).as_dvec3()
}

/// Every stage along a photon's path through the studio; lengths in units of the scene.
#[must_use]
pub fn all(count: u32) -> Table {
    let described = studio(1.0, 0.0, 0.6);
    let scene = described.builder().build().unwrap();
    let (exact, rounded) = (Wide::exact(&scene, &described), Wide::rounded(&scene));
    let columns = ["stage: figure", "median", "99 of 100", "worst"];
    let mut table = Table::new("Stage by stage, a room with a ball of glass", &columns);
    let mut row = |name: &str, values: Vec<f64>| table.row(name, &spread(values));

    let corners = exact.triangles.iter().flatten().zip(rounded.triangles.iter().flatten());
    row("normalisation: a vertex is off by", corners.map(|(a, b)| (*a - *b).length()).collect());
    let normals = scene.view().primitives.iter().zip(&exact.normals);
    row("normalisation: a normal, radians", normals.map(|(f, n)| angle(wide(f.normal), *n)).collect());

    let shipped = rays(&scene, count);
    let twin: Vec<_> = (0..count).map(|path| emit(&rounded, PASS, path)).collect();
    let both = || shipped.iter().zip(&twin);
    let step = 1.0 / 1_048_576.0;
    let from_surface = |from: u32, n: DVec3| if from == u32::MAX { DVec3::ZERO } else { n * step };
    row(
        "emission: origin, without the offset from the light",
        both()
            .map(|(ray, start)| {
                let normal = rounded.normals.get(start.from as usize).copied().unwrap_or_default();
                (wide(ray.origin) - start.origin - from_surface(start.from, normal)).length()
            })
            .collect(),
    );
    row(
        "emission: direction, radians",
        both().map(|(ray, start)| angle(wide(ray.direction), start.direction)).collect(),
    );

    let hits = hits(&scene, &rounded, &shipped);
    let column = |of: fn(&Hit) -> f64| hits.iter().map(of).collect::<Vec<f64>>();
    row("hit: distance, relative", column(|hit| hit.t));
    row("hit: position, along the surface", column(|hit| hit.along));
    row("hit: position, off the surface", column(|hit| hit.off));
    row("bounce: diffuse direction, radians", column(|hit| hit.diffuse));
    row("bounce: mirrored direction, radians", column(|hit| hit.mirrored));
    row("glass, ior 1.5: reflectance", column(|hit| hit.reflectance));
    row("glass, ior 1.5: refracted direction, radians", column(|hit| hit.refracted));
    row("photon: direction in 32 bits, radians", column(|hit| hit.packed));

    let pair = Pair::new(&described, &described, count.min(4000), 16);
    let landings: Vec<_> = pair.meetings().flatten().flatten().collect();
    row("path: power at a landing, relative", landings.iter().map(|landing| landing.power).collect());
    table.row("film: sum of 1e6 passes, relative, in f64", &[f64::NAN, f64::NAN, film(1_000_000)]);
    table
}

/// Errors of a hit and of what follows from it.
struct Hit {
    t: f64,
    along: f64,
    off: f64,
    diffuse: f64,
    mirrored: f64,
    reflectance: f64,
    refracted: f64,
    packed: f64,
}

fn hits(scene: &Scene, rounded: &Wide, rays: &[photon_core::PhotonRay]) -> Vec<Hit> {
    let view = scene.view();
    let accel = Accel::build(view.positions, view.triangles).unwrap();
    let mut out = Vec::new();
    for (path, shipped) in (0_u32..).zip(rays) {
        let ray = Ray { origin: shipped.origin.into(), direction: shipped.direction.into(), t_max: f32::INFINITY };
        let (from, along) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let found = accel.nearest(&ray).unwrap();
        let Some(truth) = rounded.tree.nearest(from, along, f64::INFINITY, u32::MAX) else { continue };
        // At an edge, each may be right about its own triangle; paths that diverge there are counted elsewhere.
        if truth.primitive != found.primitive {
            continue;
        }
        let corners = rounded.triangles[found.primitive as usize];
        let point = offset::barycentric(corners.map(|corner| corner.as_vec3()), found.u, found.v);
        let n = rounded.normals[found.primitive as usize];
        let gap = point.as_dvec3() - (from + along * truth.t);
        let off = (point.as_dvec3() - corners[0]).dot(n).abs();

        let face_normal = Vec3::from(view.primitives[found.primitive as usize].normal);
        let (face_normal, n) = if ray.direction.dot(face_normal) < 0.0 { (face_normal, n) } else { (-face_normal, -n) };
        let mut sampler = Sampler::new(PASS.random, PASS.seed, PASS.index, Domain::Photon, path);
        let [_, u, v, _] = sampler.words(BLOCK_SURFACES).map(unit_f32);
        let unit = along.normalize_or_zero();
        let (cosine, eta) = (-ray.direction.dot(face_normal), 1.5_f32);
        let narrow = fresnel::fresnel(cosine, eta);
        let (reflectance, transmitted) = optics::fresnel(-unit.dot(n), 1.5);
        let refracted = fresnel::refract(ray.direction, face_normal, eta, narrow.cos_transmitted).as_dvec3();
        out.push(Hit {
            t: relative(found.t.into(), truth.t),
            along: (gap - n * gap.dot(n)).length(),
            off,
            diffuse: angle(
                sampling::cosine_hemisphere(face_normal, u, v).as_dvec3(),
                optics::cosine_hemisphere(n, u.into(), v.into()),
            ),
            mirrored: angle(fresnel::reflect(ray.direction, face_normal).as_dvec3(), optics::reflect(unit, n)),
            reflectance: (f64::from(narrow.reflectance) - reflectance).abs(),
            refracted: angle(refracted, optics::refract(unit, n, 1.5, transmitted)),
            packed: angle(octahedral::unpack(octahedral::pack(ray.direction)).as_dvec3(), unit),
        });
    }
    out
}

/// A running sum in f64, as in the film, compared with a compensated sum (Neumaier 1974).
fn film(passes: u32) -> f64 {
    let mut uniform = crate::harness::Uniform::new(3);
    let (mut plain, mut sum, mut lost) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..passes {
        let value = uniform.draw() / 3.0;
        plain += value;
        let next = sum + value;
        lost += if sum.abs() >= value.abs() { (sum - next) + value } else { (value - next) + sum };
        sum = next;
    }
    relative(plain, sum + lost)
}

/// Grazing rays on a floor as large as the scene.
#[must_use]
pub fn grazing(rays: usize) -> Table {
    let floor = Described {
        meshes: vec![(
            shapes::quad([[-1.0, 0.1, -1.0], [-1.0, 0.1, 1.0], [1.0, 0.1, 1.0], [1.0, 0.1, -1.0]]),
            MaterialDesc::lambert("floor", [0.5; 3]),
        )],
        lights: vec![LightDesc::Point { position: [0.0, 1.0, 0.0], intensity: [1.0; 3] }],
    };
    let scene = floor.builder().build().unwrap();
    let rounded = Wide::rounded(&scene);
    let view = scene.view();
    let accel = Accel::build(view.positions, view.triangles).unwrap();
    let columns = [
        "angle to the surface",
        "position along the surface, median",
        "99 of 100",
        "moved by half a unit in the last place of the ray's origin",
        "lost, share",
        "reflectance at ior 1.5, worst",
        "mirrored direction over the angle, worst",
    ];
    let mut table = Table::new("Grazing rays", &columns);
    let mut uniform = crate::harness::Uniform::new(17);
    let y = f64::from(Vec3::from(view.positions[0]).y);
    for degrees in [45.0_f64, 10.0, 1.0, 0.1, 0.01, 1e-3, 1e-4] {
        let slope = degrees.to_radians();
        let (mut gaps, mut lost, mut reflectance, mut mirrored) = (Vec::new(), 0, 0.0_f64, 0.0_f64);
        for _ in 0..rays {
            let (a, reach) = (std::f64::consts::TAU * uniform.draw(), 0.05 + 0.15 * uniform.draw());
            let target = DVec3::new(0.4 * (uniform.draw() - 0.5), y, 0.4 * (uniform.draw() - 0.5));
            let direction = DVec3::new(a.cos() * slope.cos(), -slope.sin(), a.sin() * slope.cos());
            let ray = Ray {
                origin: (target - direction * reach).as_vec3(),
                direction: direction.as_vec3(),
                t_max: f32::INFINITY,
            };
            let (from, along) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            let truth = rounded.tree.nearest(from, along, f64::INFINITY, u32::MAX);
            match (accel.nearest(&ray), truth) {
                (Some(hit), Some(truth)) => {
                    let corners = rounded.triangles[hit.primitive as usize].map(|corner| corner.as_vec3());
                    let point = offset::barycentric(corners, hit.u, hit.v).as_dvec3();
                    gaps.push((point - (from + along * truth.t)).length());
                }
                (None, None) => {}
                _ => lost += 1,
            }
            let up = Vec3::Y;
            let cosine = -ray.direction.dot(up);
            let narrow = f64::from(fresnel::fresnel(cosine, 1.5).reflectance);
            reflectance = reflectance.max((narrow - optics::fresnel(-along.normalize_or_zero().y, 1.5).0).abs());
            let turned = angle(
                fresnel::reflect(ray.direction, up).as_dvec3(),
                optics::reflect(along.normalize_or_zero(), DVec3::Y),
            );
            mirrored = mirrored.max(turned / slope);
        }
        let [median, most, _] = spread(gaps);
        // Half a unit in the last place at 1/4, the position of the floor.
        let moved = 2.0_f64.powi(-26) / slope.tan();
        let lost = f64::from(lost) / rays as f64;
        table.row(format!("{degrees}°"), &[median, most, moved, lost, reflectance, mirrored]);
    }
    table
}

/// Refractive indices near 1: the accuracy of the deviation.
#[must_use]
pub fn near_one() -> Table {
    let columns = [
        "ior",
        "deviation at 45°, radians",
        "of the rounded index, relative",
        "as shipped, relative",
        "reflectance at normal incidence, as shipped, relative",
    ];
    let mut table = Table::new("Refractive indices near 1", &columns);
    let down = Vec3::new(1.0, 0.0, -1.0).normalize_or_zero();
    let unit = down.as_dvec3().normalize_or_zero();
    for k in 1..=7 {
        let index = 1.0 + 10.0_f64.powi(-k);
        let bend = |eta: f64| {
            let (_, transmitted) = optics::fresnel(-unit.z, eta);
            angle(optics::refract(unit, DVec3::Z, eta, transmitted), unit)
        };
        let narrow = index as f32;
        let fresnel = fresnel::fresnel(-down.z, narrow);
        let ships = fresnel::refract(down, Vec3::Z, narrow, fresnel.cos_transmitted).as_dvec3();
        let normal = f64::from(fresnel::fresnel(1.0, narrow).reflectance);
        let row = [
            bend(index),
            relative(bend(narrow.into()), bend(index)),
            relative(angle(ships, down.as_dvec3().normalize_or_zero()), bend(index)),
            relative(normal, optics::fresnel(1.0, index).0),
        ];
        table.row(format!("1 + 1e-{k}"), &row);
    }
    table
}

/// Random numbers of 32 bits: the fraction of directions within a cone about a pole of a point light, relative to
/// the truth.
#[must_use]
pub fn pole(angles: &[f64]) -> Table {
    let columns =
        ["half angle of the cone, radians", "directions in it, relative error", "number of different heights"];
    let mut table = Table::new("32 bits of a random number, about a pole of a point light", &columns);
    for &half in angles {
        // cos θ = 1 − 2u, so the cone contains u < (1 − cos half)/2.
        let share = (0.5 * half).sin().powi(2);
        let heights = (share * 4_294_967_296.0).ceil();
        table.row(format!("{half:.0e}"), &[relative(heights / 4_294_967_296.0, share), heights]);
    }
    table
}

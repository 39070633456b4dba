//! Hits on the device compared with those of photon-scene's ray caster.

use photon_core::glam::Vec3;
use photon_core::random::{philox4x32, unit_f32};
use photon_core::{
    Backend, Hit, Material, Medium, Primitive, Ray, RayCaster, Requirements, Result, SceneView, Settings, Stage,
    TransportBackend, Units, sampling,
};
use photon_scene::{Accel, BruteForce, CompressedTree};

use super::VulkanScene;
use super::silhouette::{Judge, TOLERANCE};
use crate::Vulkan;
use crate::rays::RayPlan;

type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// Four random numbers in [0, 1).
fn numbers(index: u32, block: u32) -> [f32; 4] {
    philox4x32([index, block, 0, 0], [5, 7]).map(unit_f32)
}

/// Uploads triangles, all of one material.
fn prepare(on: &mut Vulkan, mesh: &Mesh) -> VulkanScene {
    prepare_by(mesh, |view, required| VulkanScene::new(on, view, required))
}

fn prepare_by<T>((positions, triangles): &Mesh, by: impl FnOnce(&SceneView<'_>, &Requirements) -> Result<T>) -> T {
    let primitives = vec![Primitive { normal: [0.0, 0.0, 1.0], material: 0 }; triangles.len()];
    let materials = [Material { albedo: [0.5; 3], ..Material::default() }];
    let view = SceneView {
        positions,
        triangles,
        primitives: &primitives,
        materials: &materials,
        media: &[Medium::VACUUM],
        lights: &[],
        light_cdf: &[],
        radius: 1.0,
        units: Units::default(),
        ..SceneView::default()
    };
    by(&view, &Requirements::everything(&Settings::default())).unwrap()
}

/// Nearest hits and occlusion computed by the device; checks that all ray plans give the same results.
fn cast(on: &mut Vulkan, scene: &VulkanScene, rays: &[Ray]) -> (Vec<Option<Hit>>, Vec<bool>) {
    let hits = on.cast_rays(scene, rays).unwrap();
    for (group, shared_groups, busy) in [(64, 4, 0), (32, 0, 5), (64, 32, 1000)] {
        // Few workgroups, so that each invocation traces many rays; but lavapipe limits an invocation to 65 535
        // loop iterations in total, and the first invocations would take all rays if they could.
        let workgroups = 1 + rays.len() as u32 / 1000;
        let plan = RayPlan { group, shared_groups, busy, workgroups };
        let others = on.cast_rays_by(scene, rays, plan).unwrap();
        let mut apart = rays.iter().zip(&hits).zip(&others).enumerate().filter(|(_, ((_, a), b))| a != b);
        if let Some(one) = apart.next() {
            panic!("{plan:?}: {} of {} rays differ, for example {one:?}", apart.count() + 1, rays.len());
        }
    }
    (hits, on.cast_shadow_rays(scene, rays).unwrap())
}

fn soup(count: u32) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..count {
        let [x, y, z, _] = numbers(i, 0);
        for corner in 1..4 {
            let [a, b, c, _] = numbers(i, corner);
            positions.push([x - 0.5 + 0.1 * (a - 0.5), y - 0.5 + 0.1 * (b - 0.5), z - 0.5 + 0.1 * (c - 0.5)]);
        }
    }
    (positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// A closed sphere of radius 0.4 with `rings` rings of twice as many segments.
pub(crate) fn sphere(rings: u32) -> Mesh {
    let segments = 2 * rings;
    let mut positions = vec![[0.0, 0.0, 0.4]];
    for ring in 1..rings {
        for segment in 0..segments {
            let theta = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            let phi = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let at = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            positions.push(at.map(|c| (0.4 * c) as f32));
        }
    }
    positions.push([0.0, 0.0, -0.4]);
    let last = positions.len() as u32 - 1;
    let at = |ring: u32, segment: u32| 1 + (ring - 1) * segments + segment % segments;
    let mut triangles = Vec::new();
    for segment in 0..segments {
        triangles.push([0, at(1, segment), at(1, segment + 1)]);
        triangles.push([last, at(rings - 1, segment + 1), at(rings - 1, segment)]);
        for ring in 1..rings - 1 {
            let (a, b) = (at(ring, segment), at(ring, segment + 1));
            let (c, d) = (at(ring + 1, segment), at(ring + 1, segment + 1));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    (positions, triangles)
}

/// Random rays; some run along axes, some aim at vertices, some have a finite `t_max`.
fn rays_through((positions, _): &Mesh, count: u32) -> Vec<Ray> {
    (0..count)
        .map(|i| {
            let [x, y, z, end] = numbers(i, 8);
            let origin = Vec3::new(x, y, z) - 0.5;
            let [a, b, ..] = numbers(i, 9);
            let direction = match i % 5 {
                0 => [Vec3::X, -Vec3::Y, Vec3::Z][i as usize / 5 % 3],
                1 => (Vec3::from(positions[i as usize % positions.len()]) - origin).normalize_or(Vec3::X),
                _ => sampling::uniform_sphere(a, b),
            };
            Ray { origin, direction, t_max: if i % 7 == 0 { end } else { f32::INFINITY } }
        })
        .collect()
}

#[test]
fn hits_agree_with_those_of_the_processor() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    for mesh in [soup(1), soup(3), soup(5), soup(700), soup(20_000), sphere(16)] {
        let brute = BruteForce::build(&mesh.0, &mesh.1).unwrap();
        let accel = Accel::build(&mesh.0, &mesh.1).unwrap();
        let caster: &dyn RayCaster = if mesh.1.len() > 1000 { &accel } else { &brute };
        let scene = prepare(&mut on, &mesh);
        let rays = rays_through(&mesh, 20_000);
        let (hits, shadows) = cast(&mut on, &scene, &rays);
        let judge = Judge::new(&mesh);
        let (mut apart, mut open, mut count) = (0, 0, 0);
        for (number, ((ray, &hit), &shadow)) in rays.iter().zip(&hits).zip(&shadows).enumerate() {
            let expected = caster.nearest(ray);
            assert_eq!(shadow, hit.is_some(), "{ray:?}: {hit:?}, but occlusion {shadow}");
            count += u32::from(hit.is_some());
            apart += u32::from(hit.map(|hit| hit.primitive) != expected.map(|hit| hit.primitive));
            // Every ray is checked against the valid results; for large meshes, where that takes too long, only
            // those on which device and CPU disagree.
            if mesh.1.len() > 1000 && agree(hit, expected) {
                continue;
            }
            let verdict = judge.verdict(ray);
            for answer in [hit, expected] {
                assert!(verdict.allows(answer), "{ray:?}: {hit:?}, on the CPU {expected:?}; {verdict:?}");
            }
            // Rounding matters only for rays aimed at vertices, and for a few others by chance.
            open += u32::from(verdict.is_open() && number % 5 != 1);
        }
        println!("{} triangles: {count} hits, {apart} differ in triangle or hit, {open} ambiguous", mesh.1.len());
        assert!(count > 10, "{} triangles: {count} hits", mesh.1.len());
        assert!(open <= 20, "{} triangles: {open} rays not aimed at a vertex are ambiguous", mesh.1.len());
    }
}

/// Whether two results agree up to rounding.
fn agree(found: Option<Hit>, expected: Option<Hit>) -> bool {
    match (found, expected) {
        (None, None) => true,
        (Some(a), Some(b)) => (a.t - b.t).abs() <= TOLERANCE as f32 * b.t.max(0.1),
        _ => false,
    }
}

/// The tree is built on the host, whose time the timestamps of the device do not contain.
#[test]
fn the_tree_has_a_time_of_its_own() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = prepare_by(&soup(20_000), |view, required| on.prepare(view, required));
    let timings = on.timings().unwrap();
    assert!(scene.build_seconds > 0.0 && timings.get(Stage::Bvh) == scene.build_seconds);
    assert!(timings.get(Stage::Prepare) > 0.0);
}

/// A tree that was built before gives the same scene and counts with its own time; one of other triangles is not taken.
#[test]
fn a_tree_may_be_given() {
    let mesh = soup(500);
    let tree = || CompressedTree::build(&mesh.0, &mesh.1).unwrap();
    let Some(on) = Vulkan::for_tests() else { return };
    let mut on = on.with_tree(tree(), 100.0);
    let given = prepare_by(&mesh, |view, required| on.prepare(view, required));
    assert_eq!(given.build_seconds, 100.0);
    let built = prepare_by(&mesh, |view, required| on.prepare(view, required));
    assert!(built.build_seconds < 100.0 && built.bytes() == given.bytes());
    let timings = on.timings().unwrap();
    assert!(timings.get(Stage::Bvh) > 100.0 && timings.get(Stage::Prepare) < 100.0);
    let mut on = on.with_tree(tree(), 100.0);
    assert!(prepare_by(&soup(400), |view, required| on.prepare(view, required)).build_seconds < 100.0);
}

#[test]
fn what_differs_is_noticed() {
    let hit = |t, primitive| Some(Hit { t, primitive, u: 0.2, v: 0.2 });
    assert!(agree(hit(0.5, 1), hit(0.5, 1)) && agree(None, None));
    assert!(!agree(hit(0.5, 1), hit(0.5001, 1)));
    assert!(!agree(None, hit(0.5, 1)) && !agree(hit(0.5, 1), None));
}

/// No ray from inside a closed surface escapes, not even one aimed at an edge or a vertex.
#[test]
fn no_cracks_at_edges_and_vertices() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let mesh = sphere(48);
    let scene = prepare(&mut on, &mesh);
    let rays: Vec<Ray> = (0..400_000_u32)
        .map(|i| {
            let [x, y, z, along] = numbers(i, 0);
            let origin = (Vec3::new(x, y, z) - 0.5) * 0.4;
            let [a, b, c] = mesh.1[i as usize % mesh.1.len()].map(|vertex| Vec3::from(mesh.0[vertex as usize]));
            let target = match i % 3 {
                0 => a,
                1 => a + (b - a) * along,
                _ => c + (a - c) * along,
            };
            Ray { origin, direction: (target - origin).normalize(), t_max: f32::INFINITY }
        })
        .collect();
    let (hits, shadows) = cast(&mut on, &scene, &rays);
    let lost: Vec<_> = rays.iter().zip(&hits).filter(|(_, hit)| hit.is_none()).collect();
    assert!(lost.is_empty(), "{} rays escaped, for example {:?}", lost.len(), lost[0]);
    assert!(shadows.iter().all(|&shadow| shadow));
}

#[test]
fn rays_along_the_axes_hit_faces_up_to_their_edges() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let positions = vec![[-0.5, -0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, 0.5], [-0.5, 0.5, 0.5]];
    let scene = prepare(&mut on, &(positions, vec![[0, 1, 2], [0, 2, 3]]));
    let mut rays = Vec::new();
    for x in [-0.5, -0.5 + 1.2e-7, 0.0, 0.5 - 1.2e-7, 0.5_f32] {
        for y in [-0.5, 0.3, 0.5_f32] {
            for z in [-0.5, -9.0, -1e4_f32] {
                rays.push(Ray { origin: Vec3::new(x, y, z), direction: Vec3::Z, t_max: f32::INFINITY });
            }
        }
    }
    rays.push(Ray { origin: Vec3::new(0.500_001, 0.0, 0.0), direction: Vec3::Z, t_max: f32::INFINITY });
    let (mut hits, _) = cast(&mut on, &scene, &rays);
    assert_eq!(hits.pop().unwrap(), None);
    assert!(hits.iter().all(Option::is_some), "{hits:?}");
}

#[test]
fn limits_twins_and_nonsense() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let ray = |origin, direction, t_max| Ray { origin, direction, t_max };
    // A scene without triangles; and many coincident triangles, of which the lowest index wins.
    let empty = prepare(&mut on, &(vec![], vec![]));
    assert_eq!(cast(&mut on, &empty, &[ray(Vec3::ZERO, Vec3::X, 1.0)]).0, [None]);
    let positions = vec![[-0.1, -0.1, 0.0], [0.1, -0.1, 0.0], [0.0, 0.1, 0.0]];
    let twins = prepare(&mut on, &(positions, vec![[0, 1, 2]; 10_000]));
    let (hits, _) = cast(&mut on, &twins, &[ray(Vec3::new(0.0, 0.0, -1.0), Vec3::Z, f32::INFINITY)]);
    assert_eq!(hits[0].map(|hit| hit.primitive), Some(0));
    let ball = prepare(&mut on, &sphere(8));
    let (hits, _) = cast(&mut on, &ball, &[ray(Vec3::ZERO, Vec3::X, f32::INFINITY)]);
    let hit = hits[0].unwrap();
    let nonsense = [
        ray(Vec3::ZERO, Vec3::X, 0.3),
        ray(Vec3::ZERO, Vec3::ZERO, 1.0),
        ray(Vec3::ZERO, Vec3::NAN, 1.0),
        ray(Vec3::NAN, Vec3::X, 1.0),
        ray(Vec3::ZERO, Vec3::X, f32::NAN),
        ray(Vec3::ZERO, Vec3::X, -1.0),
        ray(Vec3::ZERO, Vec3::X * f32::INFINITY, 1.0),
        // A hit at exactly t_max counts.
        ray(Vec3::ZERO, Vec3::X, hit.t),
    ];
    let (mut hits, mut shadows) = cast(&mut on, &ball, &nonsense);
    assert!(hits.pop().unwrap().is_some() && shadows.pop().unwrap());
    assert!(hits.iter().all(Option::is_none) && !shadows.contains(&true), "{hits:?}");
}

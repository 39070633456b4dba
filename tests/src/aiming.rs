//! Aimed photons: the same expected light as with photons emitted in all directions.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use photon_core::glam::{Vec2, Vec3};
use photon_core::random::{BLOCK_LIGHT, BLOCK_START, Domain, Sampler};
use photon_core::{
    Backend, Batch, CausticPhotons, Direct, EnvironmentMap, Estimator, Indirect, Light, MapKind, MediaDeposits, Pass,
    PerMap, Photon, PhotonRay, ProjectionMap, Ray, RayCaster, Render, Requirements, Settings, TransportBackend,
    sampling,
};
use photon_scene::{Accel, CameraDesc, LightDesc, MaterialDesc, Scene, SceneBuilder, Sun, shapes};

use crate::equivalence::rays;
use crate::harness::{TestBackend, per_pass, renderer};
use crate::stats::{agrees, assert_agrees, moments, standard_error};

/// Kinds of lights, one scene each; the last has all of them.
const LIGHT_KINDS: [&str; 7] = ["point", "spot", "outside", "sun", "panel", "environment", "all"];

/// A glass ball, a mirror and a pane above a floor, lit by `kinds`. If not `whole`, only a small bead in the place
/// of the ball: a scene for a projection map that does not match.
fn room(kinds: &str, whole: bool) -> Scene {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    let glass = builder.material(MaterialDesc::glass("glass", 1.5));
    let metal = builder.material(MaterialDesc::mirror("metal", [0.9, 0.8, 0.7]));
    let pane = builder.material(MaterialDesc::thin("pane", 1.5));
    builder.quad("floor", [[-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0], [-2.0, 0.0, -2.0]], grey);
    let (positions, triangles) = shapes::icosphere(3, [0.3, 0.6, -0.2], if whole { 0.35 } else { 0.02 });
    builder.mesh("ball", positions, triangles, glass);
    let (metal, pane) = if whole { (metal, pane) } else { (grey, grey) };
    builder.quad("mirror", [[-1.2, 0.1, -0.4], [-0.7, 0.1, -0.8], [-0.7, 0.6, -0.8], [-1.2, 0.6, -0.4]], metal);
    builder.quad("pane", [[0.9, 0.1, 0.2], [1.4, 0.1, 0.6], [1.4, 0.5, 0.6], [0.9, 0.5, 0.2]], pane);
    let has = |kind: &str| kinds == kind || kinds == "all";
    if has("point") {
        builder.light("point", LightDesc::Point { position: [-0.2, 1.9, 0.4], intensity: [2.0, 1.0, 1.0] });
    }
    if has("spot") {
        let (position, direction) = ([1.5, 1.8, 0.3], [-1.0, -1.0, -0.3]);
        let (inner_angle, outer_angle) = (0.2, 0.7);
        builder.light("spot", LightDesc::Spot { position, direction, intensity: [3.0; 3], inner_angle, outer_angle });
    }
    if has("outside") {
        builder.light("far", LightDesc::Point { position: [4.0, 6.0, 1.0], intensity: [30.0, 20.0, 10.0] });
        let (position, direction) = ([-5.0, 4.0, 2.0], [5.0, -3.6, -2.5]);
        let (inner_angle, outer_angle) = (0.1, 0.9);
        builder.light("wide", LightDesc::Spot { position, direction, intensity: [20.0; 3], inner_angle, outer_angle });
    }
    if kinds == "sun" {
        let (direction, irradiance) = ([0.3, -1.0, 0.2], [0.2, 0.3, 0.5]);
        builder.sun(Sun::new(direction, irradiance).with_radius_degrees(5.0));
    } else if has("sun") {
        builder.light("sun", LightDesc::Directional { direction: [0.3, -1.0, 0.2], irradiance: [0.2, 0.3, 0.5] });
    }
    if has("panel") {
        let lit = builder.material(MaterialDesc::emissive("panel", [0.0; 3], [1.0; 3]));
        builder.quad("panel", [[-1.0, 2.0, -1.0], [0.5, 2.0, -1.0], [0.5, 2.0, 0.2], [-1.0, 2.0, 0.2]], lit);
    }
    if has("environment") {
        // Half of its light from a ninth of the directions.
        let texel = |i: usize| if i % 9 == 4 { [2.0, 2.5, 3.0] } else { [0.3; 3] };
        builder.environment(EnvironmentMap::new(12, &(0..72).map(texel).collect::<Vec<_>>(), 0.1).unwrap());
    }
    if has("sheet") {
        let both = MaterialDesc::emissive("sheet", [0.2; 3], [2.0; 3]).with_both_sides(true);
        let lit = builder.material(both);
        builder.quad("sheet", [[-0.4, 0.3, -0.6], [-0.4, 0.3, 0.4], [-0.4, 1.2, 0.4], [-0.4, 1.2, -0.6]], lit);
    }
    builder.camera("above", CameraDesc::look_at([0.0, 3.0, 1.0], [0.0; 3], [0.0, 0.0, -1.0], 1.0));
    builder.build().unwrap()
}

/// For each of several passes, the flux of the caustic map per path, mean of RGB, and its moments along x and z.
/// Paths are emitted in all directions, or through `projection`.
fn caustics<T: TestBackend>(
    scene: &Scene,
    projection: Option<&ProjectionMap>,
    passes: u32,
    paths: u32,
) -> Vec<[f64; 3]> {
    let settings = Settings { seed: 21, ..Settings::default() };
    let mut on = T::make(2);
    let view = scene.view();
    let required = Requirements::of(&view, &settings);
    let prepared = on.prepare(&view, &required).unwrap();
    let mut stages = on.stages(&required, &settings).unwrap();
    let (mut emitter, mut tracer) = match projection {
        None => (stages.emitter, stages.tracer),
        Some(projection) => {
            stages.aimed = None;
            on.aimed(&required, &settings, projection).unwrap().unwrap()
        }
    };
    let mut rays = on.alloc::<PhotonRay>("rays", u64::from(paths)).unwrap();
    let mut kept = on.alloc::<Photon>("caustic", u64::from(paths) * 8).unwrap();
    let mut home = Vec::new();
    (0..passes)
        .map(|index| {
            let pass = Pass { seed: settings.seed, index, random: settings.random, sample: 0, samples: 1 };
            let batch = Batch { pass, paths: 0..paths };
            on.clear(&mut kept).unwrap();
            emitter.emit(&mut on, &prepared, &batch, &mut rays).unwrap();
            let deposits = PerMap::only(MapKind::Caustic, &mut kept);
            tracer.trace(&mut on, &prepared, &batch, &rays, deposits, MediaDeposits::default()).unwrap();
            let tally = tracer.take_tally(&mut on).unwrap();
            assert!(
                tally.balances() && tally.stored[MapKind::Direct] + tally.stored[MapKind::Global] == 0,
                "{tally:?}"
            );
            assert_eq!(tally.terminated > 0, projection.is_some());
            on.download(&kept, &mut home).unwrap();
            assert_eq!(tally.stored[MapKind::Caustic], home.len() as u64);
            let mut sums = [0.0; 3];
            for photon in &home {
                let power = photon.power.iter().map(|&p| f64::from(p)).sum::<f64>() / 3.0 / f64::from(paths);
                sums[0] += power;
                sums[1] += power * f64::from(photon.position[0]);
                sums[2] += power * f64::from(photon.position[2]);
            }
            sums
        })
        .collect()
}

/// Means of both and the standard error of their difference, √(s²/n + s'²/n'), for one of the sums.
fn compared(a: &[[f64; 3]], b: &[[f64; 3]], sum: usize) -> (f64, f64, f64) {
    let of = |values: &[[f64; 3]]| values.iter().map(|v| v[sum]).collect::<Vec<_>>();
    let (a, b) = (of(a), of(b));
    (moments(&a).0, moments(&b).0, standard_error(&a).hypot(standard_error(&b)))
}

/// G1: flux and position of the caustic photons agree with those of photons emitted in all directions, for each
/// kind of light. With the projection map of another scene they do not agree.
pub fn g1_aimed_photons_have_the_same_expectation<T: TestBackend>() {
    for kinds in LIGHT_KINDS {
        let scene = room(kinds, true);
        let projection = ProjectionMap::of(&scene.view());
        let plain = caustics::<T>(&scene, None, 8, 4000);
        let aimed = caustics::<T>(&scene, Some(&projection), 8, 1000);
        for sum in 0..3 {
            let (truth, found, error) = compared(&plain, &aimed, sum);
            assert_agrees(kinds, found, truth, error, 0.0);
        }
        let noise = |values: &[[f64; 3]]| moments(&values.iter().map(|v| v[0]).collect::<Vec<_>>()).1;
        let gain = noise(&plain) * 4000.0 / (noise(&aimed) * 1000.0);
        eprintln!("{kinds}: share {:.3}, variance of a path's flux {gain:.1} times less", projection.share());
        let wrong = caustics::<T>(&scene, Some(&ProjectionMap::of(&room(kinds, false).view())), 8, 1000);
        let (truth, found, error) = compared(&plain, &wrong, 0);
        assert!(!agrees(found, truth, error, 0.0), "{kinds}: {found} {truth} {error}");
    }
}

/// The marked cells of a projection map, as pairs of light and cell, to look up the cell through which an ordinary
/// photon leaves.
struct Cells<'a> {
    projection: &'a ProjectionMap,
    marked: BTreeSet<(u32, u32)>,
}

impl<'a> Cells<'a> {
    fn new(projection: &'a ProjectionMap) -> Self {
        let own = |t: &photon_core::ProjectionTarget| {
            let (light, first) = (t.light, t.first as usize);
            projection.cells()[first..first + t.count as usize].iter().map(move |&cell| (light, cell))
        };
        Self { projection, marked: projection.targets().iter().flat_map(own).collect() }
    }

    /// Whether the cell is marked through which a photon of `light` with these random words leaves along `ray`.
    fn holds(&self, light: &Light, ray: &PhotonRay, words: [u32; 4], [c, d, ..]: [u32; 4]) -> bool {
        let Some(t) = self.projection.targets().iter().find(|t| t.light == ray.light) else { return false };
        let [_, mut a, mut b, side] = words;
        if matches!(light.kind, Light::ENVIRONMENT | Light::DIRECTIONAL) {
            // The words by which it would start through the disc of aimed photons, where it crosses its plane.
            let disc = self.projection.disc(t);
            let way = Vec3::from(ray.direction);
            let axis = if light.kind == Light::DIRECTIONAL { light.direction.into() } else { way };
            let (tangent, bitangent) = sampling::basis(axis);
            let from_centre = Vec3::from(ray.origin) - disc.centre;
            let across = (from_centre - way * (from_centre.dot(axis) / way.dot(axis))) / disc.radius;
            let at = Vec2::new(across.dot(tangent), across.dot(bitangent)).as_dvec2();
            if at.length_squared() > 1.0 {
                return false;
            }
            let word = |share: f64| (share * 4_294_967_296.0) as u32;
            (a, b) = (word(at.length_squared()), word((at.to_angle() / TAU).rem_euclid(1.0)));
        }
        let (light, both) = (ray.light, light.flags & Light::BOTH_SIDES != 0);
        let upper = |word: u32, bits: u32| if bits == 0 { 0 } else { word >> (32 - bits) };
        let (p, q) = (t.point_bits, t.direction_bits);
        let side = if both { side >> 31 } else { 0 };
        let cell = (((side << p | upper(a, p)) << p | upper(b, p)) << q | upper(c, q)) << q | upper(d, q);
        self.marked.contains(&(light, cell))
    }
}

/// G2: every ordinary photon whose first surface is specular leaves through a marked cell. Aimed photons therefore
/// need no defensive share.
pub fn g2_all_ways_to_something_specular_are_marked<T: TestBackend>() {
    for kinds in LIGHT_KINDS {
        let scene = room(kinds, true);
        let view = scene.view();
        let settings = Settings { seed: 5, ..Settings::default() };
        let mut on = T::make(2);
        let required = Requirements::of(&view, &settings);
        let prepared = on.prepare(&view, &required).unwrap();
        let mut emitter = on.stages(&required, &settings).unwrap().emitter;
        let paths = 20_000;
        let mut rays = on.alloc::<PhotonRay>("rays", u64::from(paths)).unwrap();
        let pass = Pass { seed: settings.seed, index: 0, random: settings.random, sample: 0, samples: 1 };
        emitter.emit(&mut on, &prepared, &Batch { pass, paths: 0..paths }, &mut rays).unwrap();
        let mut home = Vec::new();
        on.download(&rays, &mut home).unwrap();
        let caster = Accel::build(view.positions, view.triangles).unwrap();
        // Counts of the photons whose first surface is specular: those with an unmarked cell and those with a
        // marked one.
        let missed = |projection: &ProjectionMap| {
            let cells = Cells::new(projection);
            let mut counts = [0_u32; 2];
            for ray in &home {
                let way = Ray { origin: ray.origin.into(), direction: ray.direction.into(), t_max: f32::INFINITY };
                let Some(hit) = caster.nearest(&way) else { continue };
                if view.materials[view.primitives[hit.primitive as usize].material as usize].is_diffuse() {
                    continue;
                }
                let mut sampler = Sampler::new(pass.random, pass.seed, pass.index, Domain::Photon, ray.path);
                let (words, start) = (sampler.words(BLOCK_LIGHT), sampler.words(BLOCK_START));
                let light = &view.lights[ray.light as usize];
                counts[usize::from(cells.holds(light, ray, words, start))] += 1;
            }
            counts
        };
        let [lost, held] = missed(&ProjectionMap::of(&view));
        assert!(lost == 0 && held > 200, "{kinds}: {lost} of {}", lost + held);
        let [lost, _] = missed(&ProjectionMap::of(&room(kinds, false).view()));
        assert!(lost > 10, "{kinds}: {lost}");
    }
}

/// G3: images with aimed photons have the same mean, with final gathering and with caustics only; 12 independent
/// passes each.
pub fn g3_aimed_pictures_have_the_same_mean<T: TestBackend>() {
    let scene = room("all", true);
    for indirect in [Indirect::None, Indirect::Gather] {
        let values = |caustic_photons| {
            let settings = Settings {
                photons: 4000,
                direct: Direct::None,
                indirect,
                gather_rays: 2,
                estimator: Estimator::Radius { radius: Some(0.15) },
                caustic_photons,
                ..Settings::default()
            };
            per_pass::<T>(&scene, &settings, 12, 12)
        };
        let (plain, aimed) = (values(CausticPhotons::Shared), values(CausticPhotons::Aimed(1000)));
        let error = standard_error(&plain).hypot(standard_error(&aimed));
        eprintln!("{indirect:?}: {:e} and {:e} of variance", moments(&plain).1, moments(&aimed).1);
        assert_agrees("mean", moments(&aimed).0, moments(&plain).0, error, 0.0);
    }
}

/// G4: aimed paths have their own tally, which balances; ordinary paths then store no caustic photons; a scene
/// without specular surfaces has no aimed paths.
pub fn g4_aimed_paths_are_accounted_for<T: TestBackend>() {
    let scene = photon_scene::builtin("cornell-glass").unwrap().build().unwrap();
    let caustic_photons = CausticPhotons::Aimed(2500);
    let settings = Settings { photons: 5000, caustic_photons, ..Settings::default() };
    let mut with = renderer::<T>(&scene, &settings, 8);
    let photon_core::PassEnd::Done(report) = with.pass(0, &mut ()).unwrap() else { panic!("pass was interrupted") };
    let facts = with.facts();
    assert_eq!(facts.aimed, Some(2500));
    assert!(facts.memory.iter().any(|(label, _)| label.contains("aimed")));
    assert_eq!((report.tally.emitted, report.aimed.emitted), (5000, 2500));
    assert!(report.tally.balances() && report.aimed.balances(), "{report:?}");
    assert!(
        report.tally.stored[MapKind::Caustic] == 0
            && report.tally.terminated == 0
            && report.aimed.stored[MapKind::Caustic] > 100
    );
    assert!(report.aimed.terminated >= report.aimed.stored[MapKind::Caustic]);
    // The flux through marked cells is as expected: two lights of nearly the same share.
    let share = report.aimed.flux_emitted.value().iter().sum::<f64>() / 3.0 / 2500.0;
    assert!((share / ProjectionMap::of(&scene.view()).share() - 1.0).abs() < 0.02, "{share}");
    for (name, caustic_photons) in [("cornell", CausticPhotons::Aimed(1000)), ("cornell-glass", CausticPhotons::Shared)]
    {
        let scene = photon_scene::builtin(name).unwrap().build().unwrap();
        let settings = Settings { caustic_photons, ..settings.clone() };
        let mut without = renderer::<T>(&scene, &settings, 8);
        without.pass(0, &mut ()).unwrap();
        let facts = without.facts();
        assert!(facts.aimed.is_none() && !facts.memory.iter().any(|(label, _)| label.contains("aimed")), "{name}");
    }
}

/// G5: near both poles of a point light, the heights of directions have more than 24 bits. With 24 bits they would
/// be whole multiples of 2⁻²⁴; the distance from whole numbers must instead be uniform in [0, 1/2], with standard
/// deviation 1/√48.
pub fn g5_directions_about_poles_are_fine<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    let metal = builder.material(MaterialDesc::mirror("metal", [0.9; 3]));
    builder.quad("floor", [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, -1.0]], grey);
    let h = 0.05;
    for z in [-1.0, 1.0] {
        builder.quad("mirror", [[-h, -h, z], [h, -h, z], [h, h, z], [-h, h, z]], metal);
    }
    builder.light("light", LightDesc::Point { position: [0.0; 3], intensity: [1.0; 3] });
    let scene = builder.build().unwrap();
    let projection = ProjectionMap::of(&scene.view());
    let settings = Settings { seed: 7, ..Settings::default() };
    let sent = rays::<T>(&scene, &settings, Some(&projection), 400_000);
    for pole in [1.0_f32, -1.0] {
        let gaps: Vec<f64> = sent
            .iter()
            .filter(|ray| ray.direction[2] * pole > 0.0)
            .filter_map(|ray| {
                let [x, y, _] = ray.direction.map(f64::from);
                let squared = x * x + y * y;
                let number = squared / (2.0 * (1.0 + (1.0 - squared).sqrt())) * 16_777_216.0;
                (number < 64.0).then(|| (number - number.round()).abs())
            })
            .collect();
        let n = gaps.len() as f64;
        let (mean, error) = (moments(&gaps).0, (1.0 / (48.0 * n)).sqrt());
        assert_agrees("distance from whole numbers", mean, 0.25, error, 0.0);
        assert!(!agrees(0.0, 0.25, error, 0.0), "too few: {n}");
    }
}

use glam::Vec3;

use super::*;
use crate::scene::environment::EnvironmentMap;
use crate::scene::material::{Material, MaterialKind, Primitive};
use crate::scene::units::Units;
use crate::settings::Indirect;

/// A floor and a small mirror with spot lights above: one that is directed at the mirror, and one that is
/// directed away.
struct Tables {
    positions: Vec<[f32; 3]>,
    lights: Vec<Light>,
    starts: Vec<u32>,
    materials: Vec<Material>,
}

impl Tables {
    fn new() -> Self {
        let triangle = |y: f32, s: f32| [[-s, y, -s], [s, y, -s], [0.0, y, s]];
        let v = |degrees: f32| 1.0 - degrees.to_radians().cos();
        let spot = |y: f32, power: f32| Light {
            kind: Light::SPOT,
            position: [0.0, 0.4, -0.1],
            direction: [0.0, y, 0.0],
            power: [power; 3],
            versine_inner: v(10.0),
            versine_outer: v(20.0),
            primitive: u32::MAX,
            ..Light::default()
        };
        Self {
            positions: [triangle(-0.5, 0.5), triangle(-0.4, 0.1)].concat(),
            lights: vec![
                spot(1.0, 0.5),
                spot(-1.0, 0.25),
                spot(-1.0, 0.0),
                Light { kind: Light::POINT, ..spot(0.0, 0.25) },
            ],
            starts: light_cdf(&[0.5, 0.25, 0.0, 0.25]),
            materials: vec![
                Material { albedo: [0.5; 3], ..Material::default() },
                Material { kind: MaterialKind::Mirror as u32, albedo: [1.0; 3], ..Material::default() },
            ],
        }
    }

    fn view(&self) -> SceneView<'_> {
        const PRIMITIVES: [Primitive; 2] =
            [Primitive { normal: [0.0, 1.0, 0.0], material: 0 }, Primitive { normal: [0.0, 1.0, 0.0], material: 1 }];
        SceneView {
            positions: &self.positions,
            triangles: &[[0, 1, 2], [3, 4, 5]],
            primitives: &PRIMITIVES,
            materials: &self.materials,
            media: &[crate::scene::medium::Medium::VACUUM],
            lights: &self.lights,
            light_cdf: &self.starts,
            radius: 1.0,
            units: Units::default(),
            ..SceneView::default()
        }
    }
}

#[test]
fn lights_that_reach_nothing_specular_are_no_targets() {
    let mut tables = Tables::new();
    let projection = ProjectionMap::of(&tables.view());
    // Neither the one that is directed away nor the one without power.
    assert_eq!(projection.targets().iter().map(|t| t.light).collect::<Vec<_>>(), [1, 3]);
    assert!(projection.share() > 0.0 && projection.share() < 0.3, "{}", projection.share());
    tables.lights.truncate(1);
    let nothing = ProjectionMap::of(&tables.view());
    assert!(nothing.is_empty() && nothing.share() == 0.0);
    let settings = Settings { caustic_photons: CausticPhotons::Aimed(7), ..Settings::default() };
    let required = Requirements::everything(&settings);
    assert_eq!(ProjectionMap::chosen(&tables.view(), &settings, &required), Err(NoProjection::Unlit));
    tables = Tables::new();
    tables.materials[1].kind = MaterialKind::Lambert as u32;
    assert!(ProjectionMap::of(&tables.view()).is_empty());
}

#[test]
fn aiming_is_left_where_it_would_not_pay() {
    let [mut few, mut many] = [Tables::new(), Tables::new()];
    few.lights[0].power = [50.0; 3];
    // Nearly all of the light goes down, where the floor is a mirror now.
    many.lights[1].power = [50.0; 3];
    many.materials[0].kind = MaterialKind::Mirror as u32;
    let share = |tables: &Tables| ProjectionMap::of(&tables.view()).share();
    assert!(
        share(&few) < ProjectionMap::WORTH && share(&many) > ProjectionMap::WORTH,
        "{} {}",
        share(&few),
        share(&many)
    );
    let paths = |tables: &Tables, caustic_photons, indirect| {
        let settings = Settings { photons: 100, caustic_photons, indirect, ..Settings::default() };
        let chosen = ProjectionMap::chosen(&tables.view(), &settings, &Requirements::everything(&settings));
        chosen.map(|(projection, paths)| {
            assert_eq!(projection, ProjectionMap::of(&tables.view()));
            paths
        })
    };
    use CausticPhotons::{Aimed, Auto, Shared};
    let map = Indirect::Map;
    assert_eq!((paths(&few, Auto, map), paths(&many, Auto, map)), (Ok(25), Err(NoProjection::NotWorth)));
    // Ten times as dense as the other photons.
    let some = Tables::new();
    assert!(share(&some) > 0.025 && share(&some) < 0.2, "{}", share(&some));
    assert_eq!(paths(&some, Auto, map), Ok((1000.0 * share(&some)) as u32));
    // Where that light meets rough metal instead of the mirror, only if there is little of it.
    let metal = Material { kind: MaterialKind::Glossy as u32, metallic: 1.0, roughness: 0.3, ..some.materials[0] };
    for (table, expected) in [(&few, Ok(25)), (&some, Err(NoProjection::NotWorth))] {
        let mut rough = Tables { positions: table.positions.clone(), starts: table.starts.clone(), ..Tables::new() };
        rough.lights = table.lights.clone();
        rough.materials[1] = metal;
        assert_eq!(paths(&rough, Auto, map), expected);
        assert_eq!(paths(&rough, Aimed(9), map), Ok(9));
    }
    // A smooth mirror that less than half of it meets, above a floor of rough metal.
    let mut beside = Tables::new();
    beside.materials[0] = metal;
    assert!(share(&beside) < ProjectionMap::WORTH && share(&some) < 0.5 * share(&beside), "{}", share(&beside));
    assert_eq!(paths(&beside, Auto, map), Err(NoProjection::NotWorth));
    assert_eq!((paths(&few, Shared, map), paths(&many, Aimed(9), map)), (Err(NoProjection::Shared), Ok(9)));
    // No other map needs photons.
    assert_eq!(paths(&many, Auto, Indirect::None), Ok(100));
}

/// Photons of an environment are aimed where a number is given or nothing else needs photons; beside other maps only where it
/// brings less than half of the light.
#[test]
fn environments_are_aimed_where_they_are_asked_to_be() {
    let map = EnvironmentMap::new(8, &[[1.0; 3]; 32], 0.0).unwrap();
    let chosen = |power: f32, caustic_photons, indirect| {
        let mut tables = Tables::new();
        tables.lights[0] = Light { kind: Light::ENVIRONMENT, power: [power; 3], radius: 0.9, ..Light::default() };
        let view = SceneView { environment: Some(&map), ..tables.view() };
        let settings = Settings { photons: 100, caustic_photons, indirect, ..Settings::default() };
        ProjectionMap::chosen(&view, &settings, &Requirements::everything(&settings)).map(|(projection, paths)| {
            let target = projection.targets()[0];
            assert_eq!(target.light, 0);
            // The mirror is within a tenth of the scene's radius, and its disc too.
            let disc = projection.disc(&target);
            assert!(disc.radius < 0.15 && (disc.centre - Vec3::new(0.0, -0.4, 0.0)).length() < 0.05, "{disc:?}");
            let share = f64::from(target.carried[0] / power) * light_probability(projection.starts(), 0);
            assert!(share > 0.01 && share <= 1.001 * f64::from(disc.radius / 0.9).powi(2), "{share}");
            paths
        })
    };
    use CausticPhotons::{Aimed, Auto};
    assert_eq!(chosen(50.0, Auto, Indirect::Map), Err(NoProjection::Environment));
    // A tiny mirror, which other paths would hardly ever find.
    let mut plain = Tables::new();
    plain.lights.truncate(1);
    plain.lights[0] = Light { kind: Light::ENVIRONMENT, power: [50.0; 3], radius: 0.9, ..Light::default() };
    plain.starts = light_cdf(&[50.0]);
    for at in &mut plain.positions[3..] {
        *at = [0.05 * at[0], at[1], 0.05 * at[2]];
    }
    let settings = Settings { photons: 100, ..Settings::default() };
    let view = SceneView { environment: Some(&map), ..plain.view() };
    let found = ProjectionMap::chosen(&view, &settings, &Requirements::everything(&settings));
    assert_eq!(found.map(|(_, paths)| paths), Ok(25));
    assert_eq!(chosen(50.0, Auto, Indirect::None), Ok(100));
    assert_eq!(chosen(50.0, Aimed(9), Indirect::Map), Ok(9));
    // Half of the light in both spot and point lights, of which cells are marked: more of it is an environment, of which
    // all counts.
    assert!(matches!(chosen(0.1, Auto, Indirect::Map), Ok(25..200)));
    assert_eq!(chosen(0.28, Auto, Indirect::Map), Err(NoProjection::NotWorth));
}

/// Gives the same result as the share of all cells, to the last bit, with less work.
#[test]
fn marking_ends_as_soon_as_the_answer_is_no() {
    for power in [0.0, 0.5, 2.0, 3.0, 50.0] {
        let mut tables = Tables::new();
        tables.lights[0].power = [power; 3];
        let all = ProjectionMap::mark(&tables.view(), f64::INFINITY);
        let share = all.projection.share();
        assert!(all.whole && share > 0.0);
        for most in [share, share.next_down(), share.next_up(), 0.5 * share, ProjectionMap::WORTH, 0.0] {
            let marked = ProjectionMap::mark(&tables.view(), most);
            assert_eq!(marked.whole, share <= most, "{share} {most}");
            assert!(if marked.whole { marked.blocks == all.blocks } else { marked.blocks <= all.blocks });
        }
    }
    // A point light, and two mirrors that are visible from it in all directions.
    let mut tables = Tables::new();
    tables.materials[0].kind = MaterialKind::Mirror as u32;
    tables.lights = vec![Light { position: [0.0, -0.45, -0.05], power: [1.0; 3], ..tables.lights[3] }];
    let [all, enough] = [f64::INFINITY, 0.05].map(|most| ProjectionMap::mark(&tables.view(), most));
    assert!(all.projection.share() > 0.7 && !enough.whole, "{}", all.projection.share());
    assert!(12 * enough.blocks < all.blocks, "{} of {}", enough.blocks, all.blocks);
}

/// The mean power of aimed photons is the power in marked cells. The point light is outside, with a cone around the scene of the
/// sine r/d, and a little room for rounding; the others are narrower.
#[test]
fn what_photons_carry_adds_up_to_the_share() {
    let tables = Tables::new();
    let projection = ProjectionMap::of(&tables.view());
    let (squared_radius, squared_distance) = (0.5 + 0.05 * 0.05, 0.85 * 0.85 + 0.1 * 0.1);
    let share_of_point = 0.5 * (1.0 - (1.0_f64 - squared_radius / squared_distance).sqrt());
    let all = 0.75 + 0.25 * share_of_point;
    let sum = |(index, target): (usize, &ProjectionTarget)| {
        light_probability(projection.starts(), index) * f64::from(target.carried.iter().sum::<f32>()) / 3.0
    };
    let mean: f64 = projection.targets().iter().enumerate().map(sum).sum();
    assert!((mean / (all * projection.share()) - 1.0).abs() < 1e-3, "{mean} {}", projection.share());
    let exact = 0.75 + 0.25 * LightCone::arriving(&tables.view())[3];
    assert!((mean / (exact * projection.share()) - 1.0).abs() < 1e-6, "{mean} {}", projection.share());
    // Except for the share that is distributed evenly over all lights.
    let [a, b] = [0, 1].map(|i: usize| projection.targets()[i].carried[0]);
    assert!((0.5..2.0).contains(&(a / b)), "{a} {b}");
}

/// Every marked cell is sampled equally often, and uniformly within.
#[test]
fn cells_are_drawn_evenly() {
    let projection = ProjectionMap::of(&Tables::new().view());
    for (index, target) in projection.targets().iter().enumerate() {
        let (p, q) = (target.point_bits, target.direction_bits);
        let choice = projection.starts()[index];
        let of = |sample: &ProjectionSample| {
            let [[a, b], [c, d]] = [(sample.point, p), (sample.direction, q)]
                .map(|(words, bits)| words.map(|w| (u64::from(w) >> (32 - bits)) as u32));
            ((a << p | b) << q | c) << q | d
        };
        let own = &projection.cells()[target.first as usize..(target.first + target.count) as usize];
        let tries = 16 * target.count;
        let mut seen = vec![0_u32; own.len()];
        let mut upper = 0;
        for i in 0..tries {
            let c = ((u64::from(i) << 32) / u64::from(tries)) as u32 + 7;
            let sample = projection.sample([choice, 1 << 31, 5, 0], [c, 3 << 30, 0, 0]);
            assert_eq!((sample.target, sample.direction[1] << q >> 30), (index, 3));
            seen[own.iter().position(|&cell| cell == of(&sample)).unwrap()] += 1;
            upper += sample.direction[0] << q >> 31;
        }
        assert!(seen.iter().all(|&times| (15..=17).contains(&times)), "{seen:?}");
        assert!(upper.abs_diff(tries / 2) <= target.count, "{upper} of {tries}");
    }
}

/// With many emissive triangles, tables and work stay small.
#[test]
fn many_lights_have_few_cells_each() {
    let tables = Tables::new();
    let count = 100_000;
    let lights =
        vec![Light { kind: Light::TRIANGLE, primitive: 0, power: [1e-5; 3], area: 0.5, ..Light::default() }; count];
    let starts = light_cdf(&vec![1e-5; count]);
    let projection = ProjectionMap::of(&SceneView { lights: &lights, light_cdf: &starts, ..tables.view() });
    assert!(projection.targets().len() == count && projection.cells().len() <= CELLS, "{}", projection.cells().len());
}

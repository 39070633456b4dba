//! Coarse meshes with vertex normals: shadow rays start outside them, so that the shadow terminator is that of the smooth
//! surface.

use photon_core::{Direct, EnvironmentMap, Film, Indirect, Settings};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, Surface, VertexAttributes, shapes};

use crate::harness::{TestBackend, film, look_at_point};

/// A sphere of `20 · 4^level` triangles with the normals of a sphere.
fn ball(builder: &mut SceneBuilder, level: u32, (center, radius): ([f64; 3], f64), material: MaterialDesc) {
    let (positions, triangles) = shapes::icosphere(level, center, radius);
    let normal = |p: &[f64; 3]| std::array::from_fn(|axis| (p[axis] - center[axis]) / radius);
    let attributes = VertexAttributes::default().with_normals(positions.iter().map(normal).collect());
    let material = builder.material(material);
    builder.mesh_with("ball", positions, triangles, attributes, material);
}

fn white() -> MaterialDesc {
    MaterialDesc::lambert("white", [1.0; 3])
}

fn settings(terminator_offset: bool) -> Settings {
    Settings { terminator_offset, indirect: Indirect::None, caustics: false, ..Settings::default() }
}

/// Where the light of the first test comes from: at a right angle to no edge of the balls.
const TOWARDS_LIGHT: [f64; 3] = [0.8, 0.36, -0.48];

/// The ratio of two sums over the pixels near the shadow terminator, where the cosine of the shading normal to the light is
/// in (.03, .25): of the radiance, and of that cosine.
fn near_terminator(film: &Film) -> f64 {
    let (mut found, mut expected) = (0.0, 0.0);
    for (pixel, normal) in film.beauty().iter().zip(film.normal()) {
        let cosine = (0..3).map(|axis| f64::from(normal[axis]) * TOWARDS_LIGHT[axis]).sum::<f64>();
        if cosine > 0.03 && cosine < 0.25 {
            found += f64::from(pixel[0]);
            expected += cosine;
        }
    }
    found / expected
}

/// A Lambertian sphere in parallel light of irradiance π: the radiance is the cosine to the shading normal, which is the
/// sphere's above the point of the triangle. Near the terminator, a coarse sphere lacks a part of it, where triangles that
/// face away from the light are black; with the offset, it is whole.
pub fn parallel_light_on_a_coarse_sphere<T: TestBackend>() {
    for (level, lacks) in [(1, 0.05), (2, 0.02)] {
        let mut builder = SceneBuilder::new();
        ball(&mut builder, level, ([0.0; 3], 1.0), white());
        let direction = TOWARDS_LIGHT.map(|c| -c);
        builder.light("sun", LightDesc::Directional { direction, irradiance: [std::f64::consts::PI; 3] });
        look_at_point(&mut builder, [0.0; 3], [0.0, 0.0, 1.0], 3.0, 0.65);
        let scene = builder.build().unwrap();
        let [on, off] = [true, false].map(|offset| near_terminator(&film::<T>(&scene, &settings(offset), 4, 48)));
        eprintln!("level {level}: {on} with the offset, {off} without");
        assert!((on - 1.0).abs() < 1e-3 && off < 1.0 - lacks, "level {level}: {on} {off}");
    }
}

/// The inside of a sphere is hollow, and a ball without vertex normals is not smooth: nothing changes, to the bit.
pub fn hollow_and_flat_meshes_are_unchanged<T: TestBackend>() {
    let lit = |builder: &mut SceneBuilder, away: f64| {
        builder.light("point", LightDesc::Point { position: [0.3, 0.1, away * 0.9], intensity: [1.0; 3] });
        look_at_point(builder, [0.0; 3], [0.0, 0.0, 1.0], away, 0.5);
        builder.clone().build().unwrap()
    };
    let same = |scene: &Scene| {
        let [on, off] = [true, false].map(|offset| film::<T>(scene, &settings(offset), 1, 16).beauty());
        assert!(on.iter().any(|pixel| pixel[0] > 0.0));
        on == off
    };
    let mut inside = SceneBuilder::new();
    ball(&mut inside, 1, ([0.0; 3], 1.0), white());
    assert!(same(&lit(&mut inside.clone(), 0.5)));
    assert!(!same(&lit(&mut inside, 1.5)));
    let mut flat = SceneBuilder::new();
    let (positions, triangles) = shapes::icosphere(1, [0.0; 3], 1.0);
    let material = flat.material(white());
    flat.mesh("ball", positions, triangles, material);
    assert!(same(&lit(&mut flat, 1.5)));
}

/// A wall close to a coarse sphere: no shadow ray starts behind it. Without the wall, the light is there.
pub fn offsets_do_not_pass_through_walls<T: TestBackend>() {
    let picture = |wall: bool| {
        let mut builder = SceneBuilder::new();
        ball(&mut builder, 0, ([0.0; 3], 1.0), white());
        // The middle of a triangle of an icosahedron is .7947 from the centre, and p' is at 1.0875.
        let (positions, triangles) = shapes::icosphere(0, [0.0; 3], 1.0);
        let corners = triangles[0].map(|index| positions[index as usize]);
        let middle: [f64; 3] = std::array::from_fn(|axis| corners.iter().map(|p| p[axis]).sum::<f64>() / 3.0);
        let length = middle.iter().map(|c| c * c).sum::<f64>().sqrt();
        let outwards = middle.map(|c| c / length);
        if wall {
            let side: [f64; 3] = std::array::from_fn(|axis| corners[1][axis] - corners[0][axis]);
            let up = [
                outwards[1] * side[2] - outwards[2] * side[1],
                outwards[2] * side[0] - outwards[0] * side[2],
                outwards[0] * side[1] - outwards[1] * side[0],
            ];
            let corner = |a: f64, b: f64| {
                std::array::from_fn(|axis| outwards[axis] * (length + 0.05) + side[axis] * a + up[axis] * b)
            };
            let material = builder.material(white());
            builder.quad(
                "wall",
                [corner(-3.0, -3.0), corner(3.0, -3.0), corner(3.0, 3.0), corner(-3.0, 3.0)],
                material,
            );
        }
        let position = outwards.map(|c| 3.0 * c);
        builder.light("point", LightDesc::Point { position, intensity: [9.0; 3] });
        look_at_point(&mut builder, middle, outwards, 0.025, 0.1);
        film::<T>(&builder.build().unwrap(), &settings(true), 1, 8).beauty()
    };
    assert!(picture(false).iter().all(|pixel| pixel[0] > 0.1));
    assert!(picture(true).iter().all(|pixel| *pixel == [0.0; 3]));
}

/// White surfaces, diffuse and glossy, in an even environment of radiance 1: what shadow rays and onward rays find
/// together is 1, to the precision of the tables, on a coarse sphere too. Without the offset, the limit of the cosine takes
/// some of it.
pub fn furnace_of_coarse_spheres<T: TestBackend>() {
    let glossy = |metallic, roughness| {
        let surface = Surface::Glossy { base_color: [1.0; 3], metallic, roughness, specular: 1.0, ior: 1.5 };
        MaterialDesc::new("white", surface)
    };
    for (what, material) in [("metal", glossy(1.0, 0.5)), ("coat", glossy(0.0, 0.3)), ("diffuse", white())] {
        let mut builder = SceneBuilder::new();
        ball(&mut builder, 1, ([0.0; 3], 1.0), material);
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        look_at_point(&mut builder, [0.0; 3], [0.0, 0.0, 1.0], 3.0, 0.8);
        let scene = builder.build().unwrap();
        let mean = |offset: bool| {
            let s = Settings { direct: Direct::Nee, shadow_rays: 8, ..settings(offset) };
            let beauty = film::<T>(&scene, &s, 16, 16).beauty();
            beauty.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / beauty.len() as f64
        };
        let on = mean(true);
        assert!((on - 1.0).abs() < 2.5e-3, "{what}: {on}");
        if what == "metal" {
            let off = mean(false);
            assert!(off < 1.0 - 5e-3, "{what}: {off}");
        }
    }
}

/// Three coarse balls, of a diffuse surface, a metal and rough glass, in the light of a sun and a square light.
#[must_use]
pub fn coarse_balls() -> Scene {
    let mut builder = SceneBuilder::new();
    let glossy =
        Surface::Glossy { base_color: [0.9, 0.6, 0.3], metallic: 1.0, roughness: 0.4, specular: 1.0, ior: 1.5 };
    let glass = Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [1.0; 3], roughness: 0.5 };
    let materials = [white(), MaterialDesc::new("metal", glossy), MaterialDesc::new("glass", glass)];
    for (x, material) in [-0.7, 0.0, 0.7].into_iter().zip(materials) {
        ball(&mut builder, 1, ([x, 0.0, 0.0], 0.3), material);
    }
    let floor = builder.material(white());
    builder.quad("floor", [[-2.0, -0.35, 2.0], [2.0, -0.35, 2.0], [2.0, -0.35, -2.0], [-2.0, -0.35, -2.0]], floor);
    let light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [5.0; 3]));
    builder.quad("light", [[-1.5, 1.0, -0.5], [-1.0, 1.0, -0.5], [-1.0, 1.0, 0.5], [-1.5, 1.0, 0.5]], light);
    builder.light("sun", LightDesc::Directional { direction: [-0.9, -0.3, -0.1], irradiance: [2.0; 3] });
    look_at_point(&mut builder, [0.0; 3], [0.0, 0.0, 1.0], 3.0, 1.0);
    builder.build().unwrap()
}

//! Light through surfaces that coincide, in closed form: whatever the order of the meshes, and in scenes that are turned and
//! scaled.
//!
//! Photons that fall perpendicularly on layers split at each interface by Fresnel's equations, so that the light which passes
//! is a geometric series.

use photon_core::glam::{DMat3, DVec3};
use photon_core::{EnvironmentMap, Estimator, Pipeline, Render, Settings, View};
use photon_scene::{
    CameraDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Surface, TextureDesc, TextureRef,
    TexturesDesc, VertexAttributes, shapes,
};

use crate::harness::TestBackend;
use crate::stats::{assert_agrees, moments, standard_error};

const SIZE: u32 = 8;
const PASSES: u32 = 6;
/// So dark that what it reflects onto itself by way of the glass is below 10⁻³ of the light.
const DARK: f64 = 1e-3;

/// Position, size and orientation of a scene.
#[derive(Clone, Copy)]
struct Place {
    turn: DMat3,
    scale: f64,
}

impl Place {
    /// Rounded to f32, as in files: planes that coincided do so up to rounding.
    fn point(&self, at: [f64; 3]) -> [f64; 3] {
        (self.turn * DVec3::from(at) * self.scale).as_vec3().as_dvec3().to_array()
    }

    fn direction(&self, at: [f64; 3]) -> [f64; 3] {
        (self.turn * DVec3::from(at)).to_array()
    }
}

/// A horizontal part of a scene.
#[derive(Clone, Copy)]
enum Part {
    /// A diffuse square of this half side in the plane y = 0, and its albedo.
    Floor(f64, f64),
    /// A layer of a solid: half side, bottom and top, index and absorption.
    Layer(f64, [f64; 2], f64, f64),
    /// A layer with a face of both sides in the middle, in its mesh.
    Divided(f64, [f64; 2], f64, f64),
}

impl Part {
    fn add(self, builder: &mut SceneBuilder, place: &Place) {
        let (name, desc, (mut positions, mut triangles)) = match self {
            Self::Floor(half, albedo) => {
                let corners = vec![[-half, 0.0, half], [half, 0.0, half], [half, 0.0, -half], [-half, 0.0, -half]];
                ("floor", MaterialDesc::lambert("floor", [albedo; 3]), (corners, vec![[0, 1, 2], [0, 2, 3]]))
            }
            Self::Layer(half, [low, high], ior, absorption) | Self::Divided(half, [low, high], ior, absorption) => {
                let absorption = [absorption / place.scale; 3];
                let surface = Surface::Dielectric { ior, absorption, tint: [1.0; 3], roughness: 0.0 };
                let shape = shapes::cuboid([-half, low, -half], [half, high, half]);
                ("layer", MaterialDesc::new(format!("glass {ior}"), surface), shape)
            }
        };
        if let Self::Divided(half, [low, high], ..) = self {
            let (y, first) = (0.5 * (low + high), positions.len() as u32);
            positions.extend([[-half, y, half], [half, y, half], [half, y, -half], [-half, y, -half]]);
            let faces = [[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]];
            triangles.extend(faces.map(|face| face.map(|corner: u32| first + corner)));
        }
        let material = builder.material(desc);
        builder.mesh(name, positions.into_iter().map(|at| place.point(at)).collect(), triangles, material);
    }
}

/// Light on a scene.
#[derive(Clone, Copy)]
enum Light {
    /// Straight down, of irradiance π.
    Above,
    /// From everywhere, of radiance 1.
    Everywhere,
}

fn scene(parts: &[Part], light: Light, camera_height: f64, place: &Place) -> Scene {
    let mut builder = SceneBuilder::new();
    parts.iter().for_each(|part| part.add(&mut builder, place));
    match light {
        Light::Above => {
            let (direction, irradiance) = (place.direction([0.0, -1.0, 0.0]), [std::f64::consts::PI; 3]);
            builder.light("sun", LightDesc::Directional { direction, irradiance });
        }
        Light::Everywhere => builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap()),
    }
    let (from, down, up) =
        (place.point([0.0, camera_height, 0.0]), place.direction([0.0, -1.0, 0.0]), place.direction([0.0, 0.0, 1.0]));
    let projection = Projection::Orthographic { half_height: 0.5 * place.scale };
    builder.camera("eye", CameraDesc::new(from, down, up, projection));
    builder.build().unwrap()
}

/// Share of the light that passes layers of these indices and absorptions times thicknesses, from air to air, perpendicularly.
/// Below n layers of transmittance t that reflect b of light from below, an interface of reflectance r lets t (1−r)/(1−b r)
/// pass, and both reflect r + (1−r)² b/(1−b r).
fn passes(layers: &[(f64, f64)]) -> f64 {
    let (mut above, mut light, mut back) = (1.0, 1.0, 0.0_f64);
    for &(ior, depth) in layers.iter().chain([&(1.0, 0.0)]) {
        let r = ((ior - above) / (ior + above)).powi(2);
        let series = 1.0 / (1.0 - back * r);
        light *= (1.0 - r) * series * f64::exp(-depth);
        back = (r + (1.0 - r).powi(2) * back * series) * f64::exp(-2.0 * depth);
        above = ior;
    }
    light
}

/// Means of the passes, on a backend that is given back for the next scene.
fn render<T: TestBackend>(on: T::On, scene: &Scene, radius: f64) -> (T::On, Vec<f64>) {
    let estimator = Estimator::Radius { radius: Some(radius) };
    let settings = Settings { photons: 8000, alpha: 1.0, estimator, seed: 11, ..Settings::default() };
    let view = View { camera: scene.camera(None, SIZE, SIZE).unwrap(), width: SIZE, height: SIZE };
    let mut renderer = Pipeline::new(on, &scene.view(), view, settings).unwrap();
    let mut before = 0.0;
    let values = (0..PASSES).map(|pass| {
        renderer.pass(pass, &mut ()).unwrap();
        let beauty = renderer.film().unwrap().beauty();
        let sum = beauty.iter().flatten().map(|&c| f64::from(c)).sum::<f64>() / (3 * beauty.len()) as f64;
        let sum = sum * f64::from(pass + 1);
        sum - std::mem::replace(&mut before, sum)
    });
    let values = values.collect();
    (renderer.into_backend().unwrap(), values)
}

/// The radiance of `parts` is `truth` in both orders of the meshes, and turned and scaled. The standard error is that of the
/// means of independent passes; `bound` is relative.
fn check<T: TestBackend>(what: &str, parts: &[Part], (light, height): (Light, f64), truth: f64, bound: f64) {
    let turn = DMat3::from_axis_angle(DVec3::new(0.3, -0.7, 0.5).normalize_or_zero(), 0.3);
    let mut on = Some(T::make(2));
    for (turn, scale, is_reversed) in
        [(DMat3::IDENTITY, 1.0, false), (DMat3::IDENTITY, 1.0, true), (turn, 1e-3, false), (turn, 1e6, true)]
    {
        let mut parts = parts.to_vec();
        if is_reversed {
            parts.reverse();
        }
        let place = Place { turn, scale };
        let scene = scene(&parts, light, height, &place);
        let (back, values) = render::<T>(on.take().unwrap(), &scene, 0.25 * scale);
        on = Some(back);
        let what = format!("{what}, scale {scale}, reversed {is_reversed}: {:?}", scene.warnings());
        assert_agrees(&what, moments(&values).0, truth, standard_error(&values), bound * truth);
    }
}

/// A block of glass on a floor, with a film of air between: the sun passes twice, L = ρ T² E/π.
pub fn glass_on_a_floor<T: TestBackend>() {
    let block = Part::Layer(1.0, [0.0, 1.0], 1.5, 0.0);
    let truth = DARK * passes(&[(1.5, 0.0)]).powi(2);
    assert!((truth / DARK - 0.852).abs() < 1e-3);
    check::<T>("sun", &[Part::Floor(1.25, DARK), block], (Light::Above, 5.0), truth, 1e-3);
    // Thinner than what is resolved, with whose thickness nothing changes.
    let plate = Part::Layer(1.0, [0.0, 1e-6], 1.5, 0.0);
    check::<T>("a thin plate", &[Part::Floor(1.25, DARK), plate], (Light::Above, 5.0), truth, 1e-3);
    // Most of the sun's photons are nowhere near.
    check::<T>("an enormous floor", &[Part::Floor(3e3, DARK), block], (Light::Above, 5.0), truth, 1e-3);
    // All that is seen of a furnace has its radiance, whatever touches.
    check::<T>("furnace", &[Part::Floor(1.25, 1.0), block], (Light::Everywhere, 5.0), 1.0, 1e-4);
}

/// Layers in optical contact between a sun and a floor, seen from below: L = ρ T E/π.
pub fn layers_in_contact<T: TestBackend>() {
    let floor = Part::Floor(1.25, DARK);
    let liquid = Part::Layer(1.25, [2.0, 3.0], 1.33, 2.0);
    let slab = Part::Layer(1.25, [1.0, 2.0], 1.5, 0.0);
    let truth = passes(&[(1.33, 2.0), (1.5, 0.0)]);
    assert!((truth - 0.127).abs() < 1e-3);
    check::<T>("liquid on glass", &[floor, liquid, slab], (Light::Above, 0.4), DARK * truth, 1e-3);
    let [upper, lower] = [[1.5, 2.0], [1.0, 1.5]].map(|span| Part::Layer(1.25, span, 1.5, 1.0));
    let truth = passes(&[(1.5, 1.0)]);
    assert!((truth - 0.3396).abs() < 1e-3);
    check::<T>("equal slabs", &[floor, upper, lower], (Light::Above, 0.4), DARK * truth, 1e-3);
    let divided = Part::Divided(1.25, [1.0, 2.0], 1.5, 1.0);
    check::<T>("a face within", &[floor, divided], (Light::Above, 0.4), DARK * truth, 1e-3);
}

/// Ten clear layers of two indices in contact, and ten with gaps, in even light: radiance is 1 everywhere. No photons are
/// traced; only sums are rounded.
pub fn clear_layers_in_even_light<T: TestBackend>() {
    for gap in [0.0, 0.05] {
        let layer = |i: u32| {
            let low = 0.2 * f64::from(i);
            Part::Layer(1.0, [low, low + 0.2 - gap], if i.is_multiple_of(2) { 1.5 } else { 1.33 }, 0.0)
        };
        let layers: Vec<Part> = (0..10).map(layer).collect();
        check::<T>(&format!("gaps of {gap}"), &layers, (Light::Everywhere, 5.0), 1.0, 1e-5);
    }
}

/// A cylinder that lies on a floor, a block of glass, two pictures in one place and two lamps: meshes in this order, one of
/// the lamps moved by `nudge`.
fn still_life(order: [usize; 7], nudge: f64) -> Scene {
    let square = |[x, z]: [f64; 2], half: f64, y: f64| {
        vec![[x - half, y, z + half], [x + half, y, z + half], [x + half, y, z - half], [x - half, y, z - half]]
    };
    let (up, down) = (vec![[0, 1, 2], [0, 2, 3]], vec![[2, 1, 0], [3, 2, 0]]);
    let (upright, triangles) = shapes::cylinder([0.0, -0.4, 0.0], 0.25, 0.8, 32);
    let lying = upright.into_iter().map(|[x, y, z]| [y, z + 0.25, x]).collect();
    let white = MaterialDesc::lambert("white", [0.6; 3]);
    let lamp = MaterialDesc::emissive("lamp", [0.0; 3], [5.0; 3]);
    let parts = [
        (white.clone(), (square([0.0, 0.0], 1.0, 0.0), up.clone())),
        (MaterialDesc::lambert("wood", [0.7, 0.5, 0.3]), (lying, triangles)),
        (MaterialDesc::glass("glass", 1.5), shapes::cuboid([-0.6, 0.0, 0.3], [-0.2, 0.3, 0.7])),
        (white.clone(), (square([0.4, 0.6], 0.2, 0.0), up.clone())),
        (white, (square([0.4, 0.6], 0.2, 0.0), up)),
        (lamp.clone(), (square([-0.5, 0.0], 0.1, 1.5), down.clone())),
        (lamp, (square([0.5 + nudge, 0.0], 0.1, 1.5), down)),
    ];
    let mut builder = SceneBuilder::new();
    for part in order {
        let (mut desc, (positions, triangles)) = parts[part].clone();
        let mut attributes = VertexAttributes::default();
        if let 3 | 4 = part {
            let color = if part == 3 { [250, 30, 30, 255] } else { [30, 30, 250, 255] };
            let texture = builder.texture(TextureDesc::srgb8("picture", 2, 1, &[color, [200; 4]]));
            desc = desc.with_textures(TexturesDesc::default().with_base_color(TextureRef::new(texture)));
            attributes.uvs.push(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        }
        let material = builder.material(desc);
        builder.mesh_with(format!("part {part}"), positions, triangles, attributes, material);
    }
    builder.camera("eye", CameraDesc::look_at([0.0, 1.2, 2.5], [0.0, 0.1, 0.0], [0.0, 1.0, 0.0], 0.7));
    builder.build().unwrap()
}

/// Pictures are the same for every order of the meshes, bit by bit: also where surfaces are at exactly one distance, and
/// with lights chosen at random.
pub fn the_order_of_meshes_changes_no_bit<T: TestBackend>() {
    let mut on = Some(T::make(2));
    let mut picture = |order, nudge| {
        let scene = still_life(order, nudge);
        let view = View { camera: scene.camera(None, 32, 32).unwrap(), width: 32, height: 32 };
        let settings = Settings { photons: 4000, seed: 3, ..Settings::default() };
        let mut renderer = Pipeline::new(on.take().unwrap(), &scene.view(), view, settings).unwrap();
        renderer.pass(0, &mut ()).unwrap();
        let beauty = renderer.film().unwrap().beauty();
        on = Some(renderer.into_backend().unwrap());
        beauty.iter().flatten().map(|part| part.to_bits()).collect::<Vec<u32>>()
    };
    let expected = picture([0, 1, 2, 3, 4, 5, 6], 0.0);
    for order in [[6, 5, 4, 3, 2, 1, 0], [4, 1, 6, 2, 0, 5, 3]] {
        let found = picture(order, 0.0);
        let different = found.iter().zip(&expected).filter(|(a, b)| a != b).count();
        assert_eq!(different, 0, "{order:?}");
    }
    assert!(picture([0, 1, 2, 3, 4, 5, 6], 1e-6) != expected, "the comparison sees a small change");
}

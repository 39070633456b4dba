use super::*;
use crate::scene::light::Light;
use crate::scene::material::{Material, Primitive};
use crate::scene::medium::Medium;
use crate::scene::units::Units;

/// Boxes, each with lower corner, upper corner, material, and whether it faces inwards.
struct Tables {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    primitives: Vec<Primitive>,
    materials: Vec<Material>,
    lights: Vec<Light>,
}

const FACES: [[usize; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn tables(boxes: &[([f32; 3], [f32; 3], u32, bool)]) -> Tables {
    let solid = |medium| Material {
        kind: MaterialKind::Dielectric as u32,
        medium,
        ior: 1.5,
        emission: [1.0; 3],
        ..Material::default()
    };
    let mut tables = Tables {
        positions: Vec::new(),
        triangles: Vec::new(),
        primitives: Vec::new(),
        materials: vec![Material::default(), solid(1), solid(2)],
        lights: Vec::new(),
    };
    for &(low, high, material, inwards) in boxes {
        let corner = |i: usize| std::array::from_fn(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
        for face in FACES {
            let first = tables.positions.len() as u32;
            tables.positions.extend(face.map(corner));
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                let mut triangle = triangle.map(|i| first + i);
                if inwards {
                    triangle.swap(1, 2);
                }
                let [a, b, c] = triangle.map(|i| Vec3::from(tables.positions[i as usize]));
                let normal = (b - a).cross(c - a).normalize().to_array();
                tables.triangles.push(triangle);
                tables.primitives.push(Primitive { normal, material });
            }
        }
    }
    tables
}

impl Tables {
    fn view(&self) -> SceneView<'_> {
        SceneView {
            positions: &self.positions,
            triangles: &self.triangles,
            primitives: &self.primitives,
            materials: &self.materials,
            media: &[Medium::VACUUM; 3],
            lights: &self.lights,
            light_cdf: &[],
            radius: 1.0,
            units: Units { center: [0.0; 3], scale: 1.0, power: 1.0 },
            ..SceneView::default()
        }
    }
}

#[test]
fn points_are_in_what_encloses_them() {
    let tables = tables(&[
        ([-0.5; 3], [0.5; 3], 1, false),
        ([-0.2; 3], [0.2; 3], 2, false),
        ([0.3, -0.1, -0.1], [0.4, 0.1, 0.1], 1, true),
    ]);
    let view = tables.view();
    let solids = Solids::of(&view);
    assert_eq!(solids.solids.len(), 3);
    assert_eq!(solids.features(), MediaFeatures::NESTED);
    let locator = solids.locate();
    let outer = MediumStack::in_medium(1);
    // The rays of the first, second and last point cross edges and vertices of the boxes.
    assert_eq!(locator.at([0.0; 3]), outer.enter(2));
    assert_eq!(locator.at([-0.3, 0.2, 0.2]), outer);
    assert_eq!(locator.at([0.35, 0.03, 0.02]), MediumStack::VACUUM, "in the bubble");
    assert_eq!(locator.at([0.45, 0.03, 0.02]), outer);
    for outside in [[0.6, 0.0, 0.0], [-0.6, 0.0, 0.0], [0.0, 0.6, 0.0], [-0.6, 0.5, 0.5], [f32::NAN; 3]] {
        assert_eq!(locator.at(outside), MediumStack::VACUUM, "{outside:?}");
    }
}

/// A grid of points, compared with the boxes; some lie on diagonals and edges of faces.
#[test]
fn every_point_of_a_grid_is_where_it_is() {
    let tables = tables(&[([-0.5; 3], [0.5; 3], 1, false), ([-0.25, -0.25, -0.4], [0.25, 0.25, 0.25], 2, false)]);
    let view = tables.view();
    let solids = Solids::of(&view);
    let locator = solids.locate();
    for i in 0..19_i16.pow(3) {
        let at = [i % 19, i / 19 % 19, i / 361].map(|k| (f32::from(k) - 9.0) / 16.0 + 1.0 / 1024.0);
        let within = |low: [f32; 3], high: [f32; 3]| (0..3).all(|a| low[a] < at[a] && at[a] < high[a]);
        let mut expected = MediumStack::VACUUM;
        if within([-0.5; 3], [0.5; 3]) {
            expected = expected.enter(1);
        }
        if within([-0.25, -0.25, -0.4], [0.25, 0.25, 0.25]) {
            expected = expected.enter(2);
        }
        assert_eq!(locator.at(at), expected, "{at:?}");
    }
}

#[test]
fn solids_apart_do_not_nest() {
    let apart = tables(&[([-0.5; 3], [-0.1; 3], 1, false), ([0.1; 3], [0.5; 3], 1, false)]);
    assert_eq!(Solids::of(&apart.view()).features(), MediaFeatures::NONE);
    let touching = tables(&[([-0.5; 3], [0.0; 3], 1, false), ([0.0; 3], [0.5; 3], 2, false)]);
    assert_eq!(Solids::of(&touching.view()).features(), MediaFeatures::NESTED);
    let none = tables(&[]);
    assert_eq!(Solids::of(&none.view()).features(), MediaFeatures::NONE);
    assert_eq!(Solids::of(&none.view()).locate().at([0.0; 3]), MediumStack::VACUUM);
}

/// An emissive boundary emits photons outside of its solid from the front, inside from the back.
#[test]
fn a_glowing_boundary_has_two_sides() {
    let tables = tables(&[([-0.5; 3], [0.5; 3], 1, false), ([-0.2; 3], [0.2; 3], 2, false)]);
    let view = tables.view();
    let solids = Solids::of(&view);
    let light = |primitive| Light { kind: Light::TRIANGLE, primitive, ..Light::default() };
    let outer = MediumStack::in_medium(1);
    assert_eq!(solids.locate().of_light(&light(0)), [MediumStack::VACUUM, outer]);
    assert_eq!(solids.locate().of_light(&light(12)), [outer, outer.enter(2)]);
    let point = Light { kind: Light::POINT, position: [0.3; 3], ..Light::default() };
    assert_eq!(solids.locate().of_light(&point), [outer; 2]);
    let sun = Light { kind: Light::DIRECTIONAL, ..Light::default() };
    assert_eq!(solids.locate().of_light(&sun), [MediumStack::VACUUM; 2]);
}

//! Violates each rule once, and checks that the message names the culprit.

mod shading;

use crate::scene::grid::{Grid, OwnedGridTables};
use crate::scene::light::Light;
use crate::scene::material::{Material, MaterialKind, Primitive};
use crate::scene::medium::Medium;
use crate::scene::units::Units;
use crate::scene::{SceneView, light_cdf};

/// Tables of a view, to be modified by the tests.
#[derive(Clone)]
struct Tables {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    primitives: Vec<Primitive>,
    materials: Vec<Material>,
    media: Vec<Medium>,
    grids: OwnedGridTables,
    lights: Vec<Light>,
    starts: Vec<u32>,
    radius: f32,
    units: Units,
}

impl Tables {
    /// Two triangles, a material and a light of each kind.
    fn new() -> Self {
        let primitive = Primitive { normal: [0.0, 0.0, 1.0], material: 0 };
        let material = |kind: MaterialKind| Material {
            kind: kind as u32,
            albedo: [0.5, 0.0, 1.0],
            ior: 1.5,
            medium: u32::from(kind == MaterialKind::Dielectric),
            ..Material::default()
        };
        let light = |kind| Light {
            kind,
            position: [0.1; 3],
            direction: [0.0, 0.6, -0.8],
            primitive: 1,
            power: [0.25, 0.0, 0.5],
            versine_inner: 0.1,
            versine_outer: 0.2,
            radius: 0.9,
            area: 0.5,
            ..Light::default()
        };
        Self {
            positions: vec![[0.0; 3], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.5, 0.5, 0.0]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            primitives: vec![primitive; 2],
            materials: MaterialKind::ALL.map(material).to_vec(),
            media: vec![Medium::VACUUM, Medium { ior: 1.5, ..Medium::VACUUM }],
            grids: OwnedGridTables {
                grids: vec![Grid::default(), Grid { cells: [9, 1, 1], ..Grid::default() }],
                bricks: vec![0.5_f32.to_bits(), 1 << 31],
                densities: vec![1.0; 729],
            },
            lights: [Light::TRIANGLE, Light::POINT, Light::SPOT, Light::DIRECTIONAL].map(light).to_vec(),
            starts: light_cdf(&[1.0; 4]),
            radius: 0.75,
            units: Units::default(),
        }
    }

    fn view(&self) -> SceneView<'_> {
        SceneView {
            positions: &self.positions,
            triangles: &self.triangles,
            primitives: &self.primitives,
            materials: &self.materials,
            media: &self.media,
            grids: self.grids.view(),
            lights: &self.lights,
            light_cdf: &self.starts,
            radius: self.radius,
            units: self.units,
            ..SceneView::default()
        }
    }

    fn check(&self) -> Result<(), String> {
        self.view().validate().map_err(|error| error.to_string())
    }
}

/// A modification, and how the resulting message begins.
type Case = (fn(&mut Tables), &'static str);

#[track_caller]
fn all_fail(cases: &[Case]) {
    for (number, (spoil, expected)) in cases.iter().enumerate() {
        let mut tables = Tables::new();
        spoil(&mut tables);
        let found = tables.check().expect_err(expected);
        assert!(found.starts_with(expected), "case {number}: {found:?} instead of {expected:?}");
    }
}

#[test]
fn a_sound_view_passes() {
    Tables::new().check().unwrap();
    // A view without lights, triangles or materials is valid.
    let mut tables = Tables::new();
    (tables.lights, tables.starts) = (Vec::new(), Vec::new());
    tables.check().unwrap();
    (tables.triangles, tables.primitives, tables.materials, tables.positions) = Default::default();
    tables.radius = 0.0;
    tables.check().unwrap();
}

#[test]
fn rounding_passes() {
    let mut tables = Tables::new();
    // Just outside, as with a radius that was computed in f32; a normal of rounded numbers.
    tables.positions[1] = [0.750_001, 0.0, 0.0];
    tables.primitives[0].normal = [0.577_35, 0.577_35, 0.577_35];
    tables.check().unwrap();
    // Fields that a material or a light does not use may have any value that is a number.
    tables.materials[0].ior = 0.0;
    tables.lights[1].primitive = u32::MAX;
    tables.lights[0].direction = [0.0; 3];
    tables.check().unwrap();
}

#[test]
fn lengths_and_units() {
    all_fail(&[
        (|t| t.primitives.truncate(1), "scene view: the number of primitives is 1 for 2 triangles"),
        (|t| t.primitives.push(t.primitives[0]), "scene view: the number of primitives is 3 for 2 triangles"),
        (|t| t.starts.truncate(3), "scene view: the length of light_cdf is 3 for 4 lights"),
        (|t| t.starts.push(u32::MAX), "scene view: the length of light_cdf is 5 for 4 lights"),
        (|t| t.lights[2] = t.lights[3], "scene view: lights is 2 directional lights with a disc"),
        (|t| t.radius = f32::NAN, "scene view: the radius is NaN"),
        (|t| t.radius = -1.0, "scene view: the radius is -1"),
        (|t| t.radius = 17.0, "scene view: the radius is 17"),
        (|t| t.units.center[2] = f64::INFINITY, "scene view: units.center is [0.0, 0.0, inf]"),
        (|t| t.units.scale = 0.0, "scene view: units.scale is 0"),
        (|t| t.units.scale = f64::NAN, "scene view: units.scale is NaN"),
        (|t| t.units.power = f64::INFINITY, "scene view: units.power is inf"),
    ]);
}

#[test]
fn positions_and_indices() {
    all_fail(&[
        (|t| t.positions[2][1] = f32::NAN, "position 2: [0.0, NaN, 0.0] must be finite"),
        (|t| t.positions[3][0] = f32::INFINITY, "position 3: [inf,"),
        (|t| t.positions[3][0] = f32::MAX, "position 3: "),
        (
            |t| t.positions[1][0] = 0.76,
            "position 1: [0.76, 0.0, 0.0] must be finite and within the scene's radius, 0.75",
        ),
        (|t| t.triangles[1][2] = 4, "triangle 1: [1, 3, 4] has an index that is not among the 4 vertices"),
        (|t| t.triangles[0][0] = u32::MAX, "triangle 0: "),
        (|t| t.primitives[1].material = 5, "primitive 1: material 5 is out of range"),
        (|t| t.primitives[0].material = u32::MAX, "primitive 0: material 4294967295"),
        (|t| t.primitives[1].normal = [0.0; 3], "primitive 1: its normal [0.0, 0.0, 0.0] is not a unit vector"),
        (|t| t.primitives[1].normal = [0.0, 0.0, 1.001], "primitive 1: its normal"),
        (|t| t.primitives[0].normal[0] = f32::NAN, "primitive 0: its normal"),
    ]);
}

#[test]
fn grids() {
    all_fail(&[
        (|t| t.grids.grids.truncate(1), "scene view: the number of grids is 1 for 2 media"),
        (|t| t.grids.grids[1].x[3] = f32::NAN, "grid 1: its rows"),
        (|t| t.grids.grids[1].cells[1] = 8, "grid 1: its [9, 8, 1] cells from brick 0 are not in the table of 2"),
        (|t| t.grids.grids[1].cells[2] = 0, "grid 1: its [9, 1, 0] cells"),
        (|t| t.grids.grids[1].first = 1, "grid 1: its [9, 1, 1] cells from brick 1"),
        (|t| t.grids.bricks[0] = f32::NAN.to_bits(), "brick 0: its word"),
        (|t| t.grids.bricks[1] = 1 << 31 | 1, "brick 1: its word 0x80000001 is neither"),
        (|t| t.grids.densities[7] = -0.5, "density 7: it is -0.5"),
    ]);
}

#[test]
fn materials() {
    all_fail(&[
        (|t| t.materials[1].kind = 5, "material 1: its kind 5 is unknown"),
        (|t| t.materials[0].kind = u32::MAX, "material 0: its kind"),
        (|t| t.materials[3].albedo[1] = f32::NAN, "material 3: its albedo [0.5, NaN, 1.0]"),
        (|t| t.materials[3].albedo[1] = 1.000_001, "material 3: its albedo"),
        (|t| t.materials[0].albedo[0] = -0.1, "material 0: its albedo"),
        (|t| t.materials[0].alpha = f32::NAN, "material 0: its alpha NaN must lie between 0 and 1"),
        (|t| t.materials[0].alpha = 1.000_001, "material 0: its alpha"),
        (|t| t.materials[0].alpha = -1e-30, "material 0: its alpha"),
        (|t| t.materials[1].alpha_cutoff = f32::NAN, "material 1: its alpha_cutoff [NaN]"),
        (|t| t.materials[1].alpha_cutoff = f32::INFINITY, "material 1: its alpha_cutoff"),
        (|t| t.materials[1].alpha_cutoff = -0.5, "material 1: its alpha_cutoff"),
        (|t| t.materials[0].emission[2] = f32::NAN, "material 0: its emission"),
        (|t| t.materials[0].emission[0] = -1.0, "material 0: its emission"),
        (|t| t.media[1].absorption[1] = f32::INFINITY, "medium 1: its absorption"),
        (|t| t.media[1].absorption[1] = -1.0, "medium 1: its absorption"),
        (|t| t.media[1].ior = f32::NAN, "medium 1: its ior NaN"),
        (|t| t.media[1].ior = 1.4, "material 2: its ior 1.5 differs from that"),
        (|t| t.media[0].ior = 1.1, "scene view: media is a table of 2"),
        (|t| t.media.clear(), "scene view: media is a table of 0"),
        (|t| t.media.resize(257, Medium::VACUUM), "scene view: media is a table of 257"),
        (|t| t.materials[2].medium = 0, "material 2: it has no medium"),
        (|t| t.materials[2].medium = 2, "material 2: medium 2 is out of range"),
        (|t| t.materials[2].ior = 0.0, "material 2: its ior 0"),
        (|t| t.materials[3].ior = f32::NAN, "material 3: its ior NaN"),
        (|t| t.materials[3].ior = -1.5, "material 3: its ior -1.5"),
        (|t| t.materials[2].ior = f32::INFINITY, "material 2: its ior inf"),
        (|t| t.materials[4].metallic = 1.5, "material 4: its metallic 1.5 must lie between 0 and 1"),
        (|t| t.materials[4].roughness = f32::NAN, "material 4: its roughness NaN"),
        (|t| t.materials[4].specular = -0.5, "material 4: its specular -0.5"),
        (|t| t.materials[4].ior = -0.5, "material 4: its ior -0.5 must be finite and at least 0"),
        (|t| t.materials[4].ior = f32::INFINITY, "material 4: its ior inf"),
    ]);
}

#[test]
fn lights() {
    all_fail(&[
        (|t| t.lights[1].kind = 5, "light 1: its kind 5 is unknown"),
        (|t| t.lights[1].kind = 4, "scene view: environment is 1 lights of kind"),
        (|t| t.lights[0].primitive = 2, "light 0: triangle 2 is out of range"),
        (|t| t.lights[0].primitive = u32::MAX, "light 0: triangle 4294967295"),
        (|t| t.lights[0].area = 0.0, "light 0: its area 0"),
        (|t| t.lights[0].area = f32::NAN, "light 0: its area NaN"),
        (|t| t.lights[3].power[1] = f32::NAN, "light 3: its power"),
        (|t| t.lights[3].power[1] = -0.5, "light 3: its power"),
        (|t| t.lights[1].position[0] = f32::NAN, "light 1: its position [NaN,"),
        (|t| t.lights[2].position[0] = 0.8, "light 2: its position [0.8, 0.1, 0.1] must be"),
        (|t| t.lights[2].direction = [0.0; 3], "light 2: its direction"),
        (|t| t.lights[3].direction[0] = f32::NAN, "light 3: its direction"),
        (|t| t.lights[2].versine_inner = 0.3, "light 2: its versines 0.3 and 0.2"),
        (|t| t.lights[2].versine_outer = f32::NAN, "light 2: its versines"),
        (|t| t.lights[2].versine_outer = 2.5, "light 2: its versines"),
        (|t| t.lights[3].radius = f32::INFINITY, "light 3: its radius"),
        (|t| t.lights.swap(0, 2), "light 2: triangle 1 is out of order"),
        (|t| t.lights[1] = t.lights[0], "light 1: triangle 1 is out of order"),
        (|t| t.lights[1] = Light { primitive: 0, ..t.lights[0] }, "light 1: triangle 0 is out of order"),
        (|t| t.starts[0] = 1, "light_cdf entry 0: 1 is invalid"),
        (|t| t.starts[2] = t.starts[1], "light_cdf entry 2: "),
        (|t| t.starts[3] = 0, "light_cdf entry 3: 0 is invalid"),
    ]);
}

/// Features are derived from an invalid view too, without a panic.
#[test]
fn what_is_out_of_range_needs_no_feature() {
    let mut tables = Tables::new();
    tables.primitives[1].material = 9;
    tables.triangles[0][1] = 9;
    tables.lights[0].primitive = 9;
    let view = SceneView {
        positions: &tables.positions,
        triangles: &tables.triangles,
        primitives: &tables.primitives,
        materials: &tables.materials,
        media: &[],
        lights: &tables.lights,
        light_cdf: &[],
        radius: 1.0,
        units: Units::default(),
        ..SceneView::default()
    };
    let features = crate::Features::of(&view);
    assert!(features.contains(crate::Features::DIFFUSE) && !features.intersects(crate::Features::SPECULAR));
    assert!(crate::Requirements::of(&view, &crate::Settings::default()).maps[crate::MapKind::Global]);
}

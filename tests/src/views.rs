//! Invalid scene views that were filled in by hand: they are refused with a typed error.

use photon_core::{
    Error, Light, Material, Pipeline, Primitive, Requirements, Result, SceneView, Settings, TransportBackend, View,
};
use photon_scene::Scene;

use crate::harness::TestBackend;

/// Copies of the tables that can be corrupted.
struct Tables {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    primitives: Vec<Primitive>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    light_cdf: Vec<u32>,
}

impl Tables {
    fn of(scene: &Scene) -> Self {
        let view = scene.view();
        Self {
            positions: view.positions.to_vec(),
            triangles: view.triangles.to_vec(),
            primitives: view.primitives.to_vec(),
            materials: view.materials.to_vec(),
            lights: view.lights.to_vec(),
            light_cdf: view.light_cdf.to_vec(),
        }
    }

    fn lend<'a>(&'a self, scene: &'a Scene) -> SceneView<'a> {
        SceneView {
            positions: &self.positions,
            triangles: &self.triangles,
            primitives: &self.primitives,
            materials: &self.materials,
            lights: &self.lights,
            light_cdf: &self.light_cdf,
            ..scene.view()
        }
    }
}

/// How to corrupt the tables, and the element that the error must name.
type Damage = (fn(&mut Tables), &'static str);

const FAULTS: [Damage; 8] = [
    (|t| t.triangles[3][1] = t.positions.len() as u32, "triangle 3"),
    (|t| t.primitives[2].material = t.materials.len() as u32, "primitive 2"),
    (|t| t.lights[0].primitive = t.triangles.len() as u32, "light 0"),
    (|t| t.materials[1].kind = 77, "material 1"),
    (|t| t.lights[1].kind = 77, "light 1"),
    (|t| t.positions[5][0] = f32::NAN, "position 5"),
    (|t| t.materials[0].albedo[2] = f32::NAN, "material 0"),
    (|t| t.light_cdf.truncate(1), "light_cdf"),
];

#[track_caller]
fn is_refused<T>(found: Result<T>, culprit: &str) {
    match found {
        Err(error @ (Error::InvalidInput { .. } | Error::InvalidScene { .. })) => {
            assert!(error.to_string().contains(culprit), "{culprit}: {error}");
        }
        Err(other) => panic!("{culprit}: {other}"),
        Ok(_) => panic!("{culprit}: accepted"),
    }
}

/// Through every entry point: the pipeline with derived or given requirements, and the backend alone.
pub fn v1_hand_filled_views_are_checked<T: TestBackend>() {
    let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
    let settings = Settings { photons: 1000, ..Settings::default() };
    let everything = Requirements::everything(&settings);
    let view = View { camera: scene.camera(None, 4, 4).unwrap(), width: 4, height: 4 };
    Pipeline::new(T::make(1), &Tables::of(&scene).lend(&scene), view, settings.clone()).unwrap();
    let mut alone = T::make(1);
    for (spoil, culprit) in FAULTS {
        let mut tables = Tables::of(&scene);
        spoil(&mut tables);
        let broken = tables.lend(&scene);
        is_refused(broken.validate(), culprit);
        is_refused(Pipeline::new(T::make(1), &broken, view, settings.clone()), culprit);
        is_refused(alone.prepare(&broken, &everything), culprit);
    }
    let mut tables = Tables::of(&scene);
    let (spoil, culprit) = FAULTS[0];
    spoil(&mut tables);
    let broken = tables.lend(&scene);
    let widened = Pipeline::with_requirements(T::make(1), &broken, view, settings.clone(), everything);
    is_refused(widened, culprit);
    let stages = alone.stages(&everything, &settings).unwrap();
    is_refused(Pipeline::with_stages(alone, &broken, view, settings, everything, stages), culprit);
}

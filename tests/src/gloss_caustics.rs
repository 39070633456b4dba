//! Light of point, spot and directional lights that reaches a glossy surface by way of mirrors or glass, as its reflection
//! shows it: no camera path can find such light.
//!
//! Panes and mirrors stand upright on horizontal floors, so that what the floor reflects leaves upwards and never comes
//! back.

use photon_core::glam::{DQuat, DVec3};
use photon_core::{Area, CausticPhotons, Direct, Estimator, Indirect, Layer, Render, Requirements, Settings};
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Surface, VertexAttributes};

use crate::gloss_reference::Reference;
use crate::harness::{InFull, TestBackend, film, per_pass, renderer};
use crate::stats::{agrees, assert_agrees, moments, standard_error};

/// A glossy floor without a base: metal, or black plastic with a coat of index 1.5.
#[derive(Clone, Copy)]
pub(crate) struct Floor {
    pub(crate) alpha: f64,
    pub(crate) metallic: f64,
    pub(crate) color: f64,
}

impl Floor {
    pub(crate) fn material(self) -> MaterialDesc {
        let Self { alpha, metallic, color } = self;
        let (base_color, roughness) = ([color; 3], alpha.sqrt());
        MaterialDesc::new("floor", Surface::Glossy { base_color, metallic, roughness, specular: 1.0, ior: 1.5 })
    }

    /// The BSDF, at a surface with the shading normal `n`.
    pub(crate) fn f(self, o: DVec3, i: DVec3, n: DVec3) -> f64 {
        let turn = DQuat::from_rotation_arc(n, UP);
        Reference::new(self.alpha, self.metallic, self.color).f(turn * o, turn * i)
    }
}

/// Transmittance of a thin pane of index 1.5: `(1 − R)/(1 + R)` with Fresnel's R.
pub(crate) fn through_a_pane(cosine: f64) -> f64 {
    let n = 1.5_f64;
    let inside = (1.0 - (1.0 - cosine * cosine) / (n * n)).sqrt();
    let s = (cosine - n * inside) / (cosine + n * inside);
    let p = (n * cosine - inside) / (n * cosine + inside);
    let reflectance = 0.5 * (s * s + p * p);
    (1.0 - reflectance) / (1.0 + reflectance)
}

pub(crate) const UP: DVec3 = DVec3::Y;
/// Irradiance of the sun across its direction.
const SUN: f64 = 2.0;

pub(crate) fn towards(cosine: f64, azimuth: f64) -> DVec3 {
    let sine = (1.0 - cosine * cosine).sqrt();
    DVec3::new(sine * azimuth.cos(), cosine, sine * azimuth.sin())
}

fn settings() -> Settings {
    Settings {
        photons: 20_000,
        alpha: 1.0,
        estimator: Estimator::Radius { radius: Some(0.2) },
        indirect: Indirect::None,
        ..Settings::default()
    }
}

/// A floor of half side 1 at y = 0 with shading normals along `normal`, seen in direction −`o` at a point of it; a sun in
/// direction `i`; and, if `pane`, a thin pane at x = −.4 which all light to that point passes.
fn sunlit(material: MaterialDesc, normal: DVec3, (o, i): (DVec3, DVec3), pane: bool) -> Scene {
    let glass = pane.then(|| MaterialDesc::thin("pane", 1.5));
    sunlit_by(material, normal, (o, i), glass).build().unwrap()
}

/// As [`sunlit`], with a pane of any material.
fn sunlit_by(
    material: MaterialDesc,
    normal: DVec3,
    (o, i): (DVec3, DVec3),
    pane: Option<MaterialDesc>,
) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let material = builder.material(material);
    let corners = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
    if normal == UP {
        builder.quad("floor", corners, material);
    } else {
        let attributes = VertexAttributes::default().with_normals(vec![normal.to_array(); 4]);
        builder.mesh_with("floor", corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], attributes, material);
    }
    if let Some(glass) = pane {
        let glass = builder.material(glass);
        builder.quad("pane", [[-0.4, 0.0, 1.0], [-0.4, 0.0, -1.0], [-0.4, 1.2, -1.0], [-0.4, 1.2, 1.0]], glass);
    }
    builder.light("sun", LightDesc::Directional { direction: (-i).to_array(), irradiance: [SUN; 3] });
    let projection = Projection::Orthographic { half_height: 1e-4 };
    builder.camera("oblique", CameraDesc::new((o * 0.6).to_array(), (-o).to_array(), [0.0, 0.0, 1.0], projection));
    builder
}

/// Metals and plastics of several widths, and directions of viewer and sun.
const CASES: [(Floor, f64, f64); 4] = [
    (Floor { alpha: 0.2, metallic: 1.0, color: 0.8 }, 0.7, 0.6),
    (Floor { alpha: 0.5, metallic: 1.0, color: 0.4 }, 0.9, 0.5),
    (Floor { alpha: 0.2, metallic: 0.0, color: 0.0 }, 0.6, 0.65),
    (Floor { alpha: 0.4, metallic: 0.0, color: 0.0 }, 0.3, 0.5),
];

/// Sun, pane, glossy floor: `T E₀ cos f`, with each search, with area probes, and with all paths in common.
pub fn sun_through_a_pane<T: TestBackend>() {
    for (k, (floor, cos_o, cos_i)) in CASES.into_iter().enumerate() {
        let (o, i) = (towards(cos_o, 0.3), towards(cos_i, 3.0));
        let scene = sunlit(floor.material(), UP, (o, i), true);
        let mut settings = settings();
        match k {
            0 => settings.estimator = Estimator::Knn { k: 1000, max_radius: None },
            1 => settings.area = Area::Surface,
            2 => settings.caustic_photons = CausticPhotons::Shared,
            _ => {}
        }
        settings.photons = 40_000;
        let values = per_pass::<InFull<T>>(&scene, &settings, 24, 2);
        let truth_of = |floor: Floor| through_a_pane(-i.x) * SUN * cos_i * floor.f(o, i, UP);
        let (found, truth, error) = (moments(&values).0, truth_of(floor), standard_error(&values));
        assert_agrees(&format!("case {k}"), found, truth, error, 5e-3 * truth);
        // The noise is small enough to tell another width, or a missing pane.
        let other = truth_of(Floor { alpha: floor.alpha * 2.0, ..floor });
        assert!(!agrees(found, other, error, 5e-3 * other), "case {k}: {found} {truth} {other} {error}");
        assert!(!agrees(found, truth / through_a_pane(-i.x), error, 5e-3 * truth), "case {k}: {found} {truth} {error}");
        // Without caustics there is nothing.
        let none = per_pass::<T>(&scene, &Settings { caustics: false, ..settings }, 2, 2);
        assert_eq!(moments(&none).0, 0.0);
    }
}

/// Plastic with a base, and half metal: photons behind a pane show what shadow rays show without it, times its
/// transmittance; with final gathering too.
pub fn photons_behind_a_pane_are_like_shadow_rays<T: TestBackend>() {
    for (metallic, indirect) in [(0.0, Indirect::None), (0.5, Indirect::None), (0.0, Indirect::Gather)] {
        let floor = Floor { alpha: 0.3, metallic, color: 0.7 };
        let (o, i) = (towards(0.6, -0.2), towards(0.55, 2.9));
        let [open, behind] = [false, true].map(|pane| sunlit(floor.material(), UP, (o, i), pane));
        let settings = Settings { direct: Direct::Nee, indirect, ..settings() };
        let truth = moments(&per_pass::<T>(&open, &settings, 2, 2)).0 * through_a_pane(-i.x);
        let values = per_pass::<T>(&behind, &settings, 16, 2);
        let what = format!("metallic {metallic}, {indirect:?}");
        assert_agrees(&what, moments(&values).0, truth, standard_error(&values), 4e-3 * truth);
    }
}

/// Shading normals tilted towards the sun: all techniques count the cosine to them.
pub fn tilted_normals_behind_a_pane<T: TestBackend>() {
    let floor = Floor { alpha: 0.3, metallic: 1.0, color: 0.9 };
    let (o, i) = (towards(0.8, 0.3), towards(0.5, 3.0));
    let normal = DVec3::new(-0.3, 1.0, 0.1).normalize_or_zero();
    let scene = sunlit(floor.material(), normal, (o, i), true);
    let values = per_pass::<T>(&scene, &settings(), 24, 2);
    let truth = through_a_pane(-i.x) * SUN * i.dot(normal) * floor.f(o, i, normal);
    assert_agrees("tilted", moments(&values).0, truth, standard_error(&values), 5e-3 * truth);
}

/// A point light whose image in a mirror lights a metal floor; a screen hides the light itself.
pub fn point_light_in_a_mirror<T: TestBackend>() {
    let floor = Floor { alpha: 0.3, metallic: 1.0, color: 0.8 };
    let mut builder = SceneBuilder::new();
    let metal = builder.material(floor.material());
    builder.quad("floor", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], metal);
    let mirror = builder.material(MaterialDesc::mirror("mirror", [0.9; 3]));
    builder.quad("mirror", [[-0.6, 0.0, 1.0], [-0.6, 0.0, -1.0], [-0.6, 1.2, -1.0], [-0.6, 1.2, 1.0]], mirror);
    let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
    let light = DVec3::new(0.5, 0.9, 0.1);
    // Between light and floor, out of the way from the light to the mirror.
    builder.quad("screen", [[0.0, 0.6, 0.4], [0.6, 0.6, 0.4], [0.6, 0.6, -0.4], [0.0, 0.6, -0.4]], black);
    builder.light("point", LightDesc::Point { position: light.to_array(), intensity: [1.0; 3] });
    let o = towards(0.7, 0.8);
    let projection = Projection::Orthographic { half_height: 1e-4 };
    builder.camera("oblique", CameraDesc::new((o * 0.5).to_array(), (-o).to_array(), [0.0, 0.0, 1.0], projection));
    let scene = builder.build().unwrap();
    let mut settings = settings();
    settings.estimator = Estimator::Radius { radius: Some(0.04) };
    settings.photons = 60_000;
    let values = per_pass::<InFull<T>>(&scene, &settings, 24, 2);
    let image = DVec3::new(-1.2 - light.x, light.y, light.z);
    let i = image.normalize_or_zero();
    let truth = 0.9 * i.y / image.length_squared() * floor.f(o, i, UP);
    // The estimate is the mean over a disc of radius .04, in which the radiance has a curvature.
    assert_agrees("mirror", moments(&values).0, truth, standard_error(&values), 1e-2 * truth);
}

/// A metal floor behind a pane as a narrow lobe of a metal plate shows it: the second surface of the camera path.
pub fn seen_in_another_metal<T: TestBackend>() {
    let floor = Floor { alpha: 0.4, metallic: 1.0, color: 0.8 };
    let (o, i) = (towards(0.7, 0.0), towards(0.6, 3.0));
    let mut builder = SceneBuilder::new();
    let metal = builder.material(floor.material());
    builder.quad("floor", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], metal);
    let glass = builder.material(MaterialDesc::thin("pane", 1.5));
    builder.quad("pane", [[-0.4, 0.0, 1.0], [-0.4, 0.0, -1.0], [-0.4, 1.2, -1.0], [-0.4, 1.2, 1.0]], glass);
    // It faces −x and the sun; what it reflects of the sun meets the floor beside the point that is seen.
    let plate = builder.material(MaterialDesc::metal("plate", [1.0; 3], 0.04));
    builder.quad("plate", [[0.4, 0.35, -0.05], [0.4, 0.35, 0.05], [0.4, 0.45, 0.05], [0.4, 0.45, -0.05]], plate);
    builder.light("sun", LightDesc::Directional { direction: (-i).to_array(), irradiance: [SUN; 3] });
    let mirrored = DVec3::new(-o.x, o.y, o.z);
    let at = o * (0.4 / o.x) + mirrored * 0.2;
    let projection = Projection::Orthographic { half_height: 1e-4 };
    let camera = CameraDesc::new(at.to_array(), (-mirrored).to_array(), [0.0, 0.0, 1.0], projection);
    builder.camera("by way of the plate", camera);
    let scene = builder.build().unwrap();
    let values = per_pass::<T>(&scene, &settings(), 24, 4);
    let truth = through_a_pane(-i.x) * SUN * i.y * floor.f(o, i, UP);
    assert_agrees("in a plate", moments(&values).0, truth, standard_error(&values), 1e-2 * truth);
}

/// Light through a rough pane is what camera paths find themselves, at the pane: no photon counts it once more, though a
/// mirror elsewhere requires such photons.
pub fn rough_panes_are_not_counted_twice<T: TestBackend>() {
    let floor = Floor { alpha: 0.3, metallic: 1.0, color: 0.8 };
    let (o, i) = (towards(0.7, 0.3), towards(0.6, 3.0));
    for (roughness, is_found) in [(0.5, false), (0.0, true)] {
        let pane = Surface::Thin { ior: 1.5, tint: [1.0; 3], roughness };
        let mut builder = sunlit_by(floor.material(), UP, (o, i), Some(MaterialDesc::new("pane", pane)));
        let alone = builder.clone().build().unwrap();
        assert_eq!(Requirements::of(&alone.view(), &settings()).gloss_caustics, is_found);
        let mirror = builder.material(MaterialDesc::mirror("mirror", [1.0; 3]));
        builder.quad("mirror", [[0.5, 1.4, 0.5], [0.9, 1.4, 0.5], [0.9, 1.4, -0.5], [0.5, 1.4, -0.5]], mirror);
        let scene = builder.build().unwrap();
        assert!(Requirements::of(&scene.view(), &settings()).gloss_caustics);
        let found = film::<T>(&scene, &settings(), 4, 2);
        let is_lit = |layer| found.layer(layer).iter().flatten().any(|&c| c > 0.0);
        assert_eq!(is_lit(Layer::Caustic), is_found);
        assert_eq!(is_lit(Layer::Emission), !is_found);
    }
}

/// Error statistics change no bit of the picture, and cover what the reflection shows; scenes that lack a light, a pane or
/// gloss need none of it.
pub fn errors_and_requirements<T: TestBackend>() {
    let (floor, cos_o, cos_i) = CASES[0];
    let (o, i) = (towards(cos_o, 0.3), towards(cos_i, 3.0));
    let scene = sunlit(floor.material(), UP, (o, i), true);
    let settings = settings();
    let plain = film::<T>(&scene, &settings, 8, 2);
    let with_errors = film::<T>(&scene, &Settings { errors: true, ..settings.clone() }, 8, 2);
    assert_eq!(plain.beauty(), with_errors.beauty());
    let intervals = with_errors.confidence_intervals().unwrap();
    assert!(intervals.iter().all(|interval| interval.value > 0.0 && interval.photons > 10.0), "{intervals:?}");

    assert!(Requirements::of(&scene.view(), &settings).gloss_caustics);
    let without = Requirements::of(&scene.view(), &Settings { caustics: false, ..settings.clone() });
    assert!(!without.gloss_caustics);
    let open = sunlit(floor.material(), UP, (o, i), false);
    let diffuse = sunlit(MaterialDesc::lambert("floor", [0.5; 3]), UP, (o, i), true);
    for scene in [&open, &diffuse] {
        assert!(!Requirements::of(&scene.view(), &settings).gloss_caustics);
        let renderer = renderer::<T>(scene, &settings, 2);
        assert!(!renderer.facts().memory.iter().any(|(label, _)| label.contains("reflect")));
    }
}

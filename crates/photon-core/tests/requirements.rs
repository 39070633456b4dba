//! Requirements are derived from the scene, and are the smallest that render it.

use photon_core::{
    Direct, Error, Features, Indirect, Light, MapKind, Material, MaterialKind, Medium, PerMap, Primitive, Requirements,
    SceneView, Settings, Units, light_cdf,
};

/// A light facing down at height 0.5, a diffuse floor, and a triangle of `kind` at height `z`.
struct Tables {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    primitives: Vec<Primitive>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    starts: Vec<u32>,
}

impl Tables {
    fn new(kind: u32, z: f32) -> Self {
        let triangle = |z: f32| [[-0.4, -0.4, z], [0.4, -0.4, z], [0.0, 0.4, z]];
        let positions = [triangle(0.4), triangle(-0.5), triangle(z)].concat();
        let primitive = |z: f32, material| Primitive { normal: [0.0, 0.0, z], material };
        let lambert = Material { albedo: [0.5; 3], ior: 1.0, ..Material::default() };
        Self {
            positions,
            triangles: vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]],
            primitives: vec![primitive(-1.0, 0), primitive(1.0, 1), primitive(1.0, 2)],
            materials: vec![
                Material { emission: [1.0; 3], ..lambert },
                lambert,
                Material { kind, ior: 1.5, ..lambert },
                Material { kind: MaterialKind::Thin as u32, ..lambert },
            ],
            lights: vec![Light {
                kind: Light::TRIANGLE,
                primitive: 0,
                power: [1.0; 3],
                area: 0.32,
                ..Light::default()
            }],
            starts: light_cdf(&[1.0]),
        }
    }

    fn view(&self) -> SceneView<'_> {
        SceneView {
            positions: &self.positions,
            triangles: &self.triangles,
            primitives: &self.primitives,
            materials: &self.materials,
            media: &[Medium::VACUUM],
            lights: &self.lights,
            light_cdf: &self.starts,
            radius: 0.9,
            units: Units::default(),
            ..SceneView::default()
        }
    }
}

/// These maps and no others.
fn only<const N: usize>(kinds: [MapKind; N]) -> PerMap<bool> {
    PerMap::from_fn(|kind| kinds.contains(&kind))
}

#[test]
fn only_materials_in_use_count() {
    let tables = Tables::new(MaterialKind::Lambert as u32, 0.0);
    let required = Requirements::of(&tables.view(), &Settings::default());
    assert_eq!(required.features, Features::DIFFUSE.union(Features::AREA_LIGHTS));
    assert!(required.maps == only([MapKind::Global]) && required.shadow_rays);
}

/// A light tree is needed from 17 lights on: with fewer, each query weighs all of them.
#[test]
fn a_light_tree_needs_many_lights() {
    for (points, needed) in [(15, false), (16, true)] {
        let mut tables = Tables::new(MaterialKind::Lambert as u32, 0.0);
        let point = Light { kind: Light::POINT, primitive: u32::MAX, power: [1.0; 3], ..Light::default() };
        tables.lights.extend(vec![point; points]);
        tables.starts = light_cdf(&vec![1.0; points + 1]);
        let required = Requirements::of(&tables.view(), &Settings::default());
        assert_eq!(required.features.contains(Features::LIGHT_TREE), needed, "{points} points");
        let need = photon_core::explain(&tables.view(), &Settings::default());
        let need = need.into_iter().find(|need| need.what == "light-tree").unwrap();
        assert!(need.needed == needed && need.why == format!("{} lights", points + 1), "{need:?}");
    }
}

#[test]
fn a_caustic_map_needs_a_specular_surface_that_a_light_can_reach() {
    let settings = Settings::default();
    for kind in [MaterialKind::Mirror as u32, MaterialKind::Dielectric as u32, MaterialKind::Thin as u32] {
        assert!(Requirements::of(&Tables::new(kind, 0.0).view(), &settings).maps[MapKind::Caustic]);
        // Behind the light, which emits from its front only.
        let mut behind = Tables::new(kind, 0.45);
        assert!(!Requirements::of(&behind.view(), &settings).maps[MapKind::Caustic]);
        behind.lights[0].flags = Light::BOTH_SIDES;
        assert!(Requirements::of(&behind.view(), &settings).maps[MapKind::Caustic]);
        behind.lights[0] = Light { kind: Light::POINT, power: [1.0; 3], ..Light::default() };
        assert!(Requirements::of(&behind.view(), &settings).maps[MapKind::Caustic]);
    }
}

#[test]
fn maps_follow_the_settings() {
    let tables = Tables::new(MaterialKind::Mirror as u32, 0.0);
    let of = |settings: Settings| Requirements::of(&tables.view(), &settings);
    let none = of(Settings { indirect: Indirect::None, caustics: false, ..Settings::default() });
    assert!(!none.maps.any());
    let photons = of(Settings { direct: Direct::Photons, ..Settings::default() });
    assert!(photons.maps[MapKind::Direct] && !photons.shadow_rays);
    let gather = of(Settings { indirect: Indirect::Gather, caustics: false, ..Settings::default() });
    assert!(gather.final_gather && gather.maps == only(MapKind::ALL));
}

#[test]
fn too_little_is_an_error_that_names_it() {
    let tables = Tables::new(MaterialKind::Dielectric as u32, 0.0);
    let needed = Requirements::of(&tables.view(), &Settings::default());
    let mut less = needed;
    less.features = needed.features.without(Features::DIELECTRIC);
    match less.check(needed.features) {
        Err(Error::MissingFeatures { missing }) => assert_eq!(missing, Features::DIELECTRIC),
        other => panic!("{other:?}"),
    }
    assert!(Requirements::everything(&Settings::default()).check(needed.features).is_ok());
}

/// Light of area lights is taken from photons where a glossy surface is rough enough, and glass is in its way.
#[test]
fn caustics_of_area_lights_need_rough_gloss_and_glass() {
    let mut tables = Tables::new(MaterialKind::Thin as u32, 0.0);
    tables.materials[1].kind = MaterialKind::Glossy as u32;
    tables.materials[1].metallic = 1.0;
    tables.materials[1].roughness = 0.5;
    let of = |tables: &Tables, caustic_roughness| {
        let settings = Settings { caustic_roughness, ..Settings::default() };
        let required = Requirements::of(&tables.view(), &settings);
        let needs = photon_core::explain(&tables.view(), &settings);
        let need = needs.into_iter().find(|need| need.what == "those of area lights and environments").unwrap();
        assert_eq!(need.needed, required.gloss_caustics_of_all_lights);
        assert_eq!(required.gloss_caustics, required.gloss_caustics_of_all_lights);
        assert_eq!(required.caustic_roughness(&settings), caustic_roughness.filter(|_| need.needed));
        (need.needed, need.why)
    };
    assert!(of(&tables, Some(0.5)).0 && of(&tables, Some(0.0)).0);
    assert!(of(&tables, None).1.contains("--caustic-roughness"));
    assert!(of(&tables, Some(0.6)).1.contains("below 0.6"));
    let without_glass = Tables { materials: tables.materials.clone(), ..Tables::new(MaterialKind::Thin as u32, 0.0) };
    let mut without_glass = Tables { primitives: without_glass.primitives[..2].to_vec(), ..without_glass };
    without_glass.triangles.truncate(2);
    assert!(of(&without_glass, Some(0.5)).1.contains("no perfect mirror"));
    tables.lights[0] = Light { kind: Light::ENVIRONMENT, power: [1.0; 3], ..Light::default() };
    assert!(of(&tables, Some(0.5)).0);
}

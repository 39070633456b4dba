//! A scene with lights of every kind and a glass ball, for probes of functions that read tables.

use std::sync::LazyLock;

use photon_scene::shapes::icosphere;
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder};

/// The scene. Seven lights: two triangles that emit from one side and two from both, a point light, a spotlight and a
/// directional light.
pub(super) static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let mut scene = SceneBuilder::new();
    let floor = scene.material(MaterialDesc::lambert("floor", [0.5; 3]));
    let area_light = scene.material(MaterialDesc::emissive("area light", [0.0; 3], [9.0, 5.0, 2.0]));
    let mut both = MaterialDesc::emissive("both", [0.0; 3], [1.0, 2.0, 4.0]);
    both.emits_both_sides = true;
    let both = scene.material(both);
    let glass = scene.material(MaterialDesc::glass("glass", 1.5));
    scene.quad("floor", [[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0]], floor);
    scene.quad("area light", [[-0.5, 3.0, -0.5], [0.5, 3.0, -0.5], [0.5, 3.0, 0.5], [-0.5, 3.0, 0.5]], area_light);
    scene.quad("both", [[-1.5, 0.5, -1.0], [-1.5, 0.5, 1.0], [-1.5, 1.5, 1.0], [-1.5, 1.5, -1.0]], both);
    let (positions, triangles) = icosphere(2, [0.5, 0.8, 0.2], 0.5);
    scene.mesh("ball", positions, triangles, glass);
    scene.light("point", LightDesc::Point { position: [1.0, 2.0, 1.0], intensity: [3.0, 2.0, 1.0] });
    let (position, direction) = ([-1.0, 2.5, -1.0], [0.4, -1.0, 0.3]);
    let intensity = [4.0, 4.0, 1.0];
    let spot = LightDesc::Spot { position, direction, intensity, inner_angle: 0.3, outer_angle: 0.6 };
    scene.light("spot", spot);
    scene.light("sun", LightDesc::Directional { direction: [-0.3, -1.0, 0.2], irradiance: [0.5, 0.6, 0.7] });
    scene.build().unwrap()
});

#[test]
fn the_scene_has_lights_of_every_kind() {
    use photon_core::Light;
    let view = SCENE.view();
    let count = |kind| view.lights.iter().filter(|light| light.kind == kind).count();
    let kinds = [Light::TRIANGLE, Light::POINT, Light::SPOT, Light::DIRECTIONAL].map(count);
    assert_eq!(kinds, [4, 1, 1, 1]);
    assert_eq!(view.lights.iter().filter(|light| light.flags & Light::BOTH_SIDES != 0).count(), 2);
}

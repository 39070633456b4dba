//! G4, pixel by pixel: white surfaces in an even environment show its radiance at every angle, not only on average.

use photon_core::{Direct, EnvironmentMap, Settings};
use photon_scene::{MaterialDesc, SceneBuilder, Surface, VertexAttributes, shapes};

use crate::harness::{TestBackend, direct_settings, look_at_point, per_pass_by_pixel};
use crate::stats::{agrees, assert_agrees, moments, standard_error};

/// G4: each of 100 pixels of a ball in radiance 1 shows 1: metal, plastic and mixtures of them, smooth and rough glass. The
/// passes of a pixel are independent. The tables allow 2.5e-3 at a surface, 1e-2 at the four or more of a path in glass.
pub fn g4_every_pixel<T: TestBackend>() {
    let gloss = |metallic, roughness| {
        let surface = Surface::Glossy { base_color: [1.0; 3], metallic, roughness, specular: 1.0, ior: 1.5 };
        MaterialDesc::new("white", surface)
    };
    let glass = |roughness| {
        MaterialDesc::new("glass", Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [1.0; 3], roughness })
    };
    for (what, material, bound) in [
        ("smooth metal", gloss(1.0, 0.0), 2.5e-3),
        ("metal", gloss(1.0, 0.3), 2.5e-3),
        ("rough metal", gloss(1.0, 1.0), 2.5e-3),
        ("plastic", gloss(0.0, 0.3), 2.5e-3),
        ("a mixture", gloss(0.5, 0.6), 2.5e-3),
        ("glass", glass(0.0), 1e-4),
        ("rough glass", glass(0.5), 1e-2),
    ] {
        let mut builder = SceneBuilder::new();
        let material = builder.material(material);
        let (positions, triangles) = shapes::icosphere(3, [0.0; 3], 0.5);
        let normals = if bound < 1e-2 && what != "glass" { positions.clone() } else { Vec::new() };
        let attributes = VertexAttributes::default().with_normals(normals);
        builder.mesh_with("ball", positions, triangles, attributes, material);
        look_at_point(&mut builder, [0.0; 3], [0.48, 0.8, 0.36], 2.0, 0.3);
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        let settings = Settings { max_bounces: 512, ..direct_settings(Direct::Nee, 0.1) };
        let pixels = per_pass_by_pixel::<T>(&builder.build().unwrap(), &settings, 48, 10);
        for (pixel, values) in pixels.iter().enumerate() {
            let (found, error) = (moments(values).0, standard_error(values));
            assert_agrees(&format!("{what}, pixel {pixel}"), found, 1.0, error, bound);
            assert!(!agrees(found, 1.5, error, bound), "{what}: the noise is small enough to tell: {error}");
        }
    }
}

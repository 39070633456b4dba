//! G4, pixel by pixel: white surfaces in an even environment show its radiance at every angle, not only on average.

use photon_core::{Direct, EnvironmentMap, Settings};
use photon_scene::{MaterialDesc, SceneBuilder, Surface, VertexAttributes, shapes};

use crate::harness::{TestBackend, direct_settings, film, look_at_point};
use crate::stats::{agrees, assert_agrees};

/// Checks each pixel of balls in radiance 1, with the standard errors of the film, which are those of independent passes.
fn check<T: TestBackend>(materials: Vec<MaterialDesc>, bound: f64) {
    let mut builder = SceneBuilder::new();
    let columns = materials.len().min(3);
    for (k, material) in materials.into_iter().enumerate() {
        let is_glass = matches!(material.surface, Surface::Dielectric { .. });
        let material = builder.material(material);
        let centre = [1.1 * (k % columns) as f64, 1.1 * (k / columns) as f64, 0.0];
        let (positions, triangles) = shapes::icosphere(3, centre, 0.5);
        // Between few triangles, glass with vertex normals loses light.
        let from = |p: &[f64; 3]| [0, 1, 2].map(|axis| p[axis] - centre[axis]);
        let normals = if is_glass { Vec::new() } else { positions.iter().map(from).collect() };
        builder.mesh_with("ball", positions, triangles, VertexAttributes::default().with_normals(normals), material);
    }
    let half = 0.5 + 0.55 * (columns as f64 - 1.0);
    let centre = [half - 0.5, if columns > 1 { 0.55 } else { 0.0 }, 0.0];
    look_at_point(&mut builder, centre, [0.0, 0.0, 1.0], 2.0, half);
    builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
    let settings = Settings { max_bounces: 512, errors: true, photons: 100, ..direct_settings(Direct::Nee, 0.1) };
    let found = film::<T>(&builder.build().unwrap(), &settings, 160, 14).confidence_intervals().unwrap();
    let mut telling = 0;
    for (pixel, interval) in found.iter().enumerate() {
        let what = format!("column {}, row {}", pixel % 14, pixel / 14);
        assert_agrees(&what, interval.value, 1.0, interval.standard_error, bound);
        telling += usize::from(!agrees(interval.value, 1.4, interval.standard_error, bound));
    }
    // The noise of few pixels, at edges of rough glass, hides an error of 0.4.
    assert!(telling * 20 > found.len() * 19, "{telling} of {}", found.len());
}

/// G4: each pixel of a picture of balls in radiance 1 shows 1: metals, smooth and rough glass, which light each other; and a
/// mixture of metal and plastic alone, since diffuse light from ball to ball takes photons. The tables allow 2.5e-3 at a
/// surface, 1e-2 at the four or more of a path in glass.
pub fn g4_every_pixel<T: TestBackend>() {
    let gloss = |metallic, roughness| {
        let surface = Surface::Glossy { base_color: [1.0; 3], metallic, roughness, specular: 1.0, ior: 1.5 };
        MaterialDesc::new("white", surface)
    };
    let glass = |roughness| {
        MaterialDesc::new("glass", Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [1.0; 3], roughness })
    };
    let materials = vec![gloss(1.0, 0.0), gloss(1.0, 0.3), gloss(1.0, 1.0), glass(0.0), glass(0.3), glass(0.8)];
    check::<T>(materials, 1e-2);
    check::<T>(vec![gloss(0.5, 0.4)], 2.5e-3);
}

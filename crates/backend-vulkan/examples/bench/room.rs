//! A scene and rays for closest-hit benchmarks, here and in the CPU backend's benchmarks.

use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{Material, Medium, Primitive, RandomKind, Ray, SceneView, Units, sampling};

/// Positions and triangles.
pub(crate) type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// Calls `with` with a mesh as a scene of one material without lights.
pub(crate) fn with_view<R>((positions, triangles): &Mesh, with: impl FnOnce(&SceneView<'_>) -> R) -> R {
    let primitives = vec![Primitive { normal: [0.0, 0.0, 1.0], material: 0 }; triangles.len()];
    with(&SceneView {
        positions,
        triangles,
        primitives: &primitives,
        materials: &[Material { albedo: [0.5; 3], ..Material::default() }],
        media: &[Medium::VACUUM],
        lights: &[],
        light_cdf: &[],
        radius: 1.0,
        units: Units::default(),
        ..SceneView::default()
    })
}

/// A room of 12 triangles that contains a bumpy sphere of about `count` triangles.
pub(crate) fn scene(count: usize) -> Mesh {
    let rings = ((count as f64) / 4.0).sqrt() as u32;
    let segments = 2 * rings;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for ring in 0..=rings {
        for segment in 0..segments {
            let theta = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            let phi = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let r = 0.25 * (1.0 + 0.1 * (20.0 * theta).sin() * (24.0 * phi).sin());
            let at = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            positions.push(at.map(|c| (r * c) as f32));
        }
    }
    for ring in 0..rings {
        for segment in 0..segments {
            let at = |r: u32, s: u32| r * segments + s % segments;
            let (a, b) = (at(ring, segment), at(ring, segment + 1));
            let (c, d) = (at(ring + 1, segment), at(ring + 1, segment + 1));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    let base = positions.len() as u32;
    for corner in 0..8_u8 {
        positions.push([0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { 0.5 } else { -0.5 }));
    }
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]] {
        triangles.extend([[base + a, base + b, base + c], [base + a, base + c, base + d]]);
    }
    (positions, triangles)
}

/// Rays in random directions, half from the walls and half from the sphere.
pub(crate) fn rays(count: u32) -> Vec<Ray> {
    (0..count)
        .map(|path| {
            let mut sampler = Sampler::new(RandomKind::Counter, 1, 0, Domain::Photon, path);
            let [a, b, c, d] = sampler.words(0).map(unit_f32);
            let outward = sampling::uniform_sphere(a, b);
            let (origin, normal) = if path % 2 == 0 {
                let m = outward.abs().max_element();
                let axis = if outward.x.abs() == m {
                    Vec3::X
                } else if outward.y.abs() == m {
                    Vec3::Y
                } else {
                    Vec3::Z
                };
                (outward / m * 0.499_99, -axis * outward.dot(axis).signum())
            } else {
                (outward * 0.28, outward)
            };
            Ray { origin, direction: sampling::cosine_hemisphere(normal, c, d), t_max: f32::INFINITY }
        })
        .collect()
}

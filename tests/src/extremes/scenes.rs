//! Scenes that can be placed anywhere, in any size, and helpers to trace and evaluate them.

use photon_core::glam::Vec3;
use photon_core::{Backend, Film, Layer, PerMap, Photon, PhotonRay, Settings, Tally, octahedral};
use photon_scene::shapes::Shape;
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, shapes};

use crate::harness::{TestBackend, Tracing, Uniform, look_at_point};

/// Placement and size: `p` becomes `p · size + place`.
#[derive(Clone, Copy, Debug)]
pub struct Put {
    /// User length of what is one metre at size 1.
    pub size: f64,
    /// Offset in user space.
    pub place: [f64; 3],
    /// Factor on all powers.
    pub watts: f64,
}

impl Default for Put {
    fn default() -> Self {
        Self { size: 1.0, place: [0.0; 3], watts: 1.0 }
    }
}

impl Put {
    fn point(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| p[axis] * self.size + self.place[axis])
    }

    fn shape(&self, (positions, triangles): Shape) -> Shape {
        (positions.into_iter().map(|p| self.point(p)).collect(), triangles)
    }
}

/// A closed grey room with a glass ball, a mirror, an area light on the ceiling and a point light. Its lights emit
/// the same power whatever its size.
#[must_use]
pub fn studio(put: Put) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.6, 0.5, 0.4]));
    let glass = builder.material(MaterialDesc::glass("glass", 1.5));
    let mirror = builder.material(MaterialDesc::mirror("mirror", [0.9; 3]));
    let radiance = put.watts / put.size / put.size;
    let area_light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [radiance; 3]));
    let quad =
        |y: f64, half: f64| shapes::quad([[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]]);
    let wall = shapes::quad([[-0.9, -0.5, -0.8], [-0.9, -0.5, 0.8], [-0.9, 0.5, 0.8], [-0.9, 0.5, -0.8]]);
    for (name, shape, material) in [
        ("room", shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3])), grey),
        ("ball", shapes::icosphere(3, [0.3, -0.5, 0.2], 0.4), glass),
        ("mirror", wall, mirror),
        ("light", quad(0.95, 0.25), area_light),
    ] {
        let (positions, triangles) = put.shape(shape);
        builder.mesh(name, positions, triangles, material);
    }
    let light = LightDesc::Point { position: put.point([-0.3, 0.4, 0.1]), intensity: [0.1 * put.watts; 3] };
    builder.light("bulb", light);
    look_at_point(&mut builder, put.point([-0.3, -1.0, 0.1]), [0.0, 1.0, 0.0], 0.5 * put.size, 0.3 * put.size);
    builder
}

/// Rotates a shape about y, then about x, so that nothing is axis-aligned.
#[must_use]
pub fn turned(shape: Shape) -> Shape {
    let (mut positions, triangles) = shapes::rotate_y(shape, 0.7);
    let (s, c) = 0.4_f64.sin_cos();
    for p in &mut positions {
        *p = [p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]];
    }
    (positions, triangles)
}

/// A closed shape with a black inside, and a light that only serves to define the power.
#[must_use]
pub fn black_inside(shape: Shape) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
    let (positions, triangles) = if shapes::volume(&shape) > 0.0 { shapes::flip(shape) } else { shape };
    builder.mesh("walls", positions, triangles, black);
    builder.light("light", LightDesc::Point { position: [0.0; 3], intensity: [1.0; 3] });
    builder
}

/// A photon ray of unit power.
#[must_use]
pub fn ray(origin: Vec3, direction: Vec3) -> PhotonRay {
    PhotonRay { origin: origin.into(), direction: direction.into(), power: [1.0; 3], ..PhotonRay::default() }
}

/// Traces the caller's rays; numbers them.
pub fn follow<T: TestBackend>(
    scene: &Scene,
    settings: &Settings,
    rays: &mut [PhotonRay],
) -> (PerMap<Vec<Photon>>, Tally) {
    for (path, ray) in rays.iter_mut().enumerate() {
        ray.path = path as u32;
    }
    let count = rays.len() as u32;
    let capacity = u64::from(count) * u64::from(settings.max_bounces.min(64)) + 1;
    let mut tracing = Tracing::new(T::make(2), scene, settings, capacity);
    let there = tracing.on.upload("rays", rays).unwrap();
    tracing.follow(0..count, &there);
    tracing.end()
}

/// A direction, uniform over the sphere.
pub fn anywhere(uniform: &mut Uniform) -> Vec3 {
    photon_core::sampling::uniform_sphere(uniform.draw() as f32, uniform.draw() as f32)
}

/// Mean of a layer over the pixels and RGB, in W/(m²·sr), in f64 throughout.
#[must_use]
pub fn mean(film: &Film, layer: Option<Layer>) -> f64 {
    let layers = Layer::ALL.into_iter().filter(|&own| layer.is_none_or(|layer| layer == own));
    let sum: f64 =
        layers.map(|own| film.pixels.iter().map(|p| p.layers[own as usize].iter().sum::<f64>()).sum::<f64>()).sum();
    sum / (3 * film.pixels.len()) as f64 / f64::from(film.passes) * film.units.radiance_to_user()
}

/// Whether a photon satisfies what its layout promises.
#[must_use]
pub fn sound(photon: &Photon) -> bool {
    let finite = photon.position.iter().chain(&photon.power).all(|x| x.is_finite());
    let unit = |packed| (octahedral::unpack(packed).length() - 1.0).abs() < 1e-4;
    finite && photon.power.iter().all(|&p| p >= 0.0) && unit(photon.direction) && unit(photon.normal)
}

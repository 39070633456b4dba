//! The intersection of a ray and a surface, with all data that shading needs.

use glam::Vec3;

use crate::offset;
use crate::scene::caster::{Hit, Ray};
use crate::scene::material::Primitive;
use crate::shading::bsdf::Lobe;

/// The intersection of a ray and a surface.
// Exhaustive: backends write it as a literal.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// Distance along the ray.
    pub t: f32,
    /// The point on the surface, normalised space.
    pub point: Vec3,
    /// Origin of new rays before the offset along the normal: the point, moved away from the triangle's
    /// edges.
    pub start: Vec3,
    /// Unit geometric normal on the side that the ray came from.
    pub normal: Vec3,
    /// Cosine between that normal and the direction back to the ray's origin, ≥ 0.
    pub cosine: f32,
    /// Whether that side is the front.
    pub front: bool,
    /// Index of the material.
    pub material: u32,
}

impl SurfaceInteraction {
    /// The intersection of a ray in `direction` at `hit`, for the triangle with these `vertices`, their
    /// [`offset::margin`], and its primitive.
    #[inline]
    #[must_use]
    pub fn new(direction: Vec3, hit: &Hit, vertices: [Vec3; 3], margin: f32, primitive: &Primitive) -> Self {
        let normal = Vec3::from(primitive.normal);
        let cosine = -direction.dot(normal);
        let front = cosine > 0.0;
        Self {
            t: hit.t,
            point: offset::barycentric(vertices, hit.u, hit.v),
            start: offset::within(vertices, margin, hit.u, hit.v),
            normal: if front { normal } else { -normal },
            cosine: cosine.abs(),
            front,
            material: primitive.material,
        }
    }

    /// As it is with the shading normal `normal`: the cosine is to that normal.
    #[inline]
    #[must_use]
    pub fn with_cosine_to(self, normal: Vec3, direction: Vec3) -> Self {
        Self { cosine: -direction.dot(normal), ..self }
    }

    /// The ray that continues from here in `direction`, as sampled from `lobe`: on the same side, or on the
    /// other side after transmission.
    #[inline]
    #[must_use]
    pub fn spawn(&self, lobe: Lobe, direction: Vec3) -> Ray {
        let normal = match lobe {
            Lobe::Diffuse | Lobe::SpecularReflection => self.normal,
            Lobe::SpecularTransmission => -self.normal,
        };
        Ray { origin: offset::off_surface(self.start, normal), direction, t_max: f32::INFINITY }
    }
}

//! Rays, hits, and the trait by which a renderer can use its own ray tracer.

use glam::Vec3;

/// A ray in the normalised space of the scene (a unit box; see `docs/units.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin, already moved off the surface that the ray leaves.
    pub origin: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Hits farther away do not count; `f32::INFINITY` for no limit, never NaN.
    pub t_max: f32,
}

/// Intersection of a ray and a triangle.
///
/// Contains nothing about the surface: normals and materials come from the scene's own tables, so that
/// shading does not depend on the ray caster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in `[0, t_max]`.
    pub t: f32,
    /// Index of the triangle.
    pub primitive: u32,
    /// Weight of the triangle's second vertex; the point is `(1 - u - v) a + u b + v c`.
    pub u: f32,
    /// Weight of the triangle's third vertex.
    pub v: f32,
}

/// Nearest-hit queries, from many threads at once.
pub trait RayCaster: Send + Sync {
    /// The nearest hit with `t` in `[0, t_max]`, on either side of the triangle; of several at the same
    /// `t`, the one with the lowest primitive index.
    fn nearest(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything is hit with `t` in `[0, t_max]`.
    fn occluded(&self, ray: &Ray) -> bool {
        self.nearest(ray).is_some()
    }

    /// Memory of the acceleration structure in bytes, for reports; 0 if unknown.
    fn bytes(&self) -> u64 {
        0
    }
}

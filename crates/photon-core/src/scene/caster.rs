//! Rays, hits, and the trait behind which a renderer may put its own ray tracer.

use glam::Vec3;

/// A ray in the normalised space of the scene (a unit box; see `docs/units.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts; already moved off the surface that it leaves.
    pub origin: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Hits farther than this do not count; `f32::INFINITY` for no limit, never NaN.
    pub t_max: f32,
}

/// Where a ray meets a triangle.
///
/// Nothing about the surface is in it: normals and materials come from the scene's own tables, so
/// that every caster agrees on shading.
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
    /// The nearest hit with `t` in `[0, t_max]`, whichever side of the triangle it is on; of
    /// several at the same `t`, the one with the lowest primitive index.
    fn nearest(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything is hit with `t` in `[0, t_max]`.
    fn occluded(&self, ray: &Ray) -> bool {
        self.nearest(ray).is_some()
    }

    /// Bytes that the structure holds, for the report; 0 if unknown.
    fn bytes(&self) -> u64 {
        0
    }
}

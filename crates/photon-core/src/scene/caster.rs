//! Rays, hits, and the trait by which a renderer can use its own ray tracer.

use glam::Vec3;

/// A ray in the normalised space of the scene (a unit box; see `docs/units.md`).
// Exhaustive: written as a literal by everything that traces.
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
// Exhaustive: every ray caster must state each field.
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

/// The ray could not be followed: more surfaces than [`SkipLimit::HITS`] were not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a ray passed more than 64 surfaces that are not there; implement RayCaster::nearest_where")]
pub struct SkipLimit;

impl SkipLimit {
    /// Number of hits that the default of [`RayCaster::nearest_where`] passes.
    pub const HITS: u32 = 64;
}

/// Step beyond a surface that is not there, relative to the distance and the coordinates, at least to 1.
const STEP: f32 = 1.0 / 1_048_576.0;

/// Nearest-hit queries, from many threads at once.
pub trait RayCaster: Send + Sync {
    /// The nearest hit with `t` in `[0, t_max]`, on either side of the triangle; of several at the same
    /// `t`, the one with the lowest primitive index.
    fn nearest(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything is hit with `t` in `[0, t_max]`.
    fn occluded(&self, ray: &Ray) -> bool {
        self.nearest(ray).is_some()
    }

    /// The nearest hit for which `keep` holds; otherwise as [`Self::nearest`]. Used for surfaces with alpha. `keep` is a
    /// pure function, and may be called for any hit along the ray, in any order.
    ///
    /// The default calls [`Self::nearest`] again from beyond each hit that is not kept: of surfaces that are closer to
    /// each other than about 10⁻⁶, those behind one that is not kept may be missed.
    ///
    /// # Errors
    /// [`SkipLimit`] if more than [`SkipLimit::HITS`] hits are not kept; casters that test triangles with `keep`
    /// during traversal need no limit. A photon ends there and counts as truncated, other paths find nothing, and
    /// shadow rays count as occluded.
    fn nearest_where(&self, ray: &Ray, keep: &dyn Fn(&Hit) -> bool) -> Result<Option<Hit>, SkipLimit> {
        let (mut rest, mut passed) = (*ray, 0.0);
        for _ in 0..=SkipLimit::HITS {
            let Some(hit) = self.nearest(&rest) else { return Ok(None) };
            let hit = Hit { t: passed + hit.t, ..hit };
            if keep(&hit) {
                return Ok(Some(hit));
            }
            let size = hit.t.max(ray.origin.abs().max_element()).max(1.0);
            passed = hit.t + STEP * size;
            rest = Ray { origin: ray.origin + ray.direction * passed, t_max: ray.t_max - passed, ..*ray };
            // Infinity stays infinite, and NaN ends the search.
            if !(rest.t_max >= 0.0) {
                return Ok(None);
            }
        }
        Err(SkipLimit)
    }

    /// Whether anything is hit for which `keep` holds, as [`Self::nearest_where`].
    ///
    /// # Errors
    /// As [`Self::nearest_where`].
    fn occluded_where(&self, ray: &Ray, keep: &dyn Fn(&Hit) -> bool) -> Result<bool, SkipLimit> {
        self.nearest_where(ray, keep).map(|hit| hit.is_some())
    }

    /// The primitive indices of the triangles that may overlap the box from `low` to `high`, corners in normalised space as
    /// the positions of the scene view, in any order; they are written to `room`, and returned. `None`, the default, if that
    /// is unknown or there are more than fit; what `room` contains then does not matter.
    ///
    /// The box is closed: a triangle that touches it overlaps it. All that overlap it are reported; others may be, and any of
    /// them more than once. This is not checked. Where an answer is given, the areas of estimates are found without rays in the
    /// middle of flat surfaces: a triangle that is not reported silently makes these areas too large where it ends the surface
    /// or hides it. Nothing else depends on it.
    fn overlapping<'a>(&self, low: Vec3, high: Vec3, room: &'a mut [u32]) -> Option<&'a [u32]> {
        let _ = (low, high, room);
        None
    }

    /// [`Self::nearest`] for each ray, into the element of `hits` at the same index. Both have the same length, and all
    /// elements of `hits` are written.
    fn nearest_many(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.nearest(ray);
        }
    }

    /// Whether calls of [`Self::nearest_many`] with many rays are worth their memory traffic: for casters that trace packets,
    /// or whose calls are expensive. The CPU then traces photons and camera paths surface by surface in blocks, and shadow
    /// rays of diffuse surfaces together, in scenes without alpha. The result is the same, bit by bit.
    fn prefers_batches(&self) -> bool {
        false
    }

    /// Returns an error that has occurred since the last call, and forgets it. Called after each stage of a pass, which then
    /// fails; what was returned for the rays of that stage does not matter.
    fn take_error(&self) -> Option<Box<dyn std::error::Error + Send + Sync>> {
        None
    }

    /// Memory of the acceleration structure in bytes, for reports; 0 if unknown.
    fn bytes(&self) -> u64 {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Planes at z = 1, 2, 3 and so on; the index is the distance less 1.
    struct Planes(u32);

    impl RayCaster for Planes {
        fn nearest(&self, ray: &Ray) -> Option<Hit> {
            let next = (ray.origin.z.ceil()).max(1.0);
            let t = next - ray.origin.z;
            let there = next <= self.0 as f32 && t <= ray.t_max;
            there.then_some(Hit { t, primitive: next as u32 - 1, u: 0.25, v: 0.5 })
        }
    }

    #[test]
    fn many_rays_are_traced_like_each_of_them() {
        let along = |z: f32| Ray { origin: Vec3::new(0.0, 0.0, z), direction: Vec3::Z, t_max: 1.0 };
        let rays = [0.0, 1.5, 9.0].map(along);
        let mut hits = [Some(Hit { t: 7.0, primitive: 7, u: 0.0, v: 0.0 }); 3];
        Planes(5).nearest_many(&rays, &mut hits);
        assert_eq!(hits, rays.map(|ray| Planes(5).nearest(&ray)));
        assert!(hits[0].is_some() && hits[2].is_none());
    }

    #[test]
    fn surfaces_are_skipped_one_by_one_up_to_a_limit() {
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z, t_max: f32::INFINITY };
        let beyond = |count: u32| move |hit: &Hit| hit.primitive >= count;
        for count in [0, 1, 7, SkipLimit::HITS] {
            let hit = Planes(100).nearest_where(&ray, &beyond(count)).unwrap().unwrap();
            assert_eq!(hit.primitive, count);
            assert!((hit.t - (count + 1) as f32).abs() < 1e-4, "{hit:?}");
        }
        assert_eq!(Planes(100).nearest_where(&ray, &beyond(SkipLimit::HITS + 1)), Err(SkipLimit));
        assert_eq!(Planes(100).occluded_where(&ray, &beyond(SkipLimit::HITS + 1)), Err(SkipLimit));
        assert_eq!(Planes(9).nearest_where(&ray, &beyond(9)), Ok(None));
        let short = Ray { t_max: 2.5, ..ray };
        assert_eq!(Planes(9).occluded_where(&short, &beyond(1)), Ok(true));
        assert_eq!(Planes(9).occluded_where(&short, &beyond(2)), Ok(false));
    }
}

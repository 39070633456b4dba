//! The caller's ray caster.

use std::error::Error as StdError;
use std::ffi::c_void;
use std::sync::Mutex;
use std::sync::PoisonError;

use photonmap::{Error, Hit, Ray, RayCaster, SceneView};

use crate::error::{Fault, Result};
use crate::pointer;

/// PmHit.primitive of a ray that hits nothing.
pub const PM_NO_HIT: u32 = u32::MAX;

/// A ray in normalised space: see PmSceneInfo.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct PmRay {
    /// Already moved off the surface that the ray leaves.
    pub origin: [f32; 3],
    /// Unit vector.
    pub direction: [f32; 3],
    /// Hits farther away do not count; may be infinite.
    pub t_max: f32,
}

/// The nearest hit along a ray, on either side of a triangle; of several, the one with the lowest index.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmHit {
    /// Distance, at least 0 and finite. Hits beyond t_max do not count.
    pub t: f32,
    /// Index of the triangle, as prepare() got it, or PM_NO_HIT, which it is before the call.
    pub primitive: u32,
    /// Weight of the second vertex, in [0, 1]. The point is (1 - u - v) a + u b + v c.
    pub u: f32,
    /// Weight of the third vertex, in [0, 1].
    pub v: f32,
}

/// A ray caster of the caller. The struct is copied; what `user` points to has to exist as long as the renderer.
///
/// A function that returns anything but 0 ends the pass with PM_STATUS_CASTER, and so do a hit with a `t` that is
/// negative or not finite, with a triangle that does not exist, or with `u` or `v` outside of [0, 1]. Functions must not
/// throw exceptions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmCaster {
    /// sizeof(PmCaster).
    pub size: usize,
    /// Passed to the functions. Several threads use it at once.
    pub user: *mut c_void,
    /// Called once, by pm_renderer_new(), with the triangles in normalised space: 3 coordinates for each vertex, 3 indices
    /// for each triangle. Triangles without area have been dropped; pm_scene_triangle_sources() says which remain. The
    /// arrays exist only during the call. May be NULL.
    pub prepare: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            positions: *const f32,
            vertex_count: usize,
            triangles: *const u32,
            triangle_count: usize,
        ) -> i32,
    >,
    /// Finds what `count` rays hit, at least 1. Called by several threads at once. Not NULL.
    pub nearest:
        Option<unsafe extern "C" fn(user: *mut c_void, rays: *const PmRay, hits: *mut PmHit, count: usize) -> i32>,
    /// Not 0: photon and camera paths are traced surface by surface, and shadow rays of diffuse surfaces together, so that
    /// `count` is up to some thousands; final-gather rays, shadow rays of other surfaces and all rays of scenes with alpha
    /// still come one by one. 0: all do. The picture is the same.
    pub batches: u32,
}

pointer::versioned!(PmCaster);

/// A ray caster that calls the caller's.
pub(crate) struct Caster {
    caster: PmCaster,
    /// The first error since it was asked for.
    error: Mutex<Option<String>>,
}

// SAFETY: the functions are pointers to code, and the caller promises that several threads may use `user` at once.
unsafe impl Send for Caster {}
// SAFETY: as above.
unsafe impl Sync for Caster {}

impl Caster {
    /// Reads and checks the struct.
    ///
    /// # Safety
    /// `caster` is NULL or points to a struct, whose promises hold as long as the result exists.
    pub(crate) unsafe fn new(caster: *const PmCaster) -> Result<Self> {
        // SAFETY: as the caller ensures.
        let caster = unsafe { pointer::read(caster) }?;
        if caster.nearest.is_none() {
            return Err(Fault::argument("PmCaster.nearest is NULL"));
        }
        Ok(Self { caster, error: Mutex::new(None) })
    }

    /// A copy for a scene, after `prepare`.
    pub(crate) fn prepared(&self, scene: &SceneView<'_>) -> photonmap::Result<Self> {
        let caster = self.caster;
        if let Some(prepare) = caster.prepare {
            let (positions, triangles) = (scene.positions.as_flattened(), scene.triangles.as_flattened());
            let (vertices, count) = (scene.positions.len(), scene.triangles.len());
            // SAFETY: arrays of these lengths; the caller promises that the function can be called.
            let code = unsafe { prepare(caster.user, positions.as_ptr(), vertices, triangles.as_ptr(), count) };
            if code != 0 {
                let source = format!("prepare() of the ray caster returned {code}").into();
                return Err(Error::Backend { backend: "ray caster", source });
            }
        }
        Ok(Self { caster, error: Mutex::new(None) })
    }

    fn call(&self, rays: &[PmRay], hits: &mut [PmHit]) {
        // Not absent: `new`.
        let Some(nearest) = self.caster.nearest else { return };
        // SAFETY: both arrays have this length; the caller promises that the function can be called by any thread.
        let code = unsafe { nearest(self.caster.user, rays.as_ptr(), hits.as_mut_ptr(), rays.len()) };
        if code != 0 {
            let mut first = self.error.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert_with(|| format!("nearest() of the ray caster returned {code}"));
            hits.fill(NOTHING);
        }
    }
}

const NOTHING: PmHit = PmHit { t: 0.0, primitive: PM_NO_HIT, u: 0.0, v: 0.0 };

fn ray(ray: &Ray) -> PmRay {
    PmRay { origin: ray.origin.to_array(), direction: ray.direction.to_array(), t_max: ray.t_max }
}

fn hit(PmHit { t, primitive, u, v }: PmHit) -> Option<Hit> {
    (primitive != PM_NO_HIT).then_some(Hit { t, primitive, u, v })
}

impl RayCaster for Caster {
    fn nearest(&self, one: &Ray) -> Option<Hit> {
        let mut found = [NOTHING];
        self.call(&[ray(one)], &mut found);
        hit(found[0])
    }

    fn nearest_many(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        if rays.is_empty() {
            return;
        }
        let mut found = vec![NOTHING; rays.len()];
        let rays: Vec<PmRay> = rays.iter().map(ray).collect();
        self.call(&rays, &mut found);
        hits.iter_mut().zip(found).for_each(|(slot, found)| *slot = hit(found));
    }

    fn prefers_batches(&self) -> bool {
        self.caster.batches != 0
    }

    fn take_error(&self) -> Option<Box<dyn StdError + Send + Sync>> {
        self.error.lock().unwrap_or_else(PoisonError::into_inner).take().map(Into::into)
    }
}

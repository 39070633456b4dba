//! Checks what a caller's ray caster returns.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;

use photon_core::glam::Vec3;
use photon_core::{Hit, Ray, RayCaster, SkipLimit};

type Source = Box<dyn std::error::Error + Send + Sync>;

/// How far a barycentric coordinate may lie outside of `[0, 1]`, by rounding.
const TOLERANCE: f32 = 1e-3;

/// A caller's ray caster. Hits that are invalid, and panics, become errors of the stage; the rays then hit nothing.
pub(crate) struct Checked {
    caster: Box<dyn RayCaster>,
    triangles: usize,
    /// The first error since it was asked for.
    error: Mutex<Option<Source>>,
}

impl Checked {
    pub(crate) fn new(caster: Box<dyn RayCaster>, triangles: usize) -> Self {
        Self { caster, triangles, error: Mutex::new(None) }
    }

    fn note(&self, error: String) {
        // A thread that panics while it has the lock leaves a valid value.
        let mut first = self.error.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        first.get_or_insert_with(|| error.into());
    }

    /// The hit, if it is valid and not beyond the end of the ray.
    fn valid(&self, ray: &Ray, hit: Hit) -> Option<Hit> {
        if let Some(fault) = fault(&hit, self.triangles) {
            self.note(format!("the ray caster returned {fault}, for a ray {}", described(ray)));
            return None;
        }
        (hit.t <= ray.t_max).then_some(hit)
    }

    /// The result of `call`, or `otherwise` after a panic.
    fn guarded<T>(&self, otherwise: T, call: impl FnOnce() -> T) -> T {
        catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a message");
            self.note(format!("the ray caster panicked: {text}"));
            otherwise
        })
    }
}

/// What is wrong with a hit; `None` if nothing is.
fn fault(hit: &Hit, triangles: usize) -> Option<String> {
    let Hit { t, primitive, u, v } = *hit;
    let within = |weight: f32| (-TOLERANCE..=1.0 + TOLERANCE).contains(&weight);
    // NaN fails each comparison.
    if !(t >= 0.0 && t.is_finite()) {
        return Some(format!("t = {t}, which has to be at least 0 and finite"));
    }
    if primitive as usize >= triangles {
        return Some(format!("triangle {primitive}, but there are {triangles}, numbered from 0"));
    }
    (!(within(u) && within(v))).then(|| format!("u = {u} and v = {v}, which have to lie between 0 and 1"))
}

fn described(ray: &Ray) -> String {
    format!("from {:?} along {:?}", ray.origin.to_array(), ray.direction.to_array())
}

impl RayCaster for Checked {
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        self.guarded(None, || self.caster.nearest(ray)).and_then(|hit| self.valid(ray, hit))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.guarded(false, || self.caster.occluded(ray))
    }

    fn nearest_where(&self, ray: &Ray, keep: &dyn Fn(&Hit) -> bool) -> Result<Option<Hit>, SkipLimit> {
        let keep = |hit: &Hit| self.valid(ray, *hit).is_some_and(|_| keep(hit));
        let hit = self.guarded(Ok(None), || self.caster.nearest_where(ray, &keep))?;
        Ok(hit.and_then(|hit| self.valid(ray, hit)))
    }

    fn occluded_where(&self, ray: &Ray, keep: &dyn Fn(&Hit) -> bool) -> Result<bool, SkipLimit> {
        let keep = |hit: &Hit| self.valid(ray, *hit).is_some_and(|_| keep(hit));
        self.guarded(Ok(false), || self.caster.occluded_where(ray, &keep))
    }

    fn nearest_many(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        hits.fill(None);
        self.guarded((), || self.caster.nearest_many(rays, hits));
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = hit.and_then(|hit| self.valid(ray, hit));
        }
    }

    fn overlapping<'a>(&self, low: Vec3, high: Vec3, room: &'a mut [u32]) -> Option<&'a [u32]> {
        let found = self.guarded(None, || self.caster.overlapping(low, high, room))?;
        let wrong = found.iter().find(|&&triangle| triangle as usize >= self.triangles);
        if let Some(triangle) = wrong {
            self.note(format!(
                "the ray caster returned triangle {triangle} in a box, but there are {}",
                self.triangles
            ));
            return None;
        }
        Some(found)
    }

    fn prefers_batches(&self) -> bool {
        self.guarded(false, || self.caster.prefers_batches())
    }

    fn take_error(&self) -> Option<Source> {
        let ours = self.error.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take();
        let theirs = self.guarded(None, || self.caster.take_error());
        ours.or(theirs)
    }

    fn bytes(&self) -> u64 {
        self.guarded(0, || self.caster.bytes())
    }
}

#[cfg(test)]
mod tests;

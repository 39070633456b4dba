//! The camera's record.

use bytemuck::{Pod, Zeroable};

use crate::error::{Error, Result};
use crate::requirements::features::Features;

/// A camera: `origin + x·right + y·up` with x and y in `[-1, 1]`, x to the right, y upwards.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Camera {
    /// Normalised space.
    pub origin: [f32; 3],
    /// One of the constants of this type.
    pub kind: u32,
    /// Unit vector.
    pub forward: [f32; 3],
    /// The media at the origin: bits of a [`crate::MediumStack`]. Set by [`crate::Pipeline`].
    pub media: u32,
    /// Half the width of the picture, to its right edge. Perspective: at distance 1. Orthographic:
    /// normalised space.
    pub right: [f32; 3],
    /// Radius of the thin lens around the origin, perpendicular to `forward`, normalised space; 0: a pinhole.
    /// Perspective only.
    pub lens_radius: f32,
    /// Half the height of the picture, to its upper edge, likewise.
    pub up: [f32; 3],
    /// Distance along `forward` of the plane that is in focus, normalised space, above 0. Without a lens it is not read.
    pub focus_distance: f32,
}

impl Camera {
    /// All rays start at one point, or at the points of a lens.
    pub const PERSPECTIVE: u32 = 0;
    /// Rays are parallel.
    pub const ORTHOGRAPHIC: u32 = 1;

    /// What the camera needs of the kernel that traces camera paths, besides the features of the scene:
    /// [`Features::THIN_LENS`] or nothing.
    #[must_use]
    pub fn features(&self) -> Features {
        let has_lens = self.kind == Self::PERSPECTIVE && self.lens_radius > 0.0;
        if has_lens { Features::THIN_LENS } else { Features::NONE }
    }

    /// Checks the lens.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] for a radius that is negative or not finite, a lens without a positive, finite distance of
    /// the plane in focus, and a lens of an orthographic camera.
    pub fn check(&self) -> Result<()> {
        let wrong = |name, value: f32, hint| Err(Error::InvalidSetting { name, value: value.to_string(), hint });
        let (radius, focus) = (self.lens_radius, self.focus_distance);
        if !(radius >= 0.0 && radius.is_finite()) {
            return wrong("lens_radius", radius, "it must be a finite number, at least 0");
        }
        if radius > 0.0 && self.kind != Self::PERSPECTIVE {
            return wrong("lens_radius", radius, "only perspective cameras have a lens");
        }
        if radius > 0.0 && !(focus > 0.0 && focus.is_finite()) {
            return wrong("focus_distance", focus, "it must be a finite number above 0");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lenses_are_checked() {
        let lens = |lens_radius, focus_distance| Camera { lens_radius, focus_distance, ..Camera::default() };
        for good in [lens(0.0, 0.0), lens(0.0, f32::NAN), lens(0.1, 2.0)] {
            assert!(good.check().is_ok(), "{good:?}");
        }
        let flat = Camera { kind: Camera::ORTHOGRAPHIC, ..lens(0.1, 1.0) };
        let bad = [lens(-0.1, 1.0), lens(f32::NAN, 1.0), lens(f32::INFINITY, 1.0), flat];
        for (bad, name) in bad.map(|bad| (bad, "lens_radius")).into_iter().chain([
            (lens(0.1, 0.0), "focus_distance"),
            (lens(0.1, -1.0), "focus_distance"),
            (lens(0.1, f32::NAN), "focus_distance"),
            (lens(0.1, f32::INFINITY), "focus_distance"),
        ]) {
            let error = bad.check().unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        }
        assert_eq!(lens(0.0, 1.0).features(), Features::NONE);
        assert_eq!(lens(0.1, 1.0).features(), Features::THIN_LENS);
        assert_eq!(flat.features(), Features::NONE);
    }
}

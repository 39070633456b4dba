//! Rays of the camera.

use photon_core::glam::Vec3;
use photon_core::random::unit_f32;
use photon_core::{Camera, Ray, sampling};

/// The ray through a point of the image; both coordinates are in `[-1, 1]`.
pub(super) fn through_pinhole(camera: &Camera, x: f32, y: f32) -> Ray {
    let offset = Vec3::from(camera.right) * x + Vec3::from(camera.up) * y;
    let (origin, forward) = (Vec3::from(camera.origin), Vec3::from(camera.forward));
    let (origin, direction) = if camera.kind == Camera::ORTHOGRAPHIC {
        (origin + offset, forward)
    } else {
        (origin, (forward + offset).normalize_or(forward))
    };
    Ray { origin, direction, t_max: f32::INFINITY }
}

/// The ray through a point of the image and a uniformly distributed point of the lens: all rays through a point of the
/// image meet in the plane that is in focus.
pub(super) fn through_lens(camera: &Camera, x: f32, y: f32, words: [u32; 2]) -> Ray {
    let (right, up) = (Vec3::from(camera.right), Vec3::from(camera.up));
    let (u, v) = sampling::disc(unit_f32(words[0]), unit_f32(words[1]));
    let lens = (right.normalize_or_zero() * u + up.normalize_or_zero() * v) * camera.lens_radius;
    let (origin, forward) = (Vec3::from(camera.origin), Vec3::from(camera.forward));
    let towards = forward + (right * x + up * y) - lens / camera.focus_distance;
    Ray { origin: origin + lens, direction: towards.normalize_or(forward), t_max: f32::INFINITY }
}

//! Conversion of cameras from user space to normalised space.

use crate::describe::{CameraDesc, Projection};
use crate::error::SceneError;
use crate::validate::unit;
use glam::DVec3;
use photon_core::{Camera, Units};

/// The camera in normalised space for a picture of that width and height; `desc` has been validated.
pub(crate) fn resolve(
    name: &str,
    desc: &CameraDesc,
    units: Units,
    width: u32,
    height: u32,
) -> Result<Camera, SceneError> {
    if width == 0 || height == 0 || u64::from(width) * u64::from(height) > u64::from(u32::MAX) {
        return Err(SceneError::PictureSize { width, height });
    }
    let forward = unit(desc.direction);
    let right = forward.cross(unit(desc.up)).normalize_or_zero();
    let up = right.cross(forward);
    let (kind, half_height) = match desc.projection {
        Projection::Perspective { vertical_fov } => (Camera::PERSPECTIVE, libm::tan(0.5 * vertical_fov)),
        Projection::Orthographic { half_height } => (Camera::ORTHOGRAPHIC, half_height / units.scale),
    };
    let half_width = half_height * f64::from(width) / f64::from(height);
    let lens = desc.lens.filter(|lens| lens.diameter > 0.0);
    let (lens_radius, focus_distance) = lens.map_or((0.0, 0.0), |lens| {
        ((0.5 * lens.diameter / units.scale) as f32, (lens.focus_distance / units.scale) as f32)
    });
    let camera = Camera {
        origin: units.point(desc.position),
        kind,
        forward: forward.as_vec3().to_array(),
        right: (right * half_width).as_vec3().to_array(),
        up: (up * half_height).as_vec3().to_array(),
        lens_radius,
        focus_distance,
        ..Camera::default()
    };
    let rows = [camera.origin, camera.right, camera.up];
    if rows.iter().flatten().any(|part| !part.is_finite()) || !(half_height as f32).is_normal() {
        return Err(SceneError::Extreme {
            what: format!("camera '{name}'"),
            value: format!("at {:?} with {:?}", desc.position, desc.projection),
            hint: "move it nearer to the scene and make its view comparable to the scene in size",
        });
    }
    if camera.check_lens().is_err() {
        return Err(SceneError::Extreme {
            what: format!("the lens of camera '{name}'"),
            value: format!("{:?}", desc.lens),
            hint: "make its diameter and its focus distance comparable to the scene in size",
        });
    }
    Ok(camera)
}

/// A camera from +z, y upwards, that shows all of a box, or of a unit box if `bounds` is `None`.
pub(crate) fn framing(bounds: Option<([f64; 3], [f64; 3])>) -> CameraDesc {
    let (low, high) = bounds.unwrap_or(([-0.5; 3], [0.5; 3]));
    let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
    let extent = high - low;
    let center = low + extent * 0.5;
    let size = if extent.max_element() > 0.0 { extent.max_element() } else { 1.0 };
    let vertical_fov = 40_f64.to_radians();
    // In front of the nearest face, at a distance where this face fits with a margin of a tenth.
    let face = if extent.x.max(extent.y) > 0.0 { extent.x.max(extent.y) } else { size };
    let distance = extent.z * 0.5 + 0.55 * face / libm::tan(0.5 * vertical_fov);
    let position = center + DVec3::Z * distance;
    CameraDesc {
        position: position.to_array(),
        direction: [0.0, 0.0, -1.0],
        up: [0.0, 1.0, 0.0],
        projection: Projection::Perspective { vertical_fov },
        lens: None,
    }
}

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
    if camera.check().is_err() {
        return Err(SceneError::Extreme {
            what: format!("the lens of camera '{name}'"),
            value: format!("{:?}", desc.lens),
            hint: "make its diameter and its focus distance comparable to the scene in size",
        });
    }
    Ok(camera)
}

/// A box whose side towards +z is a smaller share of its largest side is framed obliquely: from +z one would see little
/// of it.
const EDGE_ON: f64 = 0.1;

/// A camera, y upwards, that shows all of a box, or of a unit box if `bounds` is `None`. It looks from +z, or, at a box
/// that is nearly flat along x or y, obliquely from above and from the right.
pub(crate) fn framing(bounds: Option<([f64; 3], [f64; 3])>) -> CameraDesc {
    let (low, high) = bounds.unwrap_or(([-0.5; 3], [0.5; 3]));
    let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
    let extent = high - low;
    let center = low + extent * 0.5;
    let size = if extent.max_element() > 0.0 { extent.max_element() } else { 1.0 };
    let vertical_fov = 40_f64.to_radians();
    let slope = libm::tan(0.5 * vertical_fov);
    // Relative to the size, so that products do not overflow.
    let shape = extent / size;
    let largest = (shape.x * shape.y).max(shape.y * shape.z).max(shape.z * shape.x);
    let (direction, up, distance) = if shape.x * shape.y < EDGE_ON * largest {
        // Unit vectors: from (2, 2, 3) towards the centre, and upwards at right angles to it.
        let back = DVec3::new(2.0, 2.0, 3.0) / 17_f64.sqrt();
        let right = DVec3::new(3.0, 0.0, -2.0) / 13_f64.sqrt();
        let up = back.cross(right);
        // Every corner fits with a margin of a tenth.
        let distance = (0..8).fold(0.0, |most: f64, corner| {
            let sign = |axis: u32| if corner >> axis & 1 == 1 { 0.5 } else { -0.5 };
            let at = shape * DVec3::new(sign(0), sign(1), sign(2));
            most.max(1.1 * at.dot(right).abs().max(at.dot(up).abs()) / slope + at.dot(back))
        });
        (-back, up, back * (distance * size))
    } else {
        // In front of the nearest face, at a distance where this face fits with a margin of a tenth.
        let face = if extent.x.max(extent.y) > 0.0 { extent.x.max(extent.y) } else { size };
        (DVec3::NEG_Z, DVec3::Y, DVec3::Z * (extent.z * 0.5 + 0.55 * face / slope))
    };
    CameraDesc {
        position: (center + distance).to_array(),
        direction: direction.to_array(),
        up: up.to_array(),
        projection: Projection::Perspective { vertical_fov },
        lens: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest of the tangents under which corners of a box are seen, and whether all are in front.
    fn widest(low: [f64; 3], high: [f64; 3]) -> (f64, bool) {
        let camera = framing(Some((low, high)));
        let [at, forward, up] = [camera.position, camera.direction, camera.up].map(DVec3::from_array);
        assert!((forward.length() - 1.0).abs() < 1e-12 && (up.length() - 1.0).abs() < 1e-12, "{camera:?}");
        assert!(forward.dot(up).abs() < 1e-12, "{camera:?}");
        let right = forward.cross(up);
        let corners = (0..8).map(|corner| {
            let part = |axis: usize| if corner >> axis & 1 == 1 { high[axis] } else { low[axis] };
            DVec3::new(part(0), part(1), part(2)) - at
        });
        corners.fold((0.0, true), |(most, front), to: DVec3| {
            let depth = to.dot(forward);
            (f64::max(most, to.dot(right).abs().max(to.dot(up).abs()) / depth), front && depth > 0.0)
        })
    }

    #[test]
    fn boxes_of_any_shape_fit_and_are_not_seen_edge_on() {
        let slope = libm::tan(20_f64.to_radians());
        for (high, oblique) in [
            ([1.0, 1.0, 1.0], false),
            ([3.0, 1.0, 0.0], false),
            ([1.0, 0.0, 1.0], true),
            ([4.0, 0.01, 3.0], true),
            ([0.0, 2.0, 2.0], true),
            ([1e-30, 1e-33, 1e-30], true),
            ([1e30, 0.0, 1e30], true),
        ] {
            let (most, front) = widest([0.0; 3], high);
            assert!(front && (most * 1.1 / slope - 1.0).abs() < 1e-9, "{high:?}: {most} of {slope}");
            assert_eq!(framing(Some(([0.0; 3], high))).direction != [0.0, 0.0, -1.0], oblique, "{high:?}");
        }
        // A point and a line are seen from +z.
        for high in [[0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            assert_eq!(framing(Some(([0.0; 3], high))).direction, [0.0, 0.0, -1.0], "{high:?}");
        }
    }
}

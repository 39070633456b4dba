//! Conversion of cameras from user space to normalised space.

use crate::describe::{CameraDesc, Projection};
use crate::error::SceneError;
use crate::mesh::Mesh;
use crate::validate::unit;
use glam::DVec3;
use photon_core::{Camera, Units, parallel};

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

/// A box whose depth along z is a smaller share of its largest extent is a picture or a wall, seen from the front.
const FLAT: f64 = 0.1;

/// A camera that shows all of a box, or of a unit box if `bounds` is `None`: of a room, through its open side; otherwise
/// with y upwards, from the front, +z, if the box is flat along z, or obliquely from above and from the right, since the
/// upward axis of a file is not known.
pub(crate) fn framing(bounds: Option<([f64; 3], [f64; 3])>, room: Option<OpenSide>) -> CameraDesc {
    let (low, high) = bounds.unwrap_or(([-0.5; 3], [0.5; 3]));
    let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
    let extent = high - low;
    let center = low + extent * 0.5;
    let size = if extent.max_element() > 0.0 { extent.max_element() } else { 1.0 };
    let vertical_fov = 40_f64.to_radians();
    let slope = libm::tan(0.5 * vertical_fov);
    // Relative to the size, so that products do not overflow.
    let shape = extent / size;
    let is_flat = shape.z < FLAT && shape.x.min(shape.y) >= FLAT;
    let (direction, up, distance) = if let Some(OpenSide { back, up }) = room.or(is_flat.then_some(OpenSide::FRONT)) {
        // In front of that side, at a distance where it fits with a margin of a tenth.
        let across = (extent - extent * back.abs()).max_element();
        let face = if across > 0.0 { across } else { size };
        (-back, up, back * ((extent * back).length() * 0.5 + 0.55 * face / slope))
    } else {
        // Unit vectors: from (2, 2, 3) towards the centre, and upwards at right angles to it.
        let back = DVec3::new(2.0, 2.0, 3.0) / 17_f64.sqrt();
        let right = DVec3::new(3.0, 0.0, -2.0) / 13_f64.sqrt();
        let up = back.cross(right);
        // Every corner fits with a margin of a tenth; a point is a box of its size.
        let shape = if extent.max_element() > 0.0 { shape } else { DVec3::ONE };
        let distance = (0..8).fold(0.0, |most: f64, corner| {
            let sign = |axis: u32| if corner >> axis & 1 == 1 { 0.5 } else { -0.5 };
            let at = shape * DVec3::new(sign(0), sign(1), sign(2));
            most.max(1.1 * at.dot(right).abs().max(at.dot(up).abs()) / slope + at.dot(back))
        });
        (-back, up, back * (distance * size))
    };
    CameraDesc {
        position: (center + distance).to_array(),
        direction: direction.to_array(),
        up: up.to_array(),
        projection: Projection::Perspective { vertical_fov },
        lens: None,
    }
}

/// The side of a room through which it is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OpenSide {
    /// Unit vector from the room to the camera.
    back: DVec3,
    /// Upwards in the picture.
    up: DVec3,
}

impl OpenSide {
    const FRONT: Self = Self { back: DVec3::Z, up: DVec3::Y };

    /// The side that the areas of all surfaces face on balance, relative to those of the sides of the box; the front if
    /// none is faced by half a side. Closed solids face all sides equally.
    fn of(faced: DVec3) -> Self {
        let sizes = faced.abs();
        if sizes.max_element() < 0.5 || sizes.z == sizes.max_element() {
            return Self { back: if faced.z <= -0.5 { DVec3::NEG_Z } else { DVec3::Z }, up: DVec3::Y };
        }
        if sizes.x > sizes.y {
            return Self { back: DVec3::X * faced.x.signum(), up: DVec3::Y };
        }
        // Into a room without a ceiling; or from the front of one whose upward axis is z.
        Self { back: DVec3::Y * faced.y.signum(), up: if faced.y > 0.0 { DVec3::NEG_Z } else { DVec3::Z } }
    }
}

/// The open side of a room, `None` for other scenes. The surfaces of a room face its inside: the flux of the vector from the
/// centre of its box through them is less than that through four of the six sides of a box that faces inwards. An open box
/// with things in it is a room, a floor with things on it is none.
pub(crate) fn open_side<'a>(
    meshes: impl Iterator<Item = &'a Mesh>,
    (low, high): ([f64; 3], [f64; 3]),
) -> Option<OpenSide> {
    let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
    let extent = high - low;
    // Relative to the extents: a box that faces inwards has a flux of −6, each of its sides −1 and an area of 1.
    let at = |position: [f64; 3]| (DVec3::from_array(position) - low) / extent - 0.5;
    let sum = |(flux, faced): (f64, DVec3), (more, other): (f64, DVec3)| (flux + more, faced + other);
    let (mut flux, mut faced) = (0.0, DVec3::ZERO);
    for mesh in meshes {
        let corner = |index: u32| mesh.positions.get(index as usize).map(|&position| at(position));
        // Of parts that do not depend on the number of threads.
        let parts = parallel::map(parallel::threads(), mesh.triangles.chunks(1 << 16), |_, triangles| {
            let seen = triangles.iter().filter_map(|triangle| match triangle.map(corner) {
                [Some(a), Some(b), Some(c)] => {
                    let doubled = (b - a).cross(c - a);
                    Some((a.dot(doubled), 0.5 * doubled))
                }
                _ => None,
            });
            seen.fold((0.0, DVec3::ZERO), sum)
        });
        (flux, faced) = parts.into_iter().fold((flux, faced), sum);
    }
    // NaN, of a box without a volume, is none.
    (flux < -3.5).then(|| OpenSide::of(faced))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest of the tangents under which corners of a box are seen, and whether all are in front.
    fn widest(low: [f64; 3], high: [f64; 3]) -> (f64, bool) {
        let camera = framing(Some((low, high)), None);
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
    fn boxes_of_any_shape_fit_and_only_those_flat_along_z_are_seen_from_the_front() {
        let slope = libm::tan(20_f64.to_radians());
        for (high, oblique) in [
            ([1.0, 1.0, 1.0], true),
            ([3.0, 1.0, 0.0], false),
            ([1.0, 0.0, 1.0], true),
            ([4.0, 0.01, 3.0], true),
            ([0.0, 2.0, 2.0], true),
            ([0.0, 1.0, 0.0], true),
            ([1e-30, 1e-33, 1e-30], true),
            ([1e30, 0.0, 1e30], true),
        ] {
            let (most, front) = widest([0.0; 3], high);
            assert!(front && (most * 1.1 / slope - 1.0).abs() < 1e-9, "{high:?}: {most} of {slope}");
            let camera = framing(Some(([0.0; 3], high)), None);
            assert_eq!(camera.direction != [0.0, 0.0, -1.0], oblique, "{high:?}");
            assert!(!oblique || camera.position[1] > high[1], "from above");
            let room = framing(Some(([0.0; 3], high)), Some(OpenSide::FRONT));
            assert_eq!(room.direction, [0.0, 0.0, -1.0], "a room: {high:?}");
        }
        assert!(framing(None, None).position.iter().all(|part| part.is_finite()));
        assert!(framing(Some(([2.0; 3], [2.0; 3])), None).position[1] > 2.0, "a point");
    }

    #[test]
    fn open_boxes_that_face_inwards_are_rooms_and_seen_through_the_open_side() {
        // Sides of a box of 2 × 1 × 3, facing inwards: floor, ceiling, left, right, back, front.
        let sides: [[[f64; 3]; 4]; 6] = [
            [[0., 0., 3.], [2., 0., 3.], [2., 0., 0.], [0., 0., 0.]],
            [[0., 1., 0.], [2., 1., 0.], [2., 1., 3.], [0., 1., 3.]],
            [[0., 0., 3.], [0., 0., 0.], [0., 1., 0.], [0., 1., 3.]],
            [[2., 0., 0.], [2., 0., 3.], [2., 1., 3.], [2., 1., 0.]],
            [[0., 0., 0.], [2., 0., 0.], [2., 1., 0.], [0., 1., 0.]],
            [[2., 0., 3.], [0., 0., 3.], [0., 1., 3.], [2., 1., 3.]],
        ];
        let room = |sides: &[[[f64; 3]; 4]], turned: bool| {
            let mut builder = crate::SceneBuilder::new();
            let grey = builder.material(crate::MaterialDesc::lambert("grey", [0.5; 3]));
            for side in sides {
                let mut side = *side;
                if turned {
                    side.reverse();
                }
                builder.quad("side", side, grey);
            }
            open_side(builder.meshes.iter(), ([0.0; 3], [2.0, 1.0, 3.0]))
        };
        assert_eq!(
            [1, 3, 4, 5, 6].map(|count| room(&sides[..count], false).is_some()),
            [false, false, true, true, true]
        );
        assert_eq!(room(&sides, true), None, "a box is none");
        assert_eq!(open_side(std::iter::empty(), ([0.0; 3], [0.0; 3])), None);
        // The camera is where a side is missing; of a closed room, at the front.
        assert_eq!(room(&sides, false), Some(OpenSide::FRONT));
        let outwards = [DVec3::NEG_Y, DVec3::Y, DVec3::NEG_X, DVec3::X, DVec3::NEG_Z, DVec3::Z];
        for (missing, outwards) in outwards.into_iter().enumerate() {
            let others: Vec<_> = (0..6).filter(|&side| side != missing).map(|side| sides[side]).collect();
            let open = room(&others, false).expect("five sides are a room");
            assert_eq!((open.back, open.up.dot(open.back)), (outwards, 0.0));
            let camera = framing(Some(([0.0; 3], [2.0, 1.0, 3.0])), Some(open));
            let beyond = (DVec3::from_array(camera.position) - DVec3::new(1.0, 0.5, 1.5)).dot(outwards);
            let [across, deep] = [[3.0, 0.5], [3.0, 0.5], [3.0, 1.0], [3.0, 1.0], [2.0, 1.5], [2.0, 1.5]][missing];
            let expected = deep + 0.55 * across / libm::tan(20_f64.to_radians());
            assert!((beyond - expected).abs() < 1e-12, "{missing}: {beyond}, not {expected}");
        }
    }
}

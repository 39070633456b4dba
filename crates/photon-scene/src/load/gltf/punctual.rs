//! Lights of `KHR_lights_punctual` and cameras: what a node may have besides a mesh.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DMat4, DVec3};
use gltf::json::Root;
use gltf::json::camera::Type as CameraType;
use gltf::json::extensions::scene::khr_lights_punctual::{Light, Type};
use gltf::json::validation::Checked;

use super::fault::{AGAIN, Fault, label, name_or_number};
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, LightDesc, Projection};
use crate::extras::{Agrees, CHANGED, CameraExtras, LightExtras};
use crate::report::LoadReport;

/// Adds the light of `node`. It shines along −Z; scaling does not change its intensity.
pub(super) fn add_light(
    root: &Root,
    node: &str,
    (light, exact): (usize, Option<LightExtras>),
    transform: &DMat4,
    builder: &mut SceneBuilder,
    report: &mut LoadReport,
) -> Result<(), Fault> {
    let lights: &[Light] = root.as_ref();
    let found = lights.get(light).ok_or_else(|| Fault::dangling(node, "light", light, lights.len()))?;
    let part = label("light", light, found.name.as_deref());
    let Checked::Valid(kind) = found.type_ else {
        return Err(Fault::new(part, "is of an unknown type", "make it point, spot or directional"));
    };
    // Candela are W/sr here, and lux are W/m²: radiometric, without the 683 lumens of a watt.
    let strength = found.color.map(|color| f64::from(color) * f64::from(found.intensity));
    let position = transform.w_axis.truncate().to_array();
    let desc = match kind {
        Type::Point => LightDesc::Point { position, intensity: strength },
        Type::Directional => {
            LightDesc::Directional { direction: axis(transform, DVec3::NEG_Z, node)?, irradiance: strength }
        }
        Type::Spot => {
            if found.spot.is_none() {
                report.approximated(&part, "has no cone; one of 45 degrees is assumed");
            }
            let spot = found.spot.as_ref();
            let (inner_angle, outer_angle) = spot
                .map_or((0.0, FRAC_PI_4), |spot| (f64::from(spot.inner_cone_angle), half_turn(spot.outer_cone_angle)));
            let direction = axis(transform, DVec3::NEG_Z, node)?;
            LightDesc::Spot { position, direction, intensity: strength, inner_angle, outer_angle }
        }
    };
    if found.range.is_some() && kind != Type::Directional {
        report.left_out(&part, "its range; light falls off with the squared distance only");
    }
    let exact = exact.map(LightExtras::desc);
    builder.light(name_or_number("light", light, found.name.as_deref()), refined(desc, exact, node, report));
    Ok(())
}

/// π/2 rounded to f32 is above π/2; interprets it as π/2.
fn half_turn(angle: f32) -> f64 {
    if angle == std::f32::consts::FRAC_PI_2 { FRAC_PI_2 } else { f64::from(angle) }
}

/// Adds the camera of `node`. It looks along −Z, up is +Y; scaling does not change its picture.
pub(super) fn add_camera(
    root: &Root,
    node: &str,
    (camera, exact): (usize, Option<CameraExtras>),
    transform: &DMat4,
    names: &mut Vec<String>,
    builder: &mut SceneBuilder,
    report: &mut LoadReport,
) -> Result<(), Fault> {
    let cameras = &root.cameras;
    let found = cameras.get(camera).ok_or_else(|| Fault::dangling(node, "camera", camera, cameras.len()))?;
    let projection = match (found.type_, &found.perspective, &found.orthographic) {
        (Checked::Valid(CameraType::Perspective), Some(perspective), _) => {
            Projection::Perspective { vertical_fov: f64::from(perspective.yfov) }
        }
        (Checked::Valid(CameraType::Orthographic), _, Some(orthographic)) => {
            Projection::Orthographic { half_height: f64::from(orthographic.ymag) }
        }
        _ => {
            return Err(Fault::new(
                label("camera", camera, found.name.as_deref()),
                "is neither perspective nor orthographic, or lacks the numbers for it",
                AGAIN,
            ));
        }
    };
    let desc = CameraDesc {
        position: transform.w_axis.truncate().to_array(),
        direction: axis(transform, DVec3::NEG_Z, node)?,
        up: axis(transform, DVec3::Y, node)?,
        projection,
        lens: None,
    };
    let desc = refined(desc, exact.and_then(CameraExtras::desc), node, report);
    // Two nodes may refer to the same camera, and two cameras may have the same name.
    let name = name_or_number("camera", camera, found.name.as_deref());
    let name = if names.contains(&name) { format!("{name} at {node}") } else { name };
    names.push(name.clone());
    // Pictures have a size of their own; the height of the view is kept.
    let wide = match (&found.perspective, &found.orthographic) {
        (Some(perspective), _) => perspective.aspect_ratio,
        (_, Some(orthographic)) => Some(orthographic.xmag / orthographic.ymag).filter(|wide| *wide != 1.0),
        _ => None,
    };
    if let Some(wide) = wide.map(f32::abs).filter(|wide| wide.is_finite() && *wide > 0.0) {
        let subject = format!("camera '{name}'");
        report.note(subject, format!("is made for pictures whose width is {wide:.3} times their height"));
    }
    builder.camera(name, desc);
    Ok(())
}

/// The values of the extras, unless they contradict the standard glTF content.
fn refined<T: Agrees>(desc: T, exact: Option<T>, node: &str, report: &mut LoadReport) -> T {
    match exact {
        Some(exact) if desc.agrees(&exact) => exact,
        Some(_) => {
            report.note(node, CHANGED);
            desc
        }
        None => desc,
    }
}

/// Transforms a direction of the node's own space to that of the scene.
fn axis(transform: &DMat4, own: DVec3, node: &str) -> Result<[f64; 3], Fault> {
    transform.transform_vector3(own).try_normalize().map(DVec3::into).ok_or_else(|| {
        Fault::new(
            node,
            "is scaled to zero, so that its light or camera points nowhere",
            "give it and its parents a scale other than 0",
        )
    })
}

//! Validation of scene descriptions before any computation.

mod textures;

use crate::builder::SceneBuilder;
use crate::describe::{AlphaMode, AmbientMedium, CameraDesc, LightDesc, MaterialDesc, Projection, Surface, ThinLens};
use crate::environment::Sun;
use crate::error::SceneError;
use crate::mesh::Mesh;
use crate::parameter::{self, Layer, Range, Value};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

/// A property, its value and its hint, to which the caller adds the name of the object.
type Fault = (&'static str, String, &'static str);

/// Checks materials, meshes, lights and cameras, in that order.
pub(crate) fn check(scene: &SceneBuilder) -> Result<(), SceneError> {
    for desc in &scene.materials {
        material(desc).map_err(|(property, value, hint)| SceneError::Material {
            material: desc.name.clone(),
            property,
            value,
            hint,
        })?;
    }
    textures::check(scene)?;
    for desc in &scene.meshes {
        mesh(desc, scene.materials.len())?;
        textures::check_mesh(desc, &scene.materials[desc.material.0 as usize])?;
    }
    for (name, desc) in &scene.lights {
        light(desc).map_err(|(property, value, hint)| SceneError::Light {
            light: name.clone(),
            property,
            value,
            hint,
        })?;
    }
    if let Some(medium) = &scene.medium {
        ambient(medium).map_err(|(property, value, hint)| SceneError::Medium { property, value, hint })?;
    }
    if let Some(sun) = &scene.sun {
        disc(sun).map_err(|(property, value, hint)| SceneError::Light {
            light: "sun".to_owned(),
            property,
            value,
            hint,
        })?;
    }
    for (name, desc) in &scene.cameras {
        named_camera(name, desc)?;
    }
    Ok(())
}

fn material(desc: &MaterialDesc) -> Result<(), Fault> {
    // Before the refractive index, which a formula may give.
    if let Some(dispersion) = desc.dispersion {
        let ior = desc.ior().filter(|_| desc.is_solid());
        let hint = "only solids disperse light: make it glass with a closed mesh, or leave the dispersion out";
        let fault = ior.map_or_else(|| Some((format!("{dispersion:?}"), hint)), |ior| dispersion.fault(ior));
        if let Some((value, hint)) = fault {
            return Err((dispersion.name(), value, hint));
        }
    }
    match desc.surface {
        Surface::Lambert { albedo } => fractions("albedo", albedo)?,
        Surface::Mirror { reflectance } => fractions("reflectance", reflectance)?,
        Surface::Dielectric { ior, absorption, tint, roughness } => {
            require((0.0..=1.0).contains(&roughness), "roughness", roughness, "it must lie between 0 and 1")?;
            refractive(ior)?;
            not_negative("absorption", absorption)?;
            fractions("tint", tint)?;
        }
        Surface::Boundary { absorption } => {
            not_negative("absorption", absorption)?;
            let hint = "a boundary changes the medium, and nothing else: leave it out";
            require(!desc.is_emissive(), "emission", desc.emission, hint)?;
            require(desc.alpha_mode == AlphaMode::Opaque, "the alpha mode", desc.alpha_mode, hint)?;
        }
        Surface::Thin { ior, tint, roughness } => {
            require((0.0..=1.0).contains(&roughness), "roughness", roughness, "it must lie between 0 and 1")?;
            refractive(ior)?;
            fractions("tint", tint)?;
        }
        Surface::Glossy { base_color, metallic, roughness, specular, ior } => {
            fractions("base_color", base_color)?;
            for (name, share) in [("metallic", metallic), ("roughness", roughness), ("specular", specular)] {
                require((0.0..=1.0).contains(&share), name, share, "it must lie between 0 and 1")?;
            }
            require(
                (ior as f32).is_finite() && ior >= 0.0,
                "ior",
                ior,
                "the refractive index of a coat must be finite and at least 0, such as 1.5",
            )?;
        }
    }
    for (_, layer, value) in parameter::layers(desc) {
        within(layer, value)?;
    }
    desc.phase.fault().map_or(Ok(()), Err)?;
    if desc.scattering != [0.0; 3] && !matches!(desc.surface, Surface::Dielectric { .. } | Surface::Boundary { .. }) {
        let hint = "light is scattered inside solid glass alone: make it glass or a boundary, or leave scattering out";
        return Err(("scattering", format!("{:?}", desc.scattering), hint));
    }
    if let Some(grid) = &desc.grid {
        if !matches!(desc.surface, Surface::Dielectric { .. } | Surface::Boundary { .. }) {
            let hint = "densities fill solid glass alone: make it glass or a boundary, or leave the grid out";
            return Err(("grid", format!("one of {:?} cells", grid.cells), hint));
        }
        grid.fault().map_or(Ok(()), Err)?;
    }
    not_negative("emission", desc.emission)?;
    let narrow = desc.specular_color.iter().all(|part| (*part as f32).is_finite());
    require(narrow, "specular_color", desc.specular_color, "each channel must be finite in single precision")?;
    require((0.0..=1.0).contains(&desc.alpha), "alpha", desc.alpha, "it must lie between 0 and 1")?;
    if let AlphaMode::Mask { cutoff } = desc.alpha_mode {
        let fine = cutoff >= 0.0 && (cutoff as f32).is_finite();
        require(fine, "the alpha cutoff", cutoff, "it must be a finite number, at least 0")?;
    }
    if desc.transmission > 0.0 {
        let Surface::Glossy { ior, .. } = desc.surface else {
            let hint = "only a glossy surface can be partly glass: make it glossy, or leave the share out";
            return Err(("transmission", desc.transmission.to_string(), hint));
        };
        refractive(ior)?;
        not_negative("transmission_absorption", desc.transmission_absorption.unwrap_or([0.0; 3]))?;
    }
    require(
        !desc.is_solid() || desc.alpha_mode == AlphaMode::Opaque,
        "the alpha mode",
        desc.alpha_mode,
        "the boundary of a solid must be closed; make it opaque, or a thin sheet",
    )
}

/// Checks the range of a parameter.
fn within(Layer { field, range, .. }: Layer, value: Value) -> Result<(), Fault> {
    match (range, value) {
        (Range::Share, Value::Number(share)) => {
            require((0.0..=1.0).contains(&share), field, share, "it must lie between 0 and 1")
        }
        (Range::Share, Value::Color(color)) => fractions(field, color),
        (Range::NotNegative, value) => {
            let fine = value.numbers().iter().all(|part| part.is_finite() && *part >= 0.0);
            require(fine, field, value, "each channel must be a finite number, at least 0")
        }
        (Range::Finite, value) => {
            let fine = value.numbers().iter().all(|part| part.is_finite());
            require(fine, field, value, "it must be a finite number")
        }
    }
}

fn ambient(medium: &AmbientMedium) -> Result<(), Fault> {
    not_negative("scattering", medium.scattering)?;
    not_negative("absorption", medium.absorption)?;
    if let Some(corners @ [low, high]) = medium.bounds {
        let is_box = (0..3).all(|axis| low[axis] < high[axis] && low[axis].is_finite() && high[axis].is_finite());
        require(
            is_box,
            "box",
            corners,
            "it must have two corners of finite numbers, the first below the second in all three",
        )?;
    }
    medium.phase.fault().map_or(Ok(()), Err)
}

fn refractive(ior: f64) -> Result<(), Fault> {
    // As f32, since rays are traced with that precision.
    let narrow = ior as f32;
    require(
        narrow.is_normal() && narrow > 0.0,
        "ior",
        ior,
        "a refractive index must be a finite number above 0, such as 1.5",
    )
}

fn fractions(property: &'static str, colour: [f64; 3]) -> Result<(), Fault> {
    let fine = colour.iter().all(|part| (0.0..=1.0).contains(part));
    require(fine, property, colour, "each channel must lie between 0 and 1")
}

fn not_negative(property: &'static str, colour: [f64; 3]) -> Result<(), Fault> {
    let fine = colour.iter().all(|part| part.is_finite() && *part >= 0.0);
    require(fine, property, colour, "each channel must be a finite number, at least 0")
}

fn finite(property: &'static str, point: [f64; 3]) -> Result<(), Fault> {
    require(point.iter().all(|part| part.is_finite()), property, point, "each coordinate must be a finite number")
}

fn heading(property: &'static str, direction: [f64; 3]) -> Result<(), Fault> {
    finite(property, direction)?;
    require(direction != [0.0; 3], property, direction, "it must not be zero")
}

fn require(fine: bool, property: &'static str, value: impl fmt::Debug, hint: &'static str) -> Result<(), Fault> {
    if fine { Ok(()) } else { Err((property, format!("{value:?}"), hint)) }
}

fn mesh(mesh: &Mesh, materials: usize) -> Result<(), SceneError> {
    if mesh.material.0 as usize >= materials {
        return Err(SceneError::MaterialId { mesh: mesh.name.to_string(), material: mesh.material.0, materials });
    }
    let vertices = mesh.positions.len();
    // Vertices that no triangle uses may be anything: scanners write NaN for points that they did not measure.
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        for &index in corners {
            let name = || mesh.name.to_string();
            let Some(position) = mesh.positions.get(index as usize) else {
                return Err(SceneError::Index { mesh: name(), triangle, index, vertices });
            };
            if position.iter().any(|part| !part.is_finite()) {
                let (vertex, value) = (index as usize, format!("{position:?}"));
                return Err(SceneError::Vertex { mesh: name(), vertex, value });
            }
        }
    }
    Ok(())
}

/// An angle in radians, which override files have in degrees.
struct Angle(f64);

impl fmt::Debug for Angle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Without the rounding of the conversion.
        let degrees = (self.0.to_degrees() * 1e6).round() / 1e6;
        write!(f, "{degrees} degrees ({:?} radians)", self.0)
    }
}

fn light(desc: &LightDesc) -> Result<(), Fault> {
    match *desc {
        LightDesc::Point { position, intensity } => {
            finite("position", position)?;
            not_negative("intensity", intensity)
        }
        LightDesc::Spot { position, direction, intensity, inner_angle, outer_angle } => {
            finite("position", position)?;
            heading("direction", direction)?;
            not_negative("intensity", intensity)?;
            require(
                // Below this, rounding directions to f32 would blur the cone by more than a hundredth.
                (1e-5..=FRAC_PI_2).contains(&outer_angle),
                "the outer angle",
                Angle(outer_angle),
                "it must lie between 0.001 and 90 degrees",
            )?;
            require(
                inner_angle >= 0.0 && inner_angle <= outer_angle,
                "the inner angle",
                Angle(inner_angle),
                "it must lie between 0 and the outer angle",
            )
        }
        LightDesc::Directional { direction, irradiance } => {
            heading("direction", direction)?;
            not_negative("irradiance", irradiance)
        }
    }
}

fn disc(sun: &Sun) -> Result<(), Fault> {
    heading("direction", sun.direction)?;
    not_negative("irradiance", sun.irradiance)?;
    require(
        // Narrower ones would be blurred by rounding of directions to f32.
        (0.001..=60.0).contains(&sun.radius_degrees),
        "the radius",
        sun.radius_degrees,
        "it must lie between 0.001 and 60 degrees; a directional light has none",
    )
}

/// Checks a camera; `name` is named in errors.
pub(crate) fn named_camera(name: &str, desc: &CameraDesc) -> Result<(), SceneError> {
    camera(desc).map_err(|(property, value, hint)| SceneError::Camera {
        camera: name.to_owned(),
        property,
        value,
        hint,
    })
}

fn camera(desc: &CameraDesc) -> Result<(), Fault> {
    finite("position", desc.position)?;
    heading("direction", desc.direction)?;
    heading("up", desc.up)?;
    let sine = unit(desc.direction).cross(unit(desc.up)).length();
    // Below this, rounding would determine the roll of the picture.
    require(sine > 1e-9, "up", desc.up, "it must not be parallel to the direction of view")?;
    if let Some(ThinLens { diameter, focus_distance }) = desc.lens {
        let is_length = diameter >= 0.0 && diameter.is_finite();
        require(is_length, "the diameter of its lens", diameter, "it must be a finite number, at least 0")?;
        let is_length = focus_distance > 0.0 && focus_distance.is_finite();
        require(is_length, "the distance of its focus", focus_distance, "it must be a finite number above 0")?;
        let suits = diameter == 0.0 || matches!(desc.projection, Projection::Perspective { .. });
        require(suits, "the diameter of its lens", diameter, "an orthographic camera has no lens: leave it out")?;
    }
    match desc.projection {
        Projection::Perspective { vertical_fov } => require(
            vertical_fov > 0.0 && vertical_fov < PI && (vertical_fov as f32).is_normal(),
            "the vertical field of view",
            Angle(vertical_fov),
            "it must lie between 0 and 180 degrees, both excluded",
        ),
        Projection::Orthographic { half_height } => require(
            half_height.is_finite() && half_height > 0.0,
            "half the height",
            half_height,
            "it must be a finite number above 0",
        ),
    }
}

/// Normalises a vector that is finite and not zero, however long.
pub(crate) fn unit(vector: [f64; 3]) -> DVec3 {
    let vector = DVec3::from_array(vector);
    // The square of an extreme component could overflow or underflow, that of its quotient by the largest one
    // does not.
    (vector / vector.abs().max_element()).normalize_or_zero()
}

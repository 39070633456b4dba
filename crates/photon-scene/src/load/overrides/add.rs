//! What override files add to a scene: quadrilaterals, lights, cameras, an environment.

use super::super::schema::{Camera, Environment, Light, Quad};
use super::Overrides;
use super::frame::Frame;
use crate::builder::{MaterialId, SceneBuilder};
use crate::describe::{CameraDesc, LightDesc, MaterialDesc, Projection, ThinLens};
use crate::environment::EnvironmentDesc;
use crate::error::SceneError;
use crate::load::budget::Budget;
use crate::load::gltf::leaves_folder;
use crate::report::LoadReport;
use std::path::Path;

impl Overrides {
    pub(super) fn quad(
        &self,
        index: usize,
        quad: &Quad,
        frame: Frame,
        scene: &mut SceneBuilder,
    ) -> Result<(), SceneError> {
        let name = quad.name.clone().unwrap_or_else(|| format!("override quad {index}"));
        let Some(material) = scene.materials.iter().position(|material| material.name == quad.material) else {
            let what = format!("quad '{name}' uses material '{}', which does not exist", quad.material);
            return Err(self.unknown(&quad.material, &what, scene));
        };
        let corners = frame.corners(quad.relative, quad.corner, quad.edges);
        scene.quad(name, corners, MaterialId(material as u32));
        Ok(())
    }

    pub(super) fn environment(
        &self,
        with: &Environment,
        report: &mut LoadReport,
        budget: &Budget,
    ) -> Result<Option<EnvironmentDesc>, SceneError> {
        let desc = match (&with.file, with.radiance, with.sky) {
            (Some(file), None, None) => {
                // As the images of scene files: what a stranger's file names is in its folder.
                if leaves_folder(&file.to_string_lossy()) {
                    let file = file.display();
                    let what = format!("[environment] has the file {file}, outside the folder of the override file");
                    return Err(self.fault(what, "put it into that folder or below it, or give it with --environment"));
                }
                let folder = self.path.parent().unwrap_or(Path::new(""));
                EnvironmentDesc::read_within(&folder.join(file), report, budget)?
            }
            (None, Some(radiance), None) => EnvironmentDesc::constant(radiance.rgb()),
            (None, None, Some(sky)) => EnvironmentDesc::sky(sky.elevation, sky.turbidity),
            // Portals of an environment that is given elsewhere, as on the command line, or of directional lights.
            (None, None, None) if !(with.portals.is_empty() && with.portal.is_empty()) => {
                if (with.rotate_degrees, with.scale) != (0.0, 1.0) {
                    let what = "[environment] has rotate_degrees or scale, but no light".to_owned();
                    return Err(self.fault(what, "give it file, radiance or sky"));
                }
                return Ok(None);
            }
            (None, None, None) => {
                return Err(self.fault("[environment] has no light".to_owned(), "give it file, radiance or sky"));
            }
            _ => {
                let what = "[environment] has more than one of file, radiance and sky".to_owned();
                return Err(self.fault(what, "give one of them"));
            }
        };
        Ok(Some(desc.rotated(with.rotate_degrees).scaled(with.scale)))
    }

    pub(super) fn portals(&self, with: &Environment, frame: Frame, scene: &mut SceneBuilder) -> Result<(), SceneError> {
        for name in &with.portals {
            scene.portal_named(name);
        }
        for (index, portal) in with.portal.iter().enumerate() {
            let name = portal.name.clone().unwrap_or_else(|| format!("override portal {index}"));
            let corners: Vec<_> = portal.corners.iter().map(|&at| frame.place(portal.relative, at)).collect();
            let triangles = match *corners {
                [a, b, c] => vec![[a, b, c]],
                [a, b, c, d] => vec![[a, b, c], [a, c, d]],
                _ => {
                    let what = format!("portal '{name}' has {} corners", corners.len());
                    return Err(self.fault(what, "give three, or four in order around it"));
                }
            };
            scene.portal(name, triangles);
        }
        Ok(())
    }

    pub(super) fn camera(&self, camera: &Camera, frame: Frame) -> Result<CameraDesc, SceneError> {
        let projection = match (camera.fov_degrees, camera.half_height) {
            (Some(degrees), None) => Projection::Perspective { vertical_fov: degrees.to_radians() },
            (None, Some(half_height)) => {
                let size = if camera.relative { frame.size } else { 1.0 };
                Projection::Orthographic { half_height: half_height * size }
            }
            (given, _) => {
                let count = if given.is_some() { "both" } else { "neither" };
                let what = format!("camera '{}' has {count} of the keys fov_degrees and half_height", camera.name);
                return Err(self.fault(what, "give one: fov_degrees for perspective, half_height for orthographic"));
            }
        };
        let unit = if camera.relative { frame.size } else { 1.0 };
        let lens = match (camera.aperture, camera.focus) {
            (None, None) => None,
            (Some(diameter), Some(distance)) => {
                Some(ThinLens { diameter: diameter * unit, focus_distance: distance * unit })
            }
            (aperture, _) => {
                let (has, lacks) = if aperture.is_some() { ("aperture", "focus") } else { ("focus", "aperture") };
                let what = format!("camera '{}' has the key {has}, but not {lacks}", camera.name);
                return Err(self.fault(what, "give both, or none for a camera without a lens"));
            }
        };
        let from = frame.place(camera.relative, camera.from);
        let to = frame.place(camera.relative, camera.to);
        Ok(CameraDesc { projection, lens, ..CameraDesc::look_at(from, to, camera.up, 1.0) })
    }
}

pub(super) fn add_light(index: usize, light: &Light, frame: Frame, scene: &mut SceneBuilder) {
    let called = |name: &Option<String>| name.clone().unwrap_or_else(|| format!("override light {index}"));
    match light {
        Light::Point { name, relative, position, intensity } => {
            let position = frame.place(*relative, *position);
            scene.light(called(name), LightDesc::Point { position, intensity: intensity.rgb() });
        }
        Light::Spot { name, relative, position, direction, intensity, inner_degrees, outer_degrees } => {
            let light = LightDesc::Spot {
                position: frame.place(*relative, *position),
                direction: *direction,
                intensity: intensity.rgb(),
                inner_angle: inner_degrees.to_radians(),
                outer_angle: outer_degrees.to_radians(),
            };
            scene.light(called(name), light);
        }
        Light::Directional { name, direction, irradiance } => {
            scene.light(called(name), LightDesc::Directional { direction: *direction, irradiance: irradiance.rgb() });
        }
        Light::Quad { name, relative, corner, edges, radiance, emits_both_sides } => {
            let name = called(name);
            let mut area_light = MaterialDesc::emissive(&name, [0.0; 3], radiance.rgb());
            area_light.emits_both_sides = *emits_both_sides;
            let area_light = scene.material(area_light);
            scene.quad(name, frame.corners(*relative, *corner, *edges), area_light);
        }
    }
}

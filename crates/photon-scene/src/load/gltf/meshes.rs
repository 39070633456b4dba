//! Meshes: each node that refers to one adds an instance, transformed by the node.

use glam::{DMat4, DVec3};
use gltf::json::Root;

use super::accessor::Accessors;
use super::fault::{Fault, label, name_or_number};
use super::{attributes, primitive};
use crate::builder::{MaterialId, SceneBuilder};
use crate::load::default_material;
use crate::report::LoadReport;

/// More vertex positions and indices than this, over all instances, are treated as damage: a few
/// nodes that share a mesh could otherwise request all available memory.
const MAX_ELEMENTS: u64 = 1 << 28;

/// Counts for the report on all meshes together.
#[derive(Default)]
pub(super) struct Census {
    elements: u64,
    morphed: u64,
    without_material: u64,
}

/// Adds the mesh of a node, one mesh of the builder for each primitive.
pub(super) struct Meshes<'a> {
    pub(super) root: &'a Root,
    pub(super) accessors: Accessors<'a>,
    pub(super) materials: Vec<MaterialId>,
    pub(super) default_material: Option<MaterialId>,
    pub(super) census: Census,
}

impl Meshes<'_> {
    pub(super) fn add(
        &mut self,
        node: usize,
        mesh: usize,
        transform: &DMat4,
        builder: &mut SceneBuilder,
        report: &mut LoadReport,
    ) -> Result<(), Fault> {
        let meshes = &self.root.meshes;
        let node_name = self.root.nodes[node].name.as_deref();
        let found = meshes
            .get(mesh)
            .ok_or_else(|| Fault::dangling(&label("node", node, node_name), "mesh", mesh, meshes.len()))?;
        let mesh_name = found.name.as_deref().filter(|name| !name.is_empty());
        let name = match node_name.filter(|name| !name.is_empty()).or(mesh_name) {
            Some(name) => name.to_owned(),
            None => name_or_number("mesh", mesh, None),
        };
        // Some programs hide nodes by scaling them to zero.
        if [transform.x_axis, transform.y_axis, transform.z_axis].iter().all(|x| x.truncate() == DVec3::ZERO) {
            report.note(format!("mesh '{name}'"), "is scaled to zero, and so not rendered");
            return Ok(());
        }
        for (number, source) in found.primitives.iter().enumerate() {
            let part = format!("{} primitive {number}", label("mesh", mesh, mesh_name));
            if !primitive::is_surface(source, &part)? {
                report.left_out(part, "consists of points or lines, which have no surface");
                continue;
            }
            self.census.elements =
                self.census.elements.saturating_add(primitive::size(&self.accessors, source, &part)?);
            if self.census.elements > MAX_ELEMENTS {
                return Err(Fault::new(
                    part,
                    format!("brings the scene to over {MAX_ELEMENTS} vertices and indices"),
                    "leave out instances, or use coarser meshes",
                ));
            }
            let material = match source.material {
                None => self.default_material(builder),
                Some(material) => *self
                    .materials
                    .get(material.value())
                    .ok_or_else(|| Fault::dangling(&part, "material", material.value(), self.materials.len()))?,
            };
            let read = primitive::read(&self.accessors, source, &part, report)?;
            if read.stray > 0 {
                let text = format!("{} vertices at its end make no whole triangle", read.stray);
                report.left_out(&part, text);
            }
            self.census.morphed += u64::from(source.targets.iter().flatten().next().is_some());

            let desc = &builder.materials[material.0 as usize];
            let mut attributes =
                attributes::read(&self.accessors, source, desc, (read.positions.len(), &read.extras), &part, report)?;
            let mut triangles = read.triangles;
            let is_mirrored = is_mirrored(transform);
            if is_mirrored {
                // A mirrored mesh keeps its front side (glTF 2.0 specification, section 3.7.4).
                triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            }
            let mut positions = read.positions;
            if *transform != DMat4::IDENTITY {
                positions.iter_mut().for_each(|at| *at = transform.transform_point3(DVec3::from(*at)).to_array());
                attributes::transform(&mut attributes, transform, is_mirrored);
            }
            let name = match found.primitives.len() {
                1 => name.clone(),
                _ => format!("{name} primitive {number}"),
            };
            builder.mesh_with(name, positions, triangles, attributes, material);
        }
        Ok(())
    }

    /// The grey default material of surfaces without one, the same as in the other loaders.
    fn default_material(&mut self, builder: &mut SceneBuilder) -> MaterialId {
        self.census.without_material += 1;
        *self.default_material.get_or_insert_with(|| builder.material(default_material()))
    }
}

/// Whether the transform is a reflection. Computed from the axes' directions only, since the determinant of
/// very small or large scales could underflow or overflow.
fn is_mirrored(transform: &DMat4) -> bool {
    let axis = |axis: glam::DVec4| axis.truncate().normalize_or_zero();
    let [x, y, z] = [transform.x_axis, transform.y_axis, transform.z_axis].map(axis);
    x.cross(y).dot(z) < 0.0
}

impl Census {
    /// Adds the counts to the report.
    pub(super) fn report(&self, report: &mut LoadReport) {
        let Self { morphed, without_material, .. } = self;
        if *morphed > 0 {
            report.left_out("the file", format!("the morph targets of {morphed} meshes; the base shape is rendered"));
        }
        if *without_material > 0 {
            report.approximated(
                "the file",
                format!(
                    "{without_material} meshes have no material and are made a diffuse grey of 0.5 \
                     named 'default'"
                ),
            );
        }
    }
}

//! Meshes: each node that refers to one adds an instance, transformed by the node.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use glam::{DMat4, DVec3};
use gltf::json::Root;
use gltf::json::mesh::Primitive;

use super::accessor::Accessors;
use super::fault::{Fault, label, name_or_number};
use super::morph::{self, Morph};
use super::skin::{self, Skin};
use super::{attributes, nodes, primitive};
use crate::builder::{MaterialId, SceneBuilder};
use crate::describe::MaterialDesc;
use crate::load::budget::Budget;
use crate::report::LoadReport;

/// More vertices and indices than this, over all instances, are treated as damage: a few nodes that share a mesh could
/// otherwise request all available memory.
const MAX_ELEMENTS: u64 = 1 << 28;
/// So many are always allowed; more only if the file has a byte for [`MOST_PER_BYTE`] of them.
const FREE_ELEMENTS: u64 = 1 << 25;
/// Vertices and indices for each byte of a file. A forest of a few hundred instances of whole trees has about ten.
const MOST_PER_BYTE: u64 = 256;

/// The number of vertices and indices, over all instances, of a file of that many bytes with its buffers.
pub(super) fn most_elements(bytes: u64) -> u64 {
    bytes.saturating_mul(MOST_PER_BYTE).clamp(FREE_ELEMENTS, MAX_ELEMENTS)
}

/// Adds the mesh of a node, one mesh of the builder for each primitive.
pub(super) struct Meshes<'a> {
    pub(super) root: &'a Root,
    pub(super) accessors: Accessors<'a>,
    pub(super) budget: &'a Budget,
    pub(super) materials: Vec<MaterialId>,
    pub(super) default_material: Option<MaterialId>,
    /// Vertices and indices so far, and at most.
    pub(super) elements: u64,
    pub(super) most_elements: u64,
    /// Transforms of all nodes, and the skins read so far, both on first use.
    pub(super) globals: OnceCell<Vec<DMat4>>,
    pub(super) skins: BTreeMap<usize, Rc<Skin>>,
}

/// Where a mesh is: its vertices are at its node, or follow the joints of a skin.
struct Placement<'a> {
    transform: &'a DMat4,
    skin: Option<Rc<Skin>>,
    /// Default weights of the morph targets.
    weights: &'a [f32],
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
        let source = &self.root.nodes[node];
        let node_name = source.name.as_deref();
        let node_label = label("node", node, node_name);
        let found = meshes.get(mesh).ok_or_else(|| Fault::dangling(&node_label, "mesh", mesh, meshes.len()))?;
        let mesh_name = found.name.as_deref().filter(|name| !name.is_empty());
        let name = match node_name.filter(|name| !name.is_empty()).or(mesh_name) {
            Some(name) => name.to_owned(),
            None => name_or_number("mesh", mesh, None),
        };
        let skin = match source.skin {
            Some(skin) => Some(self.skin(skin.value(), &node_label)?),
            None => None,
        };
        // Some programs hide nodes by scaling them to zero.
        let axes = [transform.x_axis, transform.y_axis, transform.z_axis];
        if skin.is_none() && axes.iter().all(|x| x.truncate() == DVec3::ZERO) {
            report.note(format!("mesh '{name}'"), "is scaled to zero, and so not rendered");
            return Ok(());
        }
        let placement = Placement { transform, skin, weights: morph::weights(source, found) };
        for (number, source) in found.primitives.iter().enumerate() {
            let part = format!("{} primitive {number}", label("mesh", mesh, mesh_name));
            if !primitive::is_surface(source, &part)? {
                report.left_out(part, "consists of points or lines, which have no surface");
                continue;
            }
            let name = match found.primitives.len() {
                1 => name.clone(),
                _ => format!("{name} primitive {number}"),
            };
            self.add_primitive(source, &placement, (name, &part), builder, report)?;
        }
        Ok(())
    }

    fn add_primitive(
        &mut self,
        source: &Primitive,
        placement: &Placement<'_>,
        (name, part): (String, &str),
        builder: &mut SceneBuilder,
        report: &mut LoadReport,
    ) -> Result<(), Fault> {
        let Placement { transform, skin, weights } = placement;
        let morph = Morph::new(source, weights, part, report)?;
        let times = 1 + morph.len() as u64;
        let size = primitive::size(&self.accessors, source, part)?.saturating_mul(times);
        self.elements = self.elements.saturating_add(size);
        if self.elements > self.most_elements {
            return Err(Fault::new(
                part,
                format!("brings the scene to over {} vertices and indices, the most for its size", self.most_elements),
                "leave out instances, or use coarser meshes",
            ));
        }
        let bytes = primitive::bytes(&self.accessors, source, part)?;
        self.budget.take(bytes, || part.to_owned())?;
        let material = match source.material {
            None => self.default_material(builder),
            Some(material) => *self
                .materials
                .get(material.value())
                .ok_or_else(|| Fault::dangling(part, "material", material.value(), self.materials.len()))?,
        };
        let read = primitive::read(&self.accessors, source, part, report)?;
        if read.stray > 0 {
            let text = format!("{} vertices at its end make no whole triangle", read.stray);
            report.left_out(part, text);
        }

        let desc = &builder.materials[material.0 as usize];
        let (mut positions, mut triangles) = (read.positions, read.triangles);
        let mut attributes =
            attributes::read(&self.accessors, source, desc, (positions.len(), &read.extras), part, report)?;
        morph.displace(&self.accessors, &mut positions, &read.is_used, part)?;
        morph.tilt(&self.accessors, &mut attributes, part)?;
        let mut matrices = match skin {
            Some(skin) => skin.matrices(&self.accessors, source, positions.len(), part, report)?,
            None => None,
        };
        attributes::keep_used(&read.is_used, &mut positions, &mut triangles, &mut attributes, matrices.as_mut());
        if let Some(matrices) = matrices {
            skin::pose(&matrices, &mut positions, &mut triangles, &mut attributes);
            builder.mesh_with(name, positions, triangles, attributes, material);
            return Ok(());
        }
        if skin.is_some() {
            let text = "has a skin, but no JOINTS_0 and WEIGHTS_0; its vertices are placed by its node";
            report.approximated(part, text);
        }
        if attributes::is_mirrored(transform) {
            // A mirrored mesh keeps its front side (glTF 2.0 specification, section 3.7.4).
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        if **transform != DMat4::IDENTITY {
            positions.iter_mut().for_each(|at| *at = transform.transform_point3(DVec3::from(*at)).to_array());
            attributes::transform(&mut attributes, transform);
        }
        builder.mesh_with(name, positions, triangles, attributes, material);
        Ok(())
    }

    /// A skin in the default pose; several nodes may share it.
    fn skin(&mut self, index: usize, user: &str) -> Result<Rc<Skin>, Fault> {
        if let Some(skin) = self.skins.get(&index) {
            return Ok(Rc::clone(skin));
        }
        let globals = match self.globals.get() {
            Some(globals) => globals,
            None => {
                let globals = nodes::globals(self.root)?;
                self.globals.get_or_init(|| globals)
            }
        };
        let skin = Rc::new(Skin::read(self.root, &self.accessors, globals, index, user)?);
        self.skins.insert(index, Rc::clone(&skin));
        Ok(skin)
    }

    /// The default material of surfaces without one: all properties have the default values of the format.
    fn default_material(&mut self, builder: &mut SceneBuilder) -> MaterialId {
        *self.default_material.get_or_insert_with(|| builder.material(MaterialDesc::metal("default", [1.0; 3], 1.0)))
    }
}

//! Morph targets (glTF 2.0 specification, section 3.7.2.2): a mesh is drawn with its default weights.

use gltf::json::mesh::{MorphTarget, Primitive};
use gltf::json::{Mesh, Node, Value};

use super::accessor::Accessors;
use super::fault::{AGAIN, Fault};
use crate::mesh::VertexAttributes;
use crate::report::LoadReport;

/// Default weights of the morph targets of a mesh at a node: those of the node, else those of the mesh, else zeros.
pub(super) fn weights<'a>(node: &'a Node, mesh: &'a Mesh) -> &'a [f32] {
    node.weights.as_deref().or(mesh.weights.as_deref()).unwrap_or_default()
}

/// The targets of a primitive that its weights use.
pub(super) struct Morph<'a> {
    used: Vec<(&'a MorphTarget, f64)>,
}

impl<'a> Morph<'a> {
    /// Pairs the targets with their weights.
    ///
    /// # Errors
    /// A weight that is not finite. One without a target is reported.
    pub(super) fn new(
        primitive: &'a Primitive,
        weights: &[f32],
        part: &str,
        report: &mut LoadReport,
    ) -> Result<Self, Fault> {
        let targets = primitive.targets.as_deref().unwrap_or_default();
        let mut used = Vec::new();
        for (number, &weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
            if !weight.is_finite() {
                let why = format!("the weight of morph target {number} is {weight}");
                return Err(Fault::new(part, why, "weights must be finite numbers"));
            }
            let Some(target) = targets.get(number) else {
                report.left_out(part, "weights of morph targets that it does not have");
                break;
            };
            used.push((target, f64::from(weight)));
        }
        Ok(Self { used })
    }

    /// Number of targets with a weight other than zero.
    pub(super) fn len(&self) -> usize {
        self.used.len()
    }

    /// Adds the displacements of positions, which have to be finite where a triangle has the vertex.
    pub(super) fn displace(
        &self,
        accessors: &Accessors<'_>,
        positions: &mut [[f64; 3]],
        is_used: &[bool],
        part: &str,
    ) -> Result<(), Fault> {
        for (target, weight) in &self.used {
            let Some(accessor) = target.positions else { continue };
            let deltas = deltas(accessors, accessor.value(), positions.len(), part)?;
            let is_invalid =
                |(delta, is_used): (&[f64; 3], &bool)| *is_used && delta.iter().any(|part| !part.is_finite());
            if let Some(vertex) = deltas.iter().zip(is_used).position(is_invalid) {
                let why = format!("a morph target displaces vertex {vertex} by {:?}", deltas[vertex]);
                return Err(Fault::new(part, why, "every coordinate must be a finite number; repair the mesh"));
            }
            add(positions, &deltas, *weight);
        }
        Ok(())
    }

    /// Adds the displacements of normals and tangents, where the primitive has these.
    pub(super) fn tilt(
        &self,
        accessors: &Accessors<'_>,
        attributes: &mut VertexAttributes,
        part: &str,
    ) -> Result<(), Fault> {
        for (target, weight) in &self.used {
            if let Some(accessor) = target.normals.filter(|_| !attributes.normals.is_empty()) {
                let deltas = deltas(accessors, accessor.value(), attributes.normals.len(), part)?;
                add(&mut attributes.normals, &deltas, *weight);
            }
            if let Some(accessor) = target.tangents.filter(|_| !attributes.tangents.is_empty()) {
                let deltas = deltas(accessors, accessor.value(), attributes.tangents.len(), part)?;
                add(&mut attributes.tangents, &deltas, *weight);
            }
        }
        Ok(())
    }
}

/// One displacement for each vertex.
fn deltas(accessors: &Accessors<'_>, accessor: usize, vertices: usize, part: &str) -> Result<Vec<[f64; 3]>, Fault> {
    let deltas = accessors.vectors(accessor, part)?;
    if deltas.len() != vertices {
        let why = format!("a morph target displaces {} vertices, but there are {vertices}", deltas.len());
        return Err(Fault::new(part, why, AGAIN));
    }
    Ok(deltas)
}

/// Adds to the first three components; the fourth of a tangent is a sign.
fn add<const N: usize>(values: &mut [[f64; N]], deltas: &[[f64; 3]], weight: f64) {
    for (value, delta) in values.iter_mut().zip(deltas) {
        value.iter_mut().zip(delta).for_each(|(part, delta)| *part += weight * delta);
    }
}

/// Reports targets of colours and texture coordinates, which the parser drops.
pub(super) fn report_unread(document: &Value, report: &mut LoadReport) {
    let primitives = items(document, "meshes").iter().flat_map(|mesh| items(mesh, "primitives"));
    let targets = primitives.flat_map(|primitive| items(primitive, "targets"));
    let is_unread = |name: &String| !["POSITION", "NORMAL", "TANGENT"].contains(&name.as_str());
    let unread = targets.filter(|target| target.as_object().is_some_and(|all| all.keys().any(is_unread))).count();
    if unread > 0 {
        let text = format!("colours and texture coordinates of {unread} morph targets; the base values are used");
        report.left_out("the file", text);
    }
}

/// The items of an array, if there is one of this name.
fn items<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

//! Skins (glTF 2.0 specification, section 3.7.3): vertices follow the joints of the default pose.

use glam::{DMat4, DVec3, DVec4};
use gltf::json::Root;
use gltf::json::accessor::Type;
use gltf::json::mesh::{Primitive, Semantic};

use super::accessor::Accessors;
use super::attributes::Directions;
use super::fault::{AGAIN, Fault, label};
use super::nodes::affine;
use super::primitive::attribute;
use crate::mesh::VertexAttributes;
use crate::report::LoadReport;

/// Weights are stored with 8 bits or more, at most 16 sets of 4: a sum that differs more from 1 is no rounding.
const SUM_TOLERANCE: f64 = 0.02;

/// The joints of a skin in the default pose.
pub(super) struct Skin {
    /// From the space of the mesh to that of the scene, by each joint: its transform times its inverse bind matrix.
    joints: Vec<DMat4>,
    part: String,
}

impl Skin {
    /// Reads a skin; `globals` are the transforms of all nodes.
    ///
    /// # Errors
    /// Without joints, with too few inverse bind matrices, or with matrices that are not affine and finite.
    pub(super) fn read(
        root: &Root,
        accessors: &Accessors<'_>,
        globals: &[DMat4],
        index: usize,
        user: &str,
    ) -> Result<Self, Fault> {
        let skin = root.skins.get(index).ok_or_else(|| Fault::dangling(user, "skin", index, root.skins.len()))?;
        let part = label("skin", index, skin.name.as_deref());
        if skin.joints.is_empty() {
            return Err(Fault::new(part, "has no joints", AGAIN));
        }
        let inverse_binds = match skin.inverse_bind_matrices {
            Some(accessor) => accessors.tuples(accessor.value(), &[Type::Mat4], [0.0; 16], &part)?,
            None => vec![DMat4::IDENTITY.to_cols_array(); skin.joints.len()],
        };
        if inverse_binds.len() < skin.joints.len() {
            let why = format!("has {} joints, but {} inverse bind matrices", skin.joints.len(), inverse_binds.len());
            return Err(Fault::new(part, why, AGAIN));
        }
        let mut joints = Vec::with_capacity(skin.joints.len());
        for (number, (joint, inverse_bind)) in skin.joints.iter().zip(&inverse_binds).enumerate() {
            let joint = joint.value();
            let global = globals.get(joint).ok_or_else(|| Fault::dangling(&part, "node", joint, globals.len()))?;
            let inverse_bind = DMat4::from_cols_array(inverse_bind);
            // Exporters invert matrices in single precision.
            if !(inverse_bind.row(3) - DVec4::W).abs().cmple(DVec4::splat(1e-3)).all() {
                let why = format!("the last row of inverse bind matrix {number} is not 0 0 0 1");
                return Err(Fault::new(part, why, AGAIN));
            }
            let matrix = *global * affine(inverse_bind);
            if !matrix.is_finite() {
                let why = format!("the matrix of joint {number} (node {joint}) is not finite");
                return Err(Fault::new(part, why, "give its nodes and inverse bind matrices numbers of sensible size"));
            }
            joints.push(matrix);
        }
        Ok(Self { joints, part })
    }

    /// The matrix of each vertex, from the space of the mesh to that of the scene: the mean of those of its joints by
    /// their weights. `None` if the primitive does not say which joints its vertices follow.
    ///
    /// # Errors
    /// Joints without weights or the reverse, a joint that the skin does not have, a weight that is negative or not
    /// finite.
    pub(super) fn matrices(
        &self,
        accessors: &Accessors<'_>,
        primitive: &Primitive,
        vertices: usize,
        part: &str,
        report: &mut LoadReport,
    ) -> Result<Option<Vec<DMat4>>, Fault> {
        let mut sums = vec![(DMat4::ZERO, 0.0); vertices];
        for set in 0.. {
            let found = (attribute(primitive, Semantic::Joints(set)), attribute(primitive, Semantic::Weights(set)));
            let (numbers, weights) = match found {
                (Some(numbers), Some(weights)) => (numbers, weights),
                (None, None) if set == 0 => return Ok(None),
                (None, None) => break,
                (Some(_), None) => {
                    return Err(Fault::new(part, format!("has JOINTS_{set}, but no WEIGHTS_{set}"), AGAIN));
                }
                (None, Some(_)) => {
                    return Err(Fault::new(part, format!("has WEIGHTS_{set}, but no JOINTS_{set}"), AGAIN));
                }
            };
            let numbers = accessors.joints(numbers, part)?;
            let weights = accessors.tuples(weights, &[Type::Vec4], [0.0; 4], part)?;
            if numbers.len() != vertices || weights.len() != vertices {
                let (joints, weights) = (numbers.len(), weights.len());
                let why = format!("has {joints} JOINTS_{set} and {weights} WEIGHTS_{set} for {vertices} vertices");
                return Err(Fault::new(part, why, AGAIN));
            }
            for (vertex, (numbers, weights)) in numbers.iter().zip(&weights).enumerate() {
                self.gather(numbers, weights, &mut sums[vertex])
                    .map_err(|why| Fault::new(part, format!("vertex {vertex}: {why}"), AGAIN))?;
            }
        }
        Ok(Some(self.means(&sums, part, report)))
    }

    /// Adds the joints of a set to the sums of matrices and weights of a vertex.
    fn gather(&self, numbers: &[u32; 4], weights: &[f64; 4], sums: &mut (DMat4, f64)) -> Result<(), String> {
        for (&number, &weight) in numbers.iter().zip(weights) {
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(format!("a joint weight is {weight}"));
            }
            if weight > 0.0 {
                let joint = self.joints.get(number as usize).ok_or_else(|| {
                    format!("follows joint {number} of {}, but there are {}", self.part, self.joints.len())
                })?;
                sums.0 += *joint * weight;
                sums.1 += weight;
            }
        }
        Ok(())
    }

    fn means(&self, sums: &[(DMat4, f64)], part: &str, report: &mut LoadReport) -> Vec<DMat4> {
        let (mut without, mut uneven) = (0_usize, 0_usize);
        let mut mean = |&(matrix, weight): &(DMat4, f64)| {
            if weight == 0.0 {
                without += 1;
                return self.joints[0];
            }
            uneven += usize::from((weight - 1.0).abs() > SUM_TOLERANCE);
            affine(matrix * weight.recip())
        };
        let means = sums.iter().map(&mut mean).collect();
        if without > 0 {
            report.approximated(part, format!("{without} vertices have no joint weights; they follow the first joint"));
        }
        if uneven > 0 {
            report
                .approximated(part, format!("joint weights of {uneven} vertices do not add up to 1; they are scaled"));
        }
        means
    }
}

/// Transforms each vertex by its matrix; triangles of which most corners are mirrored keep their front side.
pub(super) fn pose(
    matrices: &[DMat4],
    positions: &mut [[f64; 3]],
    triangles: &mut [[u32; 3]],
    attributes: &mut VertexAttributes,
) {
    let mut mirrored = vec![false; matrices.len()];
    for (vertex, matrix) in matrices.iter().enumerate() {
        positions[vertex] = matrix.transform_point3(DVec3::from(positions[vertex])).to_array();
        let directions = Directions::new(matrix);
        mirrored[vertex] = directions.is_mirrored();
        if let Some(normal) = attributes.normals.get_mut(vertex) {
            *normal = directions.normal(*normal);
        }
        if let Some(tangent) = attributes.tangents.get_mut(vertex) {
            *tangent = directions.tangent(*tangent);
        }
    }
    for triangle in triangles {
        let corners = triangle.iter().filter(|&&corner| mirrored[corner as usize]).count();
        if corners >= 2 {
            triangle.swap(1, 2);
        }
    }
}

//! Vertex attributes of a primitive, as far as its material needs them.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};
use gltf::json::accessor::Type;
use gltf::json::mesh::{Primitive, Semantic};

use super::accessor::Accessors;
use super::fault::Fault;
use super::primitive::{attribute, refined};
use crate::describe::MaterialDesc;
use crate::extras::{PrimitiveExtras, standard};
use crate::mesh::VertexAttributes;
use crate::report::LoadReport;

/// Reads the attributes of that many vertices, with exact values where the extras have them, in the space of the node. A UV set that the primitive does not have is
/// reported, and all of its coordinates are 0.
pub(super) fn read(
    accessors: &Accessors<'_>,
    primitive: &Primitive,
    material: &MaterialDesc,
    (vertices, extras): (usize, &PrimitiveExtras),
    part: &str,
    report: &mut LoadReport,
) -> Result<VertexAttributes, Fault> {
    let mut reader = Reader { accessors, primitive, vertices, part, report };
    let mut attributes = VertexAttributes {
        normals: reader.list(Semantic::Normals, &[Type::Vec3], [0.0; 3])?.unwrap_or_default(),
        colors: reader.list(Semantic::Colors(0), &[Type::Vec3, Type::Vec4], [1.0; 4])?.unwrap_or_default(),
        ..VertexAttributes::default()
    };
    let invalid = attributes.colors.as_flattened_mut().iter_mut().filter(|part| part.is_nan());
    let invalid = invalid.map(|part| *part = 0.0).count();
    if invalid > 0 {
        reader.report.approximated(part, format!("{invalid} numbers of its COLOR_0 are NaN, and taken as 0"));
    }
    // Without normals, tangents have to be ignored (glTF 2.0 specification, section 3.7.2.1), except those of our own files.
    let needs_tangents = material.textures.normal.is_some() || material.anisotropy > 0.0;
    if needs_tangents && (!attributes.normals.is_empty() || extras.tangents.is_some()) {
        attributes.tangents = reader.list(Semantic::Tangents, &[Type::Vec4], [0.0; 4])?.unwrap_or_default();
    }
    let (normals, colors) = (std::mem::take(&mut attributes.normals), std::mem::take(&mut attributes.colors));
    attributes.normals = refined(accessors, extras.normals, normals, standard::normal, part, reader.report);
    attributes.colors = refined(accessors, extras.colors, colors, standard::color, part, reader.report);
    if !attributes.tangents.is_empty() {
        let tangents = std::mem::take(&mut attributes.tangents);
        attributes.tangents = refined(accessors, extras.tangents, tangents, standard::tangent, part, reader.report);
    }
    let mut sets: BTreeSet<u32> = material.textures.all().map(|(_, used)| used.uv_set).collect();
    // Tangents follow these coordinates if nothing else gives them: MaterialDesc::anisotropy_rotation.
    let has_none = material.textures.normal.is_none() && material.textures.anisotropy.is_none();
    if material.anisotropy > 0.0 && has_none && attribute(primitive, Semantic::TexCoords(0)).is_some() {
        sets.insert(0);
    }
    for &set in &sets {
        let found = reader.list(Semantic::TexCoords(set), &[Type::Vec2], [0.0; 2])?;
        let uvs = found.unwrap_or_else(|| {
            let text = format!(
                "has no TEXCOORD_{set}, which a texture of its material '{}' needs; its coordinates are taken as 0",
                material.name
            );
            reader.report.approximated(part, text);
            vec![[0.0; 2]; vertices]
        });
        let view = extras.uvs.get(&set.to_string()).copied();
        let uvs = refined(accessors, view, uvs, standard::uv, part, reader.report);
        let set = set as usize;
        attributes.uvs.resize(attributes.uvs.len().max(set + 1), Vec::new());
        attributes.uvs[set] = uvs;
    }
    Ok(attributes)
}

struct Reader<'a, 'b, 'c> {
    accessors: &'a Accessors<'c>,
    primitive: &'a Primitive,
    vertices: usize,
    part: &'a str,
    report: &'b mut LoadReport,
}

impl Reader<'_, '_, '_> {
    /// The values of an attribute, filled up with those of `rest`; `None` if the primitive does not have it, or not for
    /// each vertex.
    fn list<const N: usize>(
        &mut self,
        semantic: Semantic,
        shapes: &[Type],
        rest: [f64; N],
    ) -> Result<Option<Vec<[f64; N]>>, Fault> {
        let name = semantic.to_string();
        let Some(accessor) = attribute(self.primitive, semantic) else { return Ok(None) };
        let values = self.accessors.tuples(accessor, shapes, rest, self.part)?;
        if values.len() == self.vertices {
            return Ok(Some(values));
        }
        let text = format!("its {name}: there are {} for {} vertices", values.len(), self.vertices);
        self.report.left_out(self.part, text);
        Ok(None)
    }
}

/// Leaves out the vertices that no triangle has: many primitives may share the vertices of one list.
pub(super) fn keep_used(
    is_used: &[bool],
    positions: &mut Vec<[f64; 3]>,
    triangles: &mut [[u32; 3]],
    attributes: &mut VertexAttributes,
    matrices: Option<&mut Vec<DMat4>>,
) {
    if is_used.iter().all(|&is_used| is_used) {
        return;
    }
    let places = is_used.iter().scan(0, |count, &is_used| {
        let place = *count;
        *count += u32::from(is_used);
        Some(place)
    });
    let places: Vec<u32> = places.collect();
    triangles.as_flattened_mut().iter_mut().for_each(|vertex| *vertex = places[*vertex as usize]);
    keep(positions, is_used);
    let VertexAttributes { normals, tangents, colors, uvs } = attributes;
    keep(normals, is_used);
    keep(tangents, is_used);
    keep(colors, is_used);
    uvs.iter_mut().for_each(|set| keep(set, is_used));
    if let Some(matrices) = matrices {
        keep(matrices, is_used);
    }
}

/// The values of the vertices in use, in as much memory.
fn keep<T>(values: &mut Vec<T>, is_used: &[bool]) {
    let mut used = is_used.iter();
    values.retain(|_| used.next().copied().unwrap_or(true));
    values.shrink_to_fit();
}

/// Transforms normals and tangents from the space of a node to that of the scene.
pub(super) fn transform(attributes: &mut VertexAttributes, transform: &DMat4) {
    let directions = Directions::new(transform);
    attributes.normals.iter_mut().for_each(|normal| *normal = directions.normal(*normal));
    attributes.tangents.iter_mut().for_each(|tangent| *tangent = directions.tangent(*tangent));
}

/// How a transform acts on normals and tangents; their lengths do not matter.
pub(super) struct Directions {
    matrix: DMat3,
    cofactors: DMat3,
    sign: f64,
}

impl Directions {
    pub(super) fn new(transform: &DMat4) -> Self {
        // Directions do not depend on the size, whose square could overflow or underflow.
        let matrix = DMat3::from_mat4(*transform);
        let greatest = matrix.to_cols_array().iter().fold(0.0_f64, |most, part| most.max(part.abs()));
        let matrix = if greatest > 0.0 { matrix * greatest.recip() } else { matrix };
        let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
        // The inverse transpose but for its determinant, of which only the sign matters.
        let sign = if is_mirrored(transform) { -1.0 } else { 1.0 };
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign;
        Self { matrix, cofactors, sign }
    }

    /// Whether the transform is a reflection.
    pub(super) fn is_mirrored(&self) -> bool {
        self.sign < 0.0
    }

    pub(super) fn normal(&self, normal: [f64; 3]) -> [f64; 3] {
        (self.cofactors * DVec3::from(normal)).to_array()
    }

    pub(super) fn tangent(&self, [x, y, z, handedness]: [f64; 4]) -> [f64; 4] {
        let [x, y, z] = (self.matrix * DVec3::new(x, y, z)).to_array();
        [x, y, z, handedness * self.sign]
    }
}

/// Whether the transform is a reflection. Computed from the axes' directions only, since the determinant of
/// very small or large scales could underflow or overflow.
pub(super) fn is_mirrored(transform: &DMat4) -> bool {
    let axis = |axis: glam::DVec4| axis.truncate().normalize_or_zero();
    let [x, y, z] = [transform.x_axis, transform.y_axis, transform.z_axis].map(axis);
    x.cross(y).dot(z) < 0.0
}

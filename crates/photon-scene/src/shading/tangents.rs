//! Vertex tangents for normal maps and anisotropy: those of the mesh, or `MikkTSpace`.

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::DVec3;
use photon_core::octahedral;

use super::normals::{Corners, unit};

/// A tangent, and whether the bitangent is `−normal × tangent`.
pub(super) type Tangent = (DVec3, bool);

/// Sine of the angle to the normal below which a tangent has no direction on the surface.
const PARALLEL: f64 = 1e-3;

/// The tangent of a vertex; `None` if it is not finite, zero or parallel to the normal, or if its sign is 0.
pub(super) fn given([x, y, z, sign]: [f64; 4], normal: DVec3) -> Option<Tangent> {
    let tangent = across(unit([x, y, z])?, normal)?;
    (sign != 0.0 && !sign.is_nan()).then_some((tangent, sign < 0.0))
}

/// Any tangent.
pub(super) fn any(normal: DVec3) -> Tangent {
    (normal.any_orthonormal_vector(), false)
}

/// Around the y axis; along x where the normal is parallel to it.
pub(super) fn around(normal: DVec3) -> Tangent {
    let tangent = DVec3::Y.cross(normal);
    (if tangent.length() > PARALLEL { tangent.normalize_or(DVec3::X) } else { DVec3::X }, false)
}

fn across(tangent: DVec3, normal: DVec3) -> Option<DVec3> {
    (tangent.cross(normal).length() > PARALLEL).then_some(tangent)
}

/// Packed as tables hold it.
pub(super) fn pack((tangent, is_negative): Tangent) -> u32 {
    octahedral::pack(tangent.as_vec3()) & !1 | u32::from(is_negative)
}

/// The tangents of all corners by `MikkTSpace`; `None` where it finds none. `uvs` are those on the normal map, with v
/// downwards as in glTF.
pub(super) fn generate(
    positions: &[[DVec3; 3]],
    normals: &[Corners],
    uvs: &[[[f64; 2]; 3]],
) -> Vec<[Option<Tangent>; 3]> {
    let mut mesh = Mesh { positions, normals, uvs, tangents: vec![[None; 3]; positions.len()] };
    // Its errors are about numbers of faces beyond 32 bits; without tangents, callers use any.
    let _ = generate_tangents(&mut mesh);
    mesh.tangents
}

struct Mesh<'a> {
    positions: &'a [[DVec3; 3]],
    normals: &'a [Corners],
    uvs: &'a [[[f64; 2]; 3]],
    tangents: Vec<[Option<Tangent>; 3]>,
}

/// The same bits on every platform.
struct Exact;

impl Ops for Exact {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

impl Geometry<Exact> for Mesh<'_> {
    fn num_faces(&self) -> usize {
        self.positions.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.positions[face][corner].as_vec3().to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.normals[face].normals[corner].as_vec3().to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        // The algorithm assumes that v grows upwards.
        let [u, v] = self.uvs[face][corner];
        [u as f32, (1.0 - v) as f32]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let Some(space) = space else { return };
        let [x, y, z, sign] = space.tangent_encoded().map(f64::from);
        let normal = self.normals[face].normals[corner];
        self.tangents[face][corner] = given([x, y, z, sign], normal);
    }
}

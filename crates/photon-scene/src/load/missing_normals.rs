//! Notes on curved mirrors and glass that are made of flat triangles.

use std::collections::{BTreeMap, HashSet};

use glam::DVec3;
use photon_core::ggx;

use crate::builder::SceneBuilder;
use crate::describe::{MaterialDesc, Surface};
use crate::mesh::Mesh;
use crate::report::LoadReport;
use crate::shading::is_smooth_metal;

/// With triangles in at most so many directions, a mesh is taken to have flat sides on purpose: a cut diamond has 58.
const MAX_DIRECTIONS: usize = 128;

/// Notes smooth mirrors and smooth glass with meshes without vertex normals whose triangles lie in many directions: a line for
/// each material.
///
/// Each triangle reflects and refracts as a plane. Light on the surfaces around shows dark and bright lines between the images of
/// neighbouring triangles, and where these are finer than the radius of an estimate, error estimates do not allow for
/// them.
pub(super) fn note(builder: &SceneBuilder, report: &mut LoadReport) {
    let mut triangles = BTreeMap::<u32, usize>::new();
    for mesh in &builder.meshes {
        let material = &builder.materials[mesh.material.0 as usize];
        if mesh.attributes.normals.is_empty() && is_specular(material) && has_many_sides(mesh) {
            *triangles.entry(mesh.material.0).or_default() += mesh.triangles.len();
        }
    }
    for (material, count) in triangles {
        report.note(
            format!("material '{}'", builder.materials[material as usize].name),
            format!(
                "{count} of its triangles have no vertex normals; each of them shows in caustics; export normals, shaded \
                 smooth, if the surface is curved"
            ),
        );
    }
}

/// Whether the surface reflects or refracts light in single directions. Sheets are left out: what passes is not bent, and they
/// reflect little.
fn is_specular(material: &MaterialDesc) -> bool {
    match material.surface {
        Surface::Mirror { .. } => true,
        // An index of 1 refracts nothing.
        Surface::Dielectric { roughness, ior, .. } => ior != 1.0 && roughness * roughness < f64::from(ggx::MIN_ALPHA),
        _ => is_smooth_metal(material),
    }
}

fn has_many_sides(mesh: &Mesh) -> bool {
    let mut directions = HashSet::new();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|vertex| mesh.positions.get(vertex as usize).map_or(DVec3::ZERO, |&at| at.into()));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        // Steps of a hundredth; those of a plane are one or two.
        directions.insert((normal * 100.0).round().as_i16vec3());
        if directions.len() > MAX_DIRECTIONS {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VertexAttributes;
    use crate::shapes::{grid, icosphere};

    fn noted(material: MaterialDesc, level: u32, has_normals: bool) -> bool {
        let mut builder = SceneBuilder::new();
        let material = builder.material(material);
        let (positions, triangles) = icosphere(level, [0.0; 3], 1.0);
        let normals = if has_normals { positions.clone() } else { Vec::new() };
        builder.mesh_with("ball", positions, triangles, VertexAttributes::default().with_normals(normals), material);
        let mut report = LoadReport::default();
        note(&builder, &mut report);
        assert!(report.is_exact());
        !report.lines.is_empty()
    }

    #[test]
    fn flat_triangles_of_curved_mirrors_and_glass_are_noted() {
        let mirror = || MaterialDesc::mirror("mirror", [1.0; 3]);
        assert!(noted(mirror(), 3, false));
        assert!(noted(MaterialDesc::glass("glass", 1.5), 3, false));
        // With vertex normals, with few sides, or where light is scattered, they are not.
        assert!(!noted(mirror(), 3, true));
        assert!(!noted(mirror(), 1, false));
        assert!(!noted(MaterialDesc::lambert("paint", [0.5; 3]), 3, false));
        assert!(!noted(MaterialDesc::boundary("mist", [1.0; 3]), 3, false));
    }

    #[test]
    fn a_flat_mirror_of_many_triangles_is_not() {
        let mut builder = SceneBuilder::new();
        let material = builder.material(MaterialDesc::mirror("mirror", [1.0; 3]));
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.3, 0.0], [1.0, 0.3, 1.0], [0.0, 0.0, 1.0]];
        let (positions, triangles) = grid(corners, 40, 40);
        builder.mesh("wall", positions, triangles, material);
        let mut report = LoadReport::default();
        note(&builder, &mut report);
        assert!(report.lines.is_empty(), "{report}");
    }
}

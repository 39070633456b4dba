//! The triangles of one material as a PLY file.

use std::collections::HashMap;
use std::io::Write as _;
use std::path::Path;

use photon_core::Boundaries;
use photon_scene::Scene;

use crate::atomic_write;
use crate::fault::Fault;

/// Writes those of a material in user space, binary, in single precision; returns their number, and writes no file if it is 0.
pub(super) fn write(scene: &Scene, material: u32, path: &Path) -> Result<usize, Fault> {
    let view = scene.view();
    let of_material = view.triangles.iter().zip(view.primitives).filter(|(_, of)| of.material == material);
    mesh(
        of_material.map(|(triangle, _)| *triangle),
        |at| scene.units().point_to_user(view.positions[at as usize]),
        path,
    )
}

/// As [`write`], for the boundaries of the medium with this index.
pub(super) fn write_boundary(scene: &Scene, medium: u32, path: &Path) -> Result<usize, Fault> {
    let Boundaries { positions, triangles, media, scale } = scene.view().boundaries;
    let of_medium = triangles.iter().zip(media).filter(|(_, of)| **of == medium).map(|(triangle, _)| *triangle);
    mesh(of_medium, |at| scene.units().point_to_user(positions[at as usize].map(|c| c * scale)), path)
}

fn mesh(
    triangles: impl Iterator<Item = [u32; 3]>,
    vertex: impl Fn(u32) -> [f64; 3],
    path: &Path,
) -> Result<usize, Fault> {
    let mut numbers = HashMap::new();
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for triangle in triangles {
        faces.push(triangle.map(|corner| {
            *numbers.entry(corner).or_insert_with(|| {
                corners.push(vertex(corner));
                corners.len() as u32 - 1
            })
        }));
    }
    if faces.is_empty() {
        return Ok(0);
    }
    atomic_write::write(path, |file| {
        write!(
            file,
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty \
             float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
            corners.len(),
            faces.len()
        )?;
        for corner in corners.iter().flatten() {
            file.write_all(&(*corner as f32).to_le_bytes())?;
        }
        for face in &faces {
            file.write_all(&[3])?;
            for corner in face {
                file.write_all(&corner.to_le_bytes())?;
            }
        }
        Ok(())
    })?;
    Ok(faces.len())
}

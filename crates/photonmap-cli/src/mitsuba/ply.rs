//! The triangles of one material as a PLY file.

use std::io::Write as _;
use std::path::Path;

use photon_scene::Scene;

use crate::atomic_write;
use crate::fault::Fault;

/// Writes them in user space, binary, in single precision; returns their number, and writes no file if it is 0.
pub(super) fn write(scene: &Scene, material: u32, path: &Path) -> Result<usize, Fault> {
    let view = scene.view();
    let mut numbers = vec![u32::MAX; view.positions.len()];
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for (triangle, _) in
        view.triangles.iter().zip(view.primitives).filter(|(_, primitive)| primitive.material == material)
    {
        faces.push(triangle.map(|corner| {
            let number = &mut numbers[corner as usize];
            if *number == u32::MAX {
                *number = corners.len() as u32;
                corners.push(scene.units().point_to_user(view.positions[corner as usize]));
            }
            *number
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

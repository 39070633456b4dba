//! Vertex normals as tables hold them: on the front of their triangle, and only where they differ from its own.

use glam::DVec3;
use photon_core::{ShadingTables, octahedral};

/// Vertex normals closer than this to the geometric normal, in radians, are that of a flat triangle.
const FLAT: f64 = 1e-3;

/// The vertex normals of a triangle.
pub(super) struct Corners {
    /// Unit normals on the front.
    pub(super) normals: [DVec3; 3],
    /// Whether all are the geometric normal.
    pub(super) is_flat: bool,
    /// Whether they were turned over, since all pointed backwards.
    pub(super) is_turned: bool,
    /// Number of normals that were replaced by the geometric one.
    pub(super) replaced: u64,
}

impl Corners {
    /// From the normals of the vertices, if there are any, and the geometric normal.
    pub(super) fn new(given: Option<[[f64; 3]; 3]>, geometric: DVec3) -> Self {
        let flat = Self { normals: [geometric; 3], is_flat: true, is_turned: false, replaced: 0 };
        let Some(given) = given else { return flat };
        let units = given.map(unit);
        // A mesh whose triangles run the other way round than its normals say is smooth nevertheless.
        let is_turned = units.iter().all(|normal| normal.is_some_and(|normal| normal.dot(geometric) < 0.0));
        let mut replaced = 0;
        let normals = units.map(|normal| {
            let normal = normal.map(|normal| if is_turned { -normal } else { normal });
            normal.filter(|normal| normal.dot(geometric) > 0.0).unwrap_or_else(|| {
                replaced += 1;
                geometric
            })
        });
        let is_flat = normals.iter().all(|normal| normal.distance(geometric) <= FLAT);
        Self { is_flat, is_turned, replaced, normals: if is_flat { flat.normals } else { normals } }
    }

    pub(super) fn pack(&self) -> [u32; 3] {
        if self.is_flat {
            return [ShadingTables::FLAT; 3];
        }
        self.normals.map(|normal| octahedral::pack(normal.as_vec3()))
    }
}

/// The direction of a vector; `None` if it is zero or not finite.
pub(crate) fn unit(vector: [f64; 3]) -> Option<DVec3> {
    let vector = DVec3::from_array(vector);
    // The square of an extreme component could overflow or underflow.
    (vector / vector.abs().max_element()).try_normalize()
}

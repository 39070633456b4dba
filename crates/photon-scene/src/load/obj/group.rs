//! Triangles of one object and material, and their conversion to a mesh.

use std::collections::HashMap;

use glam::DVec3;

use crate::mesh::VertexAttributes;

/// In place of an index that a corner does not have.
pub(super) const NONE: u32 = u32::MAX;

/// What the statements of a file define, by index.
#[derive(Default)]
pub(super) struct Pools {
    pub(super) positions: Vec<[f64; 3]>,
    /// Linear colours of the positions; empty until one has a colour.
    pub(super) colors: Vec<[f64; 4]>,
    pub(super) normals: Vec<DVec3>,
    /// With v downwards.
    pub(super) uvs: Vec<[f64; 2]>,
}

/// Triangles of one object and material, by index into the pools.
#[derive(Default)]
pub(super) struct Group {
    pub(super) object: String,
    pub(super) material: Option<String>,
    triangles: Vec<[u32; 3]>,
    /// Indices of normals; shorter than the triangles if the last ones have none.
    normals: Vec<[u32; 3]>,
    /// Indices of texture coordinates, likewise.
    uvs: Vec<[u32; 3]>,
}

/// One corner of a face: indices of its position, texture coordinates and normal.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

/// Which attributes a mesh gets.
struct Wanted {
    normals: bool,
    uvs: bool,
}

impl Group {
    pub(super) fn new(object: String, material: Option<String>) -> Self {
        Self { object, material, ..Self::default() }
    }

    /// Adds a polygon as a fan of triangles.
    pub(super) fn add(&mut self, corners: &[Corner]) {
        for pair in corners.windows(2).skip(1) {
            let triangle = [corners[0], pair[0], pair[1]];
            self.triangles.push(triangle.map(|corner| corner.position));
            push(&mut self.normals, triangle.map(|corner| corner.normal), self.triangles.len());
            push(&mut self.uvs, triangle.map(|corner| corner.uv), self.triangles.len());
        }
    }

    /// Number of triangles with a corner without texture coordinates.
    pub(super) fn without_uvs(&self) -> usize {
        let given = self.uvs.iter().filter(|corners| !corners.contains(&NONE)).count();
        self.triangles.len() - given
    }

    /// The mesh: positions, triangles and attributes; texture coordinates only if they are `textured`.
    pub(super) fn mesh(self, pools: &Pools, textured: bool) -> (Vec<[f64; 3]>, Vec<[u32; 3]>, VertexAttributes) {
        let wanted = Wanted { normals: self.is_smooth(pools), uvs: textured };
        let mut positions = Vec::new();
        let mut attributes = VertexAttributes::default();
        let has_colors = self.triangles.as_flattened().iter().any(|&index| pools.colors.get(index as usize).is_some());
        if wanted.uvs {
            attributes.uvs.push(Vec::new());
        }
        let mut indices: HashMap<Corner, u32> = HashMap::new();
        let mut triangles = self.triangles;
        for (number, triangle) in triangles.iter_mut().enumerate() {
            for (place, vertex) in triangle.iter_mut().enumerate() {
                let of = |list: &[[u32; 3]], is_wanted: bool| {
                    if is_wanted { list.get(number).map_or(NONE, |corners| corners[place]) } else { NONE }
                };
                let (normal, uv) = (of(&self.normals, wanted.normals), of(&self.uvs, wanted.uvs));
                let corner = Corner { position: *vertex, uv, normal };
                *vertex = *indices.entry(corner).or_insert_with(|| {
                    let index = corner.position as usize;
                    positions.push(pools.positions[index]);
                    if has_colors {
                        attributes.colors.push(pools.colors.get(index).copied().unwrap_or([1.0; 4]));
                    }
                    if wanted.normals {
                        let normal = pools.normals.get(corner.normal as usize);
                        // A zero is replaced by the normal of the triangle.
                        attributes.normals.push(normal.copied().unwrap_or_default().to_array());
                    }
                    if wanted.uvs {
                        attributes.uvs[0].push(pools.uvs.get(corner.uv as usize).copied().unwrap_or_default());
                    }
                    positions.len() as u32 - 1
                });
            }
        }
        (positions, triangles, attributes)
    }

    /// Whether a vertex normal differs from that of its triangle by more than the rounding of files.
    fn is_smooth(&self, pools: &Pools) -> bool {
        const FLAT: f64 = 1e-3;
        self.triangles.iter().zip(&self.normals).any(|(triangle, normals)| {
            let [a, b, c] = triangle.map(|index| DVec3::from(pools.positions[index as usize]));
            let geometric = (b - a).cross(c - a).normalize_or_zero();
            let mut given = normals.iter().filter_map(|&index| pools.normals.get(index as usize));
            given.any(|normal| normal.distance(geometric) > FLAT && *normal != DVec3::ZERO)
        })
    }
}

/// Appends the entry of triangle number `count`, unless it and all before it are empty.
fn push(list: &mut Vec<[u32; 3]>, entry: [u32; 3], count: usize) {
    if entry != [NONE; 3] {
        list.resize(count - 1, [NONE; 3]);
        list.push(entry);
    }
}

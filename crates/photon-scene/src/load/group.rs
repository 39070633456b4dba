//! Triangles of one object and material by index, as OBJ and PLY have them, and their conversion to a mesh.

use std::collections::HashMap;

use glam::DVec3;

use crate::mesh::VertexAttributes;

/// In place of an index that a corner does not have.
pub(super) const NONE: u32 = u32::MAX;

/// Everything that corners refer to, by index.
#[derive(Default)]
pub(super) struct Pools {
    pub(super) positions: Vec<[f64; 3]>,
    /// Linear colours and alpha, NaN where there is none; may end early.
    pub(super) colors: Vec<[f64; 4]>,
    pub(super) normals: Vec<DVec3>,
    /// With v downwards.
    pub(super) uvs: Vec<[f64; 2]>,
}

impl Pools {
    fn color(&self, index: u32) -> Option<[f64; 4]> {
        self.colors.get(index as usize).copied().filter(|color| !color[0].is_nan())
    }
}

/// One corner of a face: indices of its position, texture coordinates, normal and colour.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
    pub(super) color: u32,
}

/// Triangles, by index into the pools. Each list of attributes may be shorter than that of the triangles if the last ones have
/// none.
#[derive(Default)]
pub(super) struct Group {
    triangles: Vec<[u32; 3]>,
    normals: Vec<[u32; 3]>,
    uvs: Vec<[u32; 3]>,
    colors: Vec<[u32; 3]>,
}

/// A mesh without a name and a material.
pub(super) type Parts = (Vec<[f64; 3]>, Vec<[u32; 3]>, VertexAttributes);

impl Group {
    /// Adds the triangles of a face, each three of its corners.
    pub(super) fn add(&mut self, corners: &[Corner], triangles: &[[u32; 3]]) {
        for triangle in triangles {
            let triangle = triangle.map(|corner| corners[corner as usize]);
            self.triangles.push(triangle.map(|corner| corner.position));
            push(&mut self.normals, triangle.map(|corner| corner.normal), self.triangles.len());
            push(&mut self.uvs, triangle.map(|corner| corner.uv), self.triangles.len());
            push(&mut self.colors, triangle.map(|corner| corner.color), self.triangles.len());
        }
    }

    /// Number of triangles with a corner without texture coordinates.
    pub(super) fn without_uvs(&self) -> usize {
        let given = self.uvs.iter().filter(|corners| !corners.contains(&NONE)).count();
        self.triangles.len() - given
    }

    /// Whether any corner has a colour.
    pub(super) fn has_colors(&self, pools: &Pools) -> bool {
        let indices = if self.colors.is_empty() { &self.triangles } else { &self.colors };
        !pools.colors.is_empty() && indices.as_flattened().iter().any(|&index| pools.color(index).is_some())
    }

    /// Number of corners without a colour, if others have one.
    pub(super) fn without_colors(&self, pools: &Pools) -> usize {
        let indices = if self.colors.is_empty() { &self.triangles } else { &self.colors };
        let missing = || indices.as_flattened().iter().filter(|&&index| pools.color(index).is_none()).count();
        if self.has_colors(pools) { missing() } else { 0 }
    }

    /// The mesh; with texture coordinates only if it is textured.
    pub(super) fn mesh(self, pools: &Pools, is_textured: bool) -> Parts {
        let (is_smooth, has_colors) = (self.is_smooth(pools), self.has_colors(pools));
        let mut positions = Vec::new();
        let mut attributes = VertexAttributes::default();
        if is_textured {
            attributes.uvs.push(Vec::new());
        }
        let mut indices: HashMap<Corner, u32> = HashMap::new();
        let mut triangles = self.triangles;
        for (number, triangle) in triangles.iter_mut().enumerate() {
            for (place, vertex) in triangle.iter_mut().enumerate() {
                let of = |list: &[[u32; 3]], is_wanted: bool| {
                    if is_wanted { list.get(number).map_or(NONE, |corners| corners[place]) } else { NONE }
                };
                let (normal, uv) = (of(&self.normals, is_smooth), of(&self.uvs, is_textured));
                // Those of OBJ are colours of positions.
                let color = if self.colors.is_empty() { *vertex } else { of(&self.colors, has_colors) };
                let corner = Corner { position: *vertex, uv, normal, color };
                *vertex = *indices.entry(corner).or_insert_with(|| {
                    positions.push(pools.positions[corner.position as usize]);
                    if has_colors {
                        attributes.colors.push(pools.color(corner.color).unwrap_or([1.0; 4]));
                    }
                    if is_smooth {
                        let normal = pools.normals.get(corner.normal as usize);
                        // A zero is replaced by the normal of the triangle.
                        attributes.normals.push(normal.copied().unwrap_or_default().to_array());
                    }
                    if is_textured {
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

//! Vertex attributes of the remaining triangles, mesh by mesh.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use photon_core::{OwnedShadingTables, ShadingTables};

use super::normals::Corners;
use super::uvs::{self, UvSet};
use super::{Source, anisotropy, tangents};
use crate::describe::AlphaMode;
use crate::mesh::Mesh;
use crate::normalise::Geometry;
use crate::texture::TextureRef;

/// Red, green and blue of a vertex without a colour, alpha too.
const WHITE: [u32; 2] = [u32::MAX; 2];

/// Counts for warnings.
#[derive(Default)]
pub(super) struct Census {
    replaced_normals: u64,
    lost_tangents: u64,
    undirected: u64,
    uvs: uvs::Census,
}

impl Census {
    pub(super) fn warn(&self, warnings: &mut Vec<String>) {
        let Self { replaced_normals, lost_tangents, undirected, uvs } = self;
        let counts = [
            (*replaced_normals, "vertex normals are zero, not finite or behind their triangle; its own normal is used"),
            (*lost_tangents, "vertex tangents are zero, not finite or parallel to the normal; any are used"),
            (
                *undirected,
                "triangles are anisotropic without tangents or texture coordinates; their reflection is wider around the \
                 y axis, or turned from there",
            ),
            (uvs.invalid, "triangles have texture coordinates that are not finite numbers; 0 is used"),
            (
                uvs.coarse,
                "triangles have texture coordinates so large that rounding moves their textures; subtract whole \
                 numbers from them",
            ),
        ];
        warnings
            .extend(counts.into_iter().filter(|(count, _)| *count > 0).map(|(count, text)| format!("{count} {text}")));
    }
}

/// Adds the vertex attributes of all meshes.
pub(super) fn add_meshes(
    tables: &mut OwnedShadingTables,
    source: Source<'_>,
    geometry: &Geometry,
    sets: &BTreeMap<u32, u32>,
    census: &mut Census,
) {
    let count = geometry.triangles.len();
    let mut triangles = Triangles { source, geometry, census };
    let mut materials = geometry.primitives.iter().map(|&(_, material)| &source.materials[material as usize]);
    let has_maps = materials.any(anisotropy::has_tangents);
    let has_colors = source.meshes.iter().any(|mesh| !mesh.attributes.colors.is_empty());
    tables.uvs.resize(count * sets.len(), [[0.0; 2]; 3]);
    tables.normals.reserve_exact(count);
    for (index, mesh) in source.meshes.iter().enumerate() {
        let range = geometry.range(index);
        if range.is_empty() {
            continue;
        }
        let normals = triangles.normals(mesh, range.clone());
        tables.normals.extend(normals.iter().map(Corners::pack));
        if has_maps {
            tables.tangents.extend(triangles.tangents(mesh, range.clone(), &normals));
        }
        if has_colors {
            tables.colors.extend(triangles.colors(mesh, range.clone()));
        }
        for (&set, &row) in sets {
            if let Some(packed) = triangles.uvs(mesh, range.clone(), set) {
                let start = row as usize * count + range.start;
                tables.uvs[start..start + range.len()].copy_from_slice(&packed);
            }
        }
    }
    // Tables that say nothing cost nothing.
    let flat = ShadingTables::FLAT;
    if tables.normals.iter().all(|corners| corners[0] == flat) {
        tables.normals = Vec::new();
    }
    if tables.colors.as_flattened().iter().all(|color| *color == WHITE) {
        tables.colors = Vec::new();
    }
}

/// Reads the attributes of triangles.
struct Triangles<'a, 'b> {
    source: Source<'a>,
    geometry: &'a Geometry,
    census: &'b mut Census,
}

type Range = std::ops::Range<usize>;

impl Triangles<'_, '_> {
    /// The vertex indices of remaining triangles, as the mesh has them.
    fn corners<'c>(&'c self, mesh: &'c Mesh, range: Range) -> impl Iterator<Item = [usize; 3]> + 'c {
        self.geometry.sources[range].iter().map(|&triangle| mesh.triangles[triangle as usize].map(|v| v as usize))
    }

    fn normals(&mut self, mesh: &Mesh, range: Range) -> Vec<Corners> {
        let given = &mesh.attributes.normals;
        let primitives = self.geometry.primitives[range.clone()].iter();
        let found: Vec<Corners> = self
            .corners(mesh, range)
            .zip(primitives)
            .map(|(corners, &(geometric, _))| {
                let given = (!given.is_empty()).then(|| corners.map(|vertex| given[vertex]));
                Corners::new(given, Vec3::from_array(geometric).as_dvec3())
            })
            .collect();
        self.census.replaced_normals += found.iter().map(|corners| corners.replaced).sum::<u64>();
        found
    }

    /// The texture coordinates of remaining triangles; NaN and infinities are 0.
    fn coordinates(&self, mesh: &Mesh, range: Range, set: u32) -> Vec<[[f64; 2]; 3]> {
        let given = &mesh.attributes.uvs[set as usize];
        self.corners(mesh, range).map(|corners| corners.map(|vertex| given[vertex])).collect()
    }

    fn uvs(&mut self, mesh: &Mesh, range: Range, set: u32) -> Option<Vec<[[f32; 2]; 3]>> {
        let textures = &self.source.materials[mesh.material.0 as usize].textures;
        let used = textures.all().map(|(_, used)| used).filter(|used| used.uv_set == set);
        let uses: Vec<_> = used.map(|used| (used, self.source.image(used))).collect();
        if uses.is_empty() {
            return None;
        }
        let packer = UvSet::new(uses);
        let coordinates = self.coordinates(mesh, range, set);
        let census = &mut self.census.uvs;
        Some(coordinates.into_iter().map(|corners| packer.pack(corners, census)).collect())
    }

    fn colors(&self, mesh: &Mesh, range: Range) -> Vec<[[u32; 2]; 3]> {
        let given = &mesh.attributes.colors;
        if given.is_empty() {
            return vec![[WHITE; 3]; range.len()];
        }
        let is_opaque = self.source.materials[mesh.material.0 as usize].alpha_mode == AlphaMode::Opaque;
        let pack = |vertex: usize| {
            let [r, g, b, a] = given[vertex];
            pack_color([r, g, b, if is_opaque { 1.0 } else { a }])
        };
        self.corners(mesh, range).map(|corners| corners.map(pack)).collect()
    }

    fn tangents(&mut self, mesh: &Mesh, range: Range, normals: &[Corners]) -> Vec<[u32; 3]> {
        let material = &self.source.materials[mesh.material.0 as usize];
        if !anisotropy::has_tangents(material) {
            return vec![[0; 3]; range.len()];
        }
        let given = &mesh.attributes.tangents;
        let map = anisotropy::tangent_map(material);
        let has_uvs = map.is_some() || mesh.attributes.uvs.first().is_some_and(|uvs| !uvs.is_empty());
        let found = if given.is_empty() && !has_uvs {
            self.census.undirected += range.len() as u64;
            normals.iter().map(|corners| corners.normals.map(|normal| Some(tangents::around(normal)))).collect()
        } else if given.is_empty() {
            self.generated_tangents(mesh, range, normals, map)
        } else {
            self.corners(mesh, range)
                .zip(normals)
                .map(|(corners, normals)| {
                    std::array::from_fn(|corner| {
                        let (tangent, sign) = tangents::given(given[corners[corner]], normals.normals[corner])?;
                        Some((tangent, sign != normals.is_turned))
                    })
                })
                .collect()
        };
        let mut lost = 0;
        let packed = found
            .into_iter()
            .zip(normals)
            .map(|(tangents, normals): ([Option<tangents::Tangent>; 3], _)| {
                // The first corner that has one serves those that have none.
                let first = tangents.iter().flatten().next().copied();
                std::array::from_fn(|corner| {
                    tangents::pack(tangents[corner].or(first).unwrap_or_else(|| {
                        lost += 1;
                        tangents::any(normals.normals[corner])
                    }))
                })
            })
            .collect();
        self.census.lost_tangents += lost;
        packed
    }

    fn generated_tangents(
        &self,
        mesh: &Mesh,
        range: Range,
        normals: &[Corners],
        map: Option<TextureRef>,
    ) -> Vec<[Option<tangents::Tangent>; 3]> {
        let place = |vertex: usize| self.source.frame.point(mesh.positions[vertex]);
        let positions: Vec<[DVec3; 3]> = self.corners(mesh, range.clone()).map(|corners| corners.map(place)).collect();
        let on_map = |corner: [f64; 2]| {
            let corner = corner.map(uvs::finite);
            map.map_or(corner, |map| map.place(corner)).map(uvs::finite)
        };
        let set = map.map_or(0, |map| map.uv_set);
        let coordinates: Vec<[[f64; 2]; 3]> =
            self.coordinates(mesh, range, set).into_iter().map(|corners| corners.map(on_map)).collect();
        tangents::generate(&positions, normals, &coordinates)
    }
}

/// Four times 16 bits.
fn pack_color(color: [f64; 4]) -> [u32; 2] {
    let [r, g, b, a] = color.map(|part| (part.clamp(0.0, 1.0) * 65_535.0).round() as u32);
    [r | g << 16, b | a << 16]
}

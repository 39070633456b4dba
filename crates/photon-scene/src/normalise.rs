//! Conversion from user space to normalised space: a unit box centred at the origin.

use crate::describe::{LightDesc, MaterialDesc, Surface};
use crate::error::SceneError;
use crate::mesh::Mesh;
use bytemuck::Zeroable;
use glam::DVec3;
use photon_core::parallel;
use std::collections::BTreeSet;

/// The similarity transform that recentres and scales the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// Centre of the bounding box, user space.
    pub(crate) center: DVec3,
    /// The box's largest extent, user length; 1 for an empty box.
    pub(crate) scale: f64,
    /// The fraction of it that the triangles alone span; 1 without triangles.
    filled: f64,
}

/// The remaining triangles, in normalised space.
#[derive(Debug, Default)]
pub(crate) struct Geometry {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Unit normal and material.
    pub(crate) primitives: Vec<([f32; 3], u32)>,
    /// Index of the first triangle of each mesh.
    pub(crate) mesh_starts: Vec<u32>,
    /// The index that each triangle had in its mesh; empty for a scene without vertex attributes and textures.
    pub(crate) sources: Vec<u32>,
    /// Emissive triangles, with their areas.
    pub(crate) emitters: Vec<(u32, f64)>,
    /// Triangles that were left out of a mesh, because they have no area or by [`Geometry::remove`]: index of the mesh, and of
    /// the triangle within it, sorted.
    pub(crate) dropped: Vec<[u32; 2]>,
    /// Number of those that [`Geometry::remove`] left out.
    pub(crate) removed: usize,
    /// Number of triangles left out because light passes them unchanged.
    pub(crate) invisible: u64,
    /// Radius of a sphere around the origin that contains the vertices.
    pub(crate) radius: f64,
}

/// Bounding box of the vertices that triangles refer to: lower and upper corner.
pub(crate) fn bounds(meshes: &[Mesh]) -> Option<([f64; 3], [f64; 3])> {
    // A vertex that no triangle uses must not enlarge the box.
    around(meshes.iter().flat_map(|mesh| {
        mesh.triangles.iter().flatten().filter_map(|&index| mesh.positions.get(index as usize).copied())
    }))
}

fn around(points: impl Iterator<Item = [f64; 3]>) -> Option<([f64; 3], [f64; 3])> {
    let mut points = points.map(DVec3::from_array);
    let first = points.next()?;
    let (low, high) = points.fold((first, first), |(low, high), at| (low.min(at), high.max(at)));
    Some((low.to_array(), high.to_array()))
}

fn extent(low: [f64; 3], high: [f64; 3]) -> f64 {
    (DVec3::from_array(high) - DVec3::from_array(low)).max_element()
}

impl Frame {
    /// The frame of the triangles and of the lights that have a position.
    pub(crate) fn new(meshes: &[Mesh], lights: &[(String, LightDesc)]) -> Result<Self, SceneError> {
        let places: Vec<_> = lights
            .iter()
            .filter_map(|(_, light)| match *light {
                LightDesc::Point { position, .. } | LightDesc::Spot { position, .. } => Some(position),
                LightDesc::Directional { .. } => None,
            })
            .collect();
        let surfaces = bounds(meshes);
        let corners = surfaces.iter().flat_map(|(low, high)| [*low, *high]);
        let Some((low, high)) = around(corners.chain(places)) else {
            return Ok(Self { center: DVec3::ZERO, scale: 1.0, filled: 1.0 });
        };
        let center = DVec3::from_array(low) + (DVec3::from_array(high) - DVec3::from_array(low)) * 0.5;
        let extent = extent(low, high);
        if !extent.is_finite() {
            return Err(SceneError::Extreme {
                what: "the extent of the scene".to_owned(),
                value: format!("more than {:e}", f64::MAX),
                hint: "use a larger unit of length",
            });
        }
        let scale = if extent > 0.0 { extent } else { 1.0 };
        let filled = surfaces.map_or(1.0, |(low, high)| self::extent(low, high) / scale);
        Ok(Self { center, scale, filled })
    }

    /// Converts a point from user space to normalised space.
    pub(crate) fn point(self, user: [f64; 3]) -> DVec3 {
        (DVec3::from_array(user) - self.center) / self.scale
    }

    /// Distance of the user's origin from the scene's centre, in extents of the scene.
    fn offset(self) -> f64 {
        self.center.abs().max_element() / self.scale
    }

    /// Warns if the scene's position or extent costs precision.
    pub(crate) fn warn(self, warnings: &mut Vec<String>) {
        let offset = self.offset();
        if offset > 1e4 {
            warnings.push(format!(
                "the scene lies {offset:.1e} times its own extent away from the origin; if its coordinates were \
                 ever stored in 32 bits, it is distorted; move it towards the origin in the program that made it"
            ));
        }
        if self.filled < DISTANT {
            warnings.push(format!(
                "lights are so far away that the surfaces fill only {:.1e} of the scene's extent, which costs \
                 precision; use directional lights instead",
                self.filled
            ));
        }
    }
}

/// Share of the scene's extent that surfaces fill, below which lights are far away.
const DISTANT: f64 = 1e-3;

/// Converts all meshes to normalised space, leaving out the triangles that have no area there. `Geometry::sources` is
/// filled in if `traced`.
pub(crate) fn geometry(
    meshes: &[Mesh],
    materials: &[MaterialDesc],
    frame: Frame,
    traced: bool,
) -> Result<Geometry, SceneError> {
    let mut geometry = Geometry::default();
    let count: usize = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let vertices: usize = meshes.iter().map(|mesh| mesh.positions.len()).sum();
    for (what, count) in [("triangles", count), ("vertices", vertices)] {
        if count >= u32::MAX as usize {
            return Err(SceneError::TooMany { what, count });
        }
    }
    geometry.triangles.reserve_exact(count);
    geometry.primitives.reserve_exact(count);
    geometry.positions.reserve(vertices);
    for mesh in meshes {
        let first = geometry.triangles.len();
        geometry.mesh_starts.push(first as u32);
        let desc = &materials[mesh.material.0 as usize];
        // Boundaries have tables of their own.
        if desc.is_boundary() {
            continue;
        }
        if desc.is_invisible() && mesh.attributes.colors.is_empty() && !meets_a_solid(mesh, meshes, materials) {
            geometry.invisible += mesh.triangles.len() as u64;
            continue;
        }
        geometry.add(mesh, desc.is_emissive(), frame, traced);
        if desc.is_emissive() && geometry.triangles.len() == first {
            if frame.filled < DISTANT {
                return Err(SceneError::Extreme {
                    what: "the distance of the farthest light".to_owned(),
                    value: format!("{:.1e} times the extent of the surfaces", 1.0 / frame.filled),
                    hint: "move it closer, or use a directional light",
                });
            }
            return Err(SceneError::ZeroAreaLight { mesh: mesh.name.to_string(), material: desc.name.clone() });
        }
    }
    let radii = geometry.positions.iter().map(|&at| length(at));
    geometry.radius = f64::from(round_up(radii.fold(0.0, f64::max)));
    Ok(geometry)
}

/// Whether the bounding box of a mesh overlaps that of a solid that light does not pass unchanged: a mesh of index 1
/// within glass is a cavity.
fn meets_a_solid(mesh: &Mesh, meshes: &[Mesh], materials: &[MaterialDesc]) -> bool {
    if !matches!(materials[mesh.material.0 as usize].surface, Surface::Dielectric { .. }) {
        return false;
    }
    let Some((low, high)) = bounds(std::slice::from_ref(mesh)) else { return false };
    meshes.iter().any(|other| {
        let desc = &materials[other.material.0 as usize];
        desc.is_solid()
            && !desc.is_invisible()
            && bounds(std::slice::from_ref(other))
                .is_some_and(|(from, to)| (0..3).all(|axis| low[axis] <= to[axis] && from[axis] <= high[axis]))
    })
}

impl Geometry {
    /// The triangles of a mesh, by its index.
    pub(crate) fn range(&self, mesh: usize) -> std::ops::Range<usize> {
        let end = self.mesh_starts.get(mesh + 1).map_or(self.triangles.len(), |&end| end as usize);
        self.mesh_starts[mesh] as usize..end
    }

    /// The mesh that a triangle belongs to.
    pub(crate) fn mesh_of(&self, primitive: u32) -> usize {
        // Meshes without remaining triangles start where the next one does, which comes after them.
        self.mesh_starts.partition_point(|&start| start <= primitive) - 1
    }

    /// Removes triangles. Returns the new index of each triangle that there was, `u32::MAX` for those.
    pub(crate) fn remove(&mut self, triangles: &BTreeSet<u32>) -> Vec<u32> {
        let mut places = Vec::with_capacity(self.triangles.len());
        let (mut removed, mut kept) = (Vec::new(), 0);
        let mut starts = Vec::with_capacity(self.mesh_starts.len());
        for mesh in 0..self.mesh_starts.len() {
            let first = self.dropped.partition_point(|at| at[0] < mesh as u32);
            let mut dropped = self.dropped[first..].iter().peekable();
            let mut source = 0;
            starts.push(kept);
            for triangle in self.range(mesh) {
                while dropped.next_if(|&&at| at == [mesh as u32, source]).is_some() {
                    source += 1;
                }
                if triangles.contains(&(triangle as u32)) {
                    removed.push([mesh as u32, source]);
                    places.push(u32::MAX);
                } else {
                    places.push(kept);
                    kept += 1;
                }
                source += 1;
            }
        }
        let stays = |triangle: u32| places[triangle as usize] != u32::MAX;
        fn keep<T>(items: &mut Vec<T>, stays: impl Fn(u32) -> bool) {
            let mut index = 0..;
            items.retain(|_| index.next().is_some_and(&stays));
        }
        self.mesh_starts = starts;
        keep(&mut self.triangles, stays);
        keep(&mut self.primitives, stays);
        keep(&mut self.sources, stays);
        self.emitters.retain_mut(|(triangle, _)| {
            *triangle = places[*triangle as usize];
            *triangle != u32::MAX
        });
        self.removed += removed.len();
        self.dropped.extend(removed);
        self.dropped.sort_unstable();
        self.remove_unused_vertices();
        places
    }

    fn remove_unused_vertices(&mut self) {
        let mut moved = vec![u32::MAX; self.positions.len()];
        self.triangles.iter().flatten().for_each(|&vertex| moved[vertex as usize] = 0);
        let mut count = 0;
        let mut used = moved.iter_mut();
        self.positions.retain(|_| {
            let Some(place) = used.next().filter(|place| **place == 0) else { return false };
            *place = count;
            count += 1;
            true
        });
        self.triangles.iter_mut().flatten().for_each(|vertex| *vertex = moved[*vertex as usize]);
    }

    fn add(&mut self, mesh: &Mesh, emits: bool, frame: Frame, traced: bool) {
        let wide = parallel::collect_plain(mesh.positions.len(), |i| frame.point(mesh.positions[i]));
        // Coordinates are known to half a unit in the last place of f64; an area below the error that this
        // causes is noise.
        let noise = (frame.offset() + 1.0) * 2.0 * f64::EPSILON;
        let faces = parallel::collect_plain(mesh.triangles.len(), |i| {
            let [a, b, c] = mesh.triangles[i].map(|index| wide[index as usize]);
            let (cross, area) = cross_and_area([a, b, c]);
            let longest = (b - a).length().max((c - a).length()).max((c - b).length());
            let narrow = [a, b, c].map(|at| at.as_vec3().as_dvec3());
            // Rays are tested against the rounded triangle, and sampling divides by its area.
            let (_, narrow_area) = cross_and_area(narrow);
            let lost = 2.0 * area <= noise * longest || narrow_area == 0.0 || area < f64::from(f32::MIN_POSITIVE);
            if lost { Face::zeroed() } else { Face { normal: (cross / (2.0 * area)).as_vec3().to_array(), area } }
        });
        let mut moved = vec![u32::MAX; wide.len()];
        for (index, (&corners, face)) in mesh.triangles.iter().zip(faces).enumerate() {
            let Face { normal, area } = face;
            if area == 0.0 {
                self.dropped.push([self.mesh_starts.len() as u32 - 1, index as u32]);
                continue;
            }
            let primitive = self.triangles.len() as u32;
            self.triangles.push(corners.map(|index| {
                let place = &mut moved[index as usize];
                if *place == u32::MAX {
                    *place = self.positions.len() as u32;
                    self.positions.push(wide[index as usize].as_vec3().to_array());
                }
                *place
            }));
            self.primitives.push((normal, mesh.material.0));
            if traced {
                self.sources.push(index as u32);
            }
            if emits {
                self.emitters.push((primitive, area));
            }
        }
    }
}

/// Unit normal and area of a triangle; 0 without an area.
#[derive(Clone, Copy, Zeroable)]
struct Face {
    normal: [f32; 3],
    area: f64,
}

fn cross_and_area([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let cross = (b - a).cross(c - a);
    (cross, 0.5 * cross.length())
}

/// Length of a normalised vector, in f64.
pub(crate) fn length(vector: [f32; 3]) -> f64 {
    glam::Vec3::from_array(vector).as_dvec3().length()
}

/// Rounds a positive number to an f32 that is certainly not below it.
pub(crate) fn round_up(value: f64) -> f32 {
    // Twice the rounding error of f32, so that the sphere contains points that were rounded onto it.
    (value * (1.0 + 2.0 * f64::from(f32::EPSILON))) as f32
}

//! Boundaries of media that light passes: tables of their own, so that no ray to a surface meets them.

use glam::{DVec3, Vec3};
use photon_core::{Boundaries, Medium};

use crate::describe::{AmbientMedium, MaterialDesc, MediaTable, Surface, medium_record};
use crate::mesh::Mesh;
use crate::normalise::{self, Frame};
use crate::{shapes, solids};

/// Largest coordinate of the vertices, which ray tracing limits; larger ones are scaled.
const LARGEST: f64 = 16.0;

/// Media beyond this number at one point are ignored.
const MOST: usize = photon_core::Enclosing::MOST;

/// The tables of [`Boundaries`].
#[derive(Clone, Debug)]
pub(crate) struct BoundaryTables {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    media: Vec<u32>,
    scale: f32,
    /// Their media, and the material that may have a grid.
    records: Vec<(Medium, Option<usize>)>,
    /// Radius of a sphere around the origin that contains the vertices, normalised.
    pub(crate) radius: f64,
}

/// A boundary, or several of one medium.
struct Group {
    record: Medium,
    material: Option<usize>,
    /// Normalised.
    triangles: Vec<[DVec3; 3]>,
    volume: f64,
}

impl Default for BoundaryTables {
    fn default() -> Self {
        let (positions, triangles, media, records) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { positions, triangles, media, scale: 1.0, records, radius: 0.0 }
    }
}

impl BoundaryTables {
    /// The boundaries among the meshes, and the box of the ambient medium.
    pub(crate) fn new(
        meshes: &[Mesh],
        materials: &[MaterialDesc],
        ambient: Option<&AmbientMedium>,
        frame: Frame,
        warnings: &mut Vec<String>,
    ) -> Self {
        let mut groups: Vec<Group> = Vec::new();
        for (index, desc) in materials.iter().enumerate() {
            let Surface::Boundary { absorption } = desc.surface else { continue };
            let own = meshes.iter().filter(|mesh| mesh.material.0 as usize == index);
            let triangles: Vec<[DVec3; 3]> = own.flat_map(|mesh| normalised(mesh, frame)).collect();
            if triangles.is_empty() {
                continue;
            }
            solids::warn_of_boundary(&desc.name, &triangles, warnings);
            let record = medium_record(absorption, desc.scattering, desc.phase, frame.scale * desc.density());
            let record = Medium { priority: desc.priority, dispersion: Medium::MATCHED, ..record };
            let volume = solids::signed_volume(triangles.iter().copied()).abs();
            let is_same = |group: &&mut Group| {
                group.record == record && group.material.is_some_and(|other| materials[other].grid == desc.grid)
            };
            match groups.iter_mut().find(is_same) {
                Some(group) => {
                    group.triangles.extend(triangles);
                    group.volume += volume;
                }
                None => groups.push(Group { record, material: Some(index), triangles, volume }),
            }
        }
        // Of equal priorities the last one applies: the smallest.
        groups.sort_by(|a, b| b.volume.total_cmp(&a.volume));
        if let Some((medium, [low, high])) = ambient.and_then(|medium| medium.bounds.map(|bounds| (medium, bounds))) {
            let (positions, triangles) = shapes::cuboid(low, high);
            let corners =
                triangles.iter().map(|corners| corners.map(|at| frame.point(positions[at as usize]))).collect();
            let record = Medium { dispersion: Medium::MATCHED, ..medium.record(frame.scale) };
            groups.insert(0, Group { record, material: None, triangles: corners, volume: 0.0 });
        }
        warn_of_overlaps(&groups, warnings);
        Self::of(groups)
    }

    fn of(groups: Vec<Group>) -> Self {
        let mut tables = Self::default();
        let all = || groups.iter().flat_map(|group| &group.triangles).flatten();
        let largest = all().map(|at| at.abs().max_element()).fold(0.0, f64::max);
        while largest / f64::from(tables.scale) > LARGEST {
            tables.scale *= 2.0;
        }
        let mut known = std::collections::HashMap::new();
        for (number, group) in (0..).zip(&groups) {
            for corners in &group.triangles {
                tables.triangles.push(corners.map(|at| {
                    let at = (at.as_vec3() / tables.scale + 0.0).to_array();
                    *known.entry(at.map(f32::to_bits)).or_insert_with(|| {
                        tables.positions.push(at);
                        tables.positions.len() as u32 - 1
                    })
                }));
                tables.media.push(number);
            }
        }
        let scale = f64::from(tables.scale);
        let radii = tables.positions.iter().map(|&at| normalise::length(at) * scale);
        tables.radius = f64::from(normalise::round_up(radii.fold(0.0, f64::max)));
        tables.records = groups.iter().map(|group| (group.record, group.material)).collect();
        tables
    }

    /// Adds the media to those of all else, which come before them. Where nothing attenuates light, boundaries are left out.
    pub(crate) fn enter<'a>(&mut self, media: &mut MediaTable<'a>, materials: &'a [MaterialDesc]) {
        if !media.attenuates() && !self.records.iter().any(|(medium, _)| medium.attenuates()) {
            *self = Self::default();
        }
        let grid = |material: Option<usize>| material.and_then(|index| materials[index].grid.as_ref());
        let indices: Vec<u32> =
            self.records.iter().map(|&(medium, material)| media.index_of(medium, grid(material))).collect();
        self.media.iter_mut().for_each(|medium| *medium = indices[*medium as usize]);
    }

    pub(crate) fn view(&self) -> Boundaries<'_> {
        Boundaries { positions: &self.positions, triangles: &self.triangles, media: &self.media, scale: self.scale }
    }
}

/// The triangles of a mesh that have an area.
fn normalised(mesh: &Mesh, frame: Frame) -> impl Iterator<Item = [DVec3; 3]> {
    let place = move |at: u32| frame.point(mesh.positions[at as usize]);
    mesh.triangles.iter().map(move |corners| corners.map(place)).filter(|corners| {
        let [a, b, c] = corners.map(|at| at.as_vec3());
        (b - a).cross(c - a) != Vec3::ZERO
    })
}

/// Warns if more media may overlap at a point than are distinguished.
fn warn_of_overlaps(groups: &[Group], warnings: &mut Vec<String>) {
    let bounds: Vec<(DVec3, DVec3)> = groups
        .iter()
        .map(|group| {
            let all = group.triangles.iter().flatten();
            all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &at| (low.min(at), high.max(at)))
        })
        .collect();
    let meets = |a: &(DVec3, DVec3), b: &(DVec3, DVec3)| a.0.cmple(b.1).all() && b.0.cmple(a.1).all();
    if bounds.iter().any(|one| bounds.iter().filter(|other| meets(one, other)).count() > MOST) {
        warnings.push(format!(
            "more than {MOST} media with boundaries may overlap; where they do, some are ignored: give boundaries of equal media \
             one material"
        ));
    }
}

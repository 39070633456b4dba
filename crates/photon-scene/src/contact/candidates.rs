//! Search for triangles that may touch others, by grids: most scenes have few.

use std::ops::Range;

use glam::Vec3;
use photon_core::parallel;

use super::Source;
use super::cells::{Frame, Range3, Run};
use crate::mesh::Mesh;
use crate::normalise::Geometry;

/// Maximum number of triangles of a run in the first round.
const RUN: usize = 8;

/// Maximum extent of a run of several triangles, in cells.
const RUN_CELLS: f32 = 3.0;

/// Maximum number of rounds, and the number of triangles that are not worth another one.
const ROUNDS: u32 = 8;
const FEW: usize = 512;

/// Triangles that a thread takes at a time.
const PART: usize = 1 << 14;

/// Maximum number of materials that are compared with each other.
const COMPARED: usize = 256;

impl Source<'_> {
    /// Triangles that may touch others, up to a distance of `reach`, in ascending order. Each round keeps those that share a
    /// cell of a grid with others that they may touch; the next grid is around these cells alone.
    pub(super) fn candidates(&self, geometry: &Geometry, reach: f64) -> Vec<u32> {
        let classes = self.classes();
        let mut frame = Frame::new(Vec3::splat(-0.5), Vec3::splat(0.5), geometry.triangles.len(), reach as f32);
        let parts: Vec<(usize, Range<usize>)> = (0..geometry.mesh_starts.len())
            .flat_map(|mesh| {
                let range = geometry.range(mesh);
                let end = range.end;
                range.step_by(PART).map(move |first| (mesh, first..end.min(first + PART)))
            })
            .collect();
        let extent = RUN_CELLS * frame.cell();
        let in_runs =
            |_: usize, (mesh, part): (usize, Range<usize>)| runs(geometry, part, classes[mesh], (extent, reach as f32));
        let mut runs = parallel::map(parallel::threads(), parts.into_iter(), in_runs).concat();
        let mut count = geometry.triangles.len();
        for round in 0..ROUNDS {
            let (low, high) = frame.keep_crowded(geometry, &mut runs);
            let before = std::mem::replace(&mut count, runs.iter().map(|run| run.triangles.len()).sum());
            if count <= FEW || round > 0 && count > before / 2 {
                break;
            }
            if round == 0 {
                let single = |triangle| run(geometry, triangle, classes[geometry.mesh_of(triangle)], reach as f32);
                runs = runs.into_iter().flat_map(|run| run.triangles.map(single)).collect();
            }
            frame = Frame::new(low, high, count, reach as f32);
        }
        runs.into_iter().flat_map(|run| run.triangles).collect()
    }

    /// The class of each mesh.
    fn classes(&self) -> Vec<Class> {
        let mut first_of: Vec<(usize, u32)> = Vec::new();
        let class = |(index, mesh): (usize, &Mesh)| {
            let material = mesh.material.0 as usize;
            let is_solid = self.materials[material].is_solid();
            if self.is_shaded || is_solid {
                return Class { id: index as u32, is_solid };
            }
            let is_alike = |&(other, _): &(usize, u32)| {
                other == material || self.materials[other].is_alike(&self.materials[material])
            };
            let known = first_of.iter().find(|&first| is_alike(first)).map(|&(_, class)| class);
            if known.is_none() && first_of.len() < COMPARED {
                first_of.push((material, index as u32));
            }
            Class { id: known.unwrap_or(index as u32), is_solid }
        };
        self.meshes.iter().enumerate().map(class).collect()
    }
}

/// Two triangles of one class do not touch, unless they are of a solid and face each other.
#[derive(Clone, Copy)]
struct Class {
    id: u32,
    is_solid: bool,
}

/// The triangles of a part of a mesh, in runs of which those of several triangles are not larger than `extent`.
fn runs(geometry: &Geometry, part: Range<usize>, class: Class, (extent, reach): (f32, f32)) -> Vec<Run> {
    let mut runs = Vec::with_capacity(part.len() / 4);
    let (mut first, mut around, mut normals) = (part.start, Range3::EMPTY, Range3::EMPTY);
    for triangle in part.clone() {
        let (own, normal) = (bounds(geometry, triangle), normal(geometry, triangle, class));
        let joined = around.join(own);
        if triangle - first == RUN || triangle > first && (joined.high - joined.low).max_element() > extent {
            runs.push(Run::new(first..triangle, around, normals, class.id, reach));
            (first, around, normals) = (triangle, own, normal);
        } else {
            (around, normals) = (joined, normals.join(normal));
        }
    }
    if first < part.end {
        runs.push(Run::new(first..part.end, around, normals, class.id, reach));
    }
    runs
}

/// A triangle as a run.
fn run(geometry: &Geometry, triangle: u32, class: Class, reach: f32) -> Run {
    let at = triangle as usize;
    Run::new(at..at + 1, bounds(geometry, at), normal(geometry, at, class), class.id, reach)
}

fn bounds(geometry: &Geometry, triangle: usize) -> Range3 {
    let [a, b, c] = geometry.triangles[triangle].map(|at| Vec3::from_array(geometry.positions[at as usize]));
    Range3 { low: a.min(b).min(c), high: a.max(b).max(c) }
}

/// The normal, if another triangle of the class may touch this one.
fn normal(geometry: &Geometry, triangle: usize, class: Class) -> Range3 {
    if !class.is_solid {
        return Range3::EMPTY;
    }
    let normal = Vec3::from_array(geometry.primitives[triangle].0);
    Range3 { low: normal, high: normal }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;
    use crate::{MaterialDesc, SceneBuilder, normalise, shapes};

    /// Balls and boxes of glass on a floor, one of them in two layers, a picture, and a ball apart.
    fn scene() -> SceneBuilder {
        let turn = DMat3::from_axis_angle(DVec3::new(0.3, -0.7, 0.5).normalize_or_zero(), 0.83);
        let mut scene = SceneBuilder::new();
        let [floor, picture, glass] = [
            MaterialDesc::lambert("floor", [0.5; 3]),
            MaterialDesc::lambert("picture", [0.4; 3]),
            MaterialDesc::glass("glass", 1.5),
        ]
        .map(|desc| scene.material(desc));
        let mut add = |name: &str, (positions, triangles): (Vec<[f64; 3]>, Vec<[u32; 3]>), material| {
            let positions = positions.into_iter().map(|at| (turn * DVec3::from(at)).to_array()).collect();
            scene.mesh(name, positions, triangles, material);
        };
        let square = |half: f64| {
            let corners = vec![[-half, 0.0, half], [half, 0.0, half], [half, 0.0, -half], [-half, 0.0, -half]];
            (corners, vec![[0, 1, 2], [0, 2, 3]])
        };
        add("floor", square(4.0), floor);
        add("picture", square(0.3), picture);
        add("box", shapes::cuboid([-1.0, 0.0, 1.0], [1.0, 1.0, 2.0]), glass);
        let (positions, mut triangles) = shapes::icosphere(5, [2.0, 2.0, 0.0], 1.0);
        // Its inner face, at the same place.
        let inner: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).filter(|&[a, ..]| a < 40).collect();
        triangles.extend(inner);
        add("layers", (positions, triangles), glass);
        add("ball", shapes::icosphere(5, [-2.0, 3.0, 0.0], 1.0), glass);
        scene
    }

    #[test]
    fn no_contact_is_missed() {
        let SceneBuilder { meshes, materials, lights, .. } = scene();
        let frame = normalise::Frame::new(&meshes, &lights).unwrap();
        let geometry = normalise::geometry(&meshes, &materials, frame, false).unwrap();
        let source = Source { meshes: &meshes, materials: &materials, is_shaded: false, scale: 1.0 };
        let all: Vec<u32> = (0..geometry.triangles.len() as u32).collect();
        for reach in [2e-6, 1e-5, 1e-4] {
            let found = |among: &[u32]| -> Vec<[u32; 2]> {
                source.among(&geometry, among, reach).0.iter().map(|contact| contact.triangles).collect()
            };
            let mut candidates = source.candidates(&geometry, reach);
            let expected = found(&all);
            assert_eq!(found(&candidates), expected, "{reach}");
            let (few, many) = (candidates.len(), all.len());
            assert!(expected.len() > 40 && 8 * few < many, "{reach}: {} in {few} of {many}", expected.len());
            // The comparator tells that one is missing.
            candidates.retain(|triangle| expected[0][0] != *triangle);
            assert_ne!(found(&candidates), expected, "{reach}");
        }
    }
}

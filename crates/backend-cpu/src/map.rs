//! Photons arranged for search.

use photon_core::glam::Vec3;
use photon_core::{Error, IndexKind, KdTreeBuilder, Photon, Result, octahedral};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::index::{PointIndex, Workspace};

/// A photon map.
#[derive(Debug)]
pub struct CpuMap {
    index: PointIndex,
    /// In the order of the index.
    arrived: Vec<Arrived>,
    photons: CpuBuffer<Photon>,
}

/// What an estimate needs to know of a photon besides where it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrived {
    pub(crate) power: Vec3,
    pub(crate) normal: Vec3,
    /// Towards where it came from, packed.
    pub(crate) direction: u32,
}

impl CpuMap {
    /// The index over the photons' positions.
    #[must_use]
    pub fn index(&self) -> &PointIndex {
        &self.index
    }

    /// The photons, in the order in which they were stored.
    #[must_use]
    pub fn photons(&self) -> &[Photon] {
        self.photons.as_slice()
    }

    /// Every photon within `radius` of `point` (normalised space), with its squared distance, for a
    /// renderer with BSDFs and acceptance rules of its own. The order is that of the index.
    pub fn for_each_within(&self, point: [f32; 3], radius: f32, mut visit: impl FnMut(&Photon, f32)) {
        let order = self.index.order();
        self.index.within(point, radius * radius, |slot, distance_squared| {
            visit(&self.photons.data[order[slot as usize] as usize], distance_squared);
        });
    }

    #[inline]
    pub(crate) fn arrived(&self, slot: u32) -> &Arrived {
        &self.arrived[slot as usize]
    }
}

/// Builds photon maps over an index of the kind that was chosen.
#[derive(Debug)]
pub(crate) struct CpuBuilder {
    kind: IndexKind,
    positions: Vec<[f32; 3]>,
    workspace: Workspace,
}

impl CpuBuilder {
    pub(crate) fn new(kind: IndexKind) -> Self {
        Self { kind, positions: Vec::new(), workspace: Workspace::default() }
    }
}

impl KdTreeBuilder<Cpu> for CpuBuilder {
    fn build(&mut self, on: &mut Cpu, photons: CpuBuffer<Photon>) -> Result<CpuMap> {
        let bad = photons.data.iter().position(|p| p.power.iter().any(|x| !x.is_finite()));
        if let Some(index) = bad {
            return Err(Error::InvalidInput {
                what: "photon",
                index: index as u64,
                why: format!("power {:?} is not finite", photons.data[index].power),
            });
        }
        let (index, arrived) = on.pool.install(|| {
            photons.data.par_iter().with_min_len(4096).map(|p| p.position).collect_into_vec(&mut self.positions);
            let index =
                PointIndex::build_in(&self.positions, self.kind, &mut self.workspace).map_err(|error| match error {
                    crate::index::IndexError::NotFinite { index, position } => Error::InvalidInput {
                        what: "photon",
                        index: index as u64,
                        why: format!("position {position:?} is not finite"),
                    },
                    other => Error::Backend { backend: "cpu: arranging photons", source: Box::new(other) },
                })?;
            let arrived = index
                .order()
                .par_iter()
                .with_min_len(4096)
                .map(|&id| {
                    let photon = &photons.data[id as usize];
                    Arrived {
                        power: photon.power.into(),
                        normal: octahedral::unpack(photon.normal),
                        direction: photon.direction,
                    }
                })
                .collect::<Vec<_>>();
            Ok::<_, Error>((index, arrived))
        })?;
        let bytes = index.bytes() + (arrived.len() * size_of::<Arrived>()) as u64;
        on.note_memory(&format!("map of {}", photons.label), bytes);
        let kept = self.workspace.bytes() + (self.positions.capacity() * size_of::<[f32; 3]>()) as u64;
        on.note_memory("building maps", kept);
        Ok(CpuMap { index, arrived, photons })
    }

    fn reclaim(&mut self, map: CpuMap) -> CpuBuffer<Photon> {
        let mut photons = map.photons;
        photons.clear();
        photons
    }
}

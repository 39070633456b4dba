//! The photon map: photons arranged for search.

pub(crate) mod normals;
pub(crate) mod power;
pub(crate) mod rows;

use photon_core::glam::Vec3;
use photon_core::memory::{self, OutOfMemory};
use photon_core::{Error, IndexKind, KdTreeBuilder, Photon, PhotonFormat, Result, octahedral};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::index::{PointIndex, Workspace};
use crate::map::normals::Normals;

/// A photon map.
#[derive(Debug)]
pub struct CpuMap {
    index: PointIndex,
    /// In index order, as are all the arrays below.
    normals: Normals,
    powers: Powers,
    /// Packed directions towards where the photons came from; empty unless the format is [`PhotonFormat::Full`].
    directions: Vec<u32>,
    photons: CpuBuffer<Photon>,
}

/// Photon powers: one number per photon, or three.
#[derive(Debug)]
pub(crate) enum Powers {
    Grey(Vec<f32>),
    Colour(Vec<Vec3>),
}

impl CpuMap {
    /// The index over the photons' positions.
    #[must_use]
    pub fn index(&self) -> &PointIndex {
        &self.index
    }

    /// The format in which photons are stored.
    #[must_use]
    pub fn photon_format(&self) -> PhotonFormat {
        self.photons.photon_format()
    }

    /// The photons in storage order; `None` unless the format is [`PhotonFormat::Full`].
    #[must_use]
    pub fn photons(&self) -> Option<&[Photon]> {
        (self.photon_format() == PhotonFormat::Full).then(|| self.photons.as_slice())
    }

    /// Calls `visit` with every photon within `radius` of `point` (normalised space) and its squared distance, in
    /// index order. Meant for renderers with their own BSDFs and acceptance rules.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] unless the format is [`PhotonFormat::Full`].
    pub fn for_each_within(&self, point: [f32; 3], radius: f32, mut visit: impl FnMut(&Photon, f32)) -> Result<()> {
        self.photons.check_full()?;
        let photons = self.photons.as_slice();
        let order = self.index.order();
        self.index.within(point, radius * radius, |slot, distance_squared| {
            visit(&photons[order[slot as usize] as usize], distance_squared);
        });
        Ok(())
    }

    /// Calls `visit` with every photon within `radius` of the segment between two ends (normalised space) and its squared distance
    /// from it, exact as by brute force in double precision, in an order that depends only on the arguments.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] unless the format is [`PhotonFormat::Full`].
    pub fn for_each_along(&self, ends: [[f32; 3]; 2], radius: f32, mut visit: impl FnMut(&Photon, f64)) -> Result<()> {
        self.photons.check_full()?;
        let photons = self.photons.as_slice();
        let order = self.index.order();
        self.index.near_segment(ends, radius, |slot, distance_squared| {
            visit(&photons[order[slot as usize] as usize], distance_squared);
        });
        Ok(())
    }

    /// The number of photons.
    pub(crate) fn len(&self) -> usize {
        self.normals.len()
    }

    /// The photon at `index` in storage order; fields that the format does not store are filled in as by
    /// [`CpuBuffer::photon`].
    pub(crate) fn stored(&self, index: usize) -> Photon {
        self.photons.photon(index)
    }

    #[inline]
    pub(crate) fn normal(&self, slot: u32) -> Vec3 {
        self.normals.of(slot)
    }

    /// Whether a photon of a map of media was left in this medium, whose index it has in place of a normal.
    #[inline]
    pub(crate) fn has_medium(&self, slot: u32, index: u32) -> bool {
        self.normals.is(slot, index)
    }

    /// Whether all photons are in the medium with this index, as far as is known.
    pub(crate) fn has_only_medium(&self, index: u32) -> bool {
        self.normals.are(index)
    }

    #[inline]
    pub(crate) fn powers(&self) -> &Powers {
        &self.powers
    }

    /// Requires [`PhotonFormat::Full`].
    #[inline]
    pub(crate) fn direction(&self, slot: u32) -> Vec3 {
        octahedral::unpack(self.packed_direction(slot))
    }

    /// Direction as it is stored; requires [`PhotonFormat::Full`].
    #[inline]
    pub(crate) fn packed_direction(&self, slot: u32) -> u32 {
        self.directions.get(slot as usize).copied().unwrap_or_default()
    }

    /// Direction like [`Self::direction`], but not a unit vector.
    #[inline]
    pub(crate) fn toward(&self, slot: u32) -> Vec3 {
        octahedral::unpack_unnormalized(self.directions.get(slot as usize).copied().unwrap_or_default())
    }

    fn arrange(index: PointIndex, photons: CpuBuffer<Photon>) -> Result<Self, OutOfMemory> {
        let order = index.order();
        let (normals, powers, directions) = match photons.photon_format() {
            PhotonFormat::Mono => {
                let (normals, powers) = in_order(order, &photons, |photon| (photon.normal, photon.power[0]))?;
                (normals, Powers::Grey(powers), Vec::new())
            }
            PhotonFormat::NoDirection => {
                let (normals, powers) = in_order(order, &photons, |photon| (photon.normal, photon.power.into()))?;
                (normals, Powers::Colour(powers), Vec::new())
            }
            PhotonFormat::Full => {
                let (normals, powers) = in_order(order, &photons, |photon| (photon.normal, photon.power.into()))?;
                let (directions, _) = in_order(order, &photons, |photon| (photon.direction, ()))?;
                (normals, Powers::Colour(powers), directions)
            }
        };
        Ok(Self { index, normals: Normals::new(&normals)?, powers, directions, photons })
    }

    /// Size of the search structures, in bytes.
    fn bytes(&self) -> u64 {
        let powers = match &self.powers {
            Powers::Grey(powers) => powers.len() * size_of::<f32>(),
            Powers::Colour(powers) => powers.len() * size_of::<Vec3>(),
        };
        self.index.bytes() + (self.normals.bytes() + powers + self.directions.len() * size_of::<u32>()) as u64
    }
}

/// Collects two parts of every photon in index order. Photons may be scattered in memory, so each is fetched once
/// for both parts.
fn in_order<A: Send, B: Send>(
    order: &[u32],
    photons: &CpuBuffer<Photon>,
    parts: impl Fn(&Photon) -> (A, B) + Sync,
) -> Result<(Vec<A>, Vec<B>), OutOfMemory> {
    let mut first = memory::with_capacity(order.len(), "photon map")?;
    let mut second = memory::with_capacity(order.len(), "photon map")?;
    let both = order.par_iter().with_min_len(4096).map(|&id| parts(&photons.photon(id as usize)));
    both.unzip_into_vecs(&mut first, &mut second);
    Ok((first, second))
}

/// Builds photon maps over an index of the selected kind.
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
        let count = photons.len();
        let bad = (0..count).find(|&index| photons.photon(index).power.iter().any(|x| !x.is_finite()));
        if let Some(index) = bad {
            return Err(Error::InvalidInput {
                what: "photon",
                index: index as u64,
                why: format!("power {:?} is not finite", photons.photon(index).power),
            });
        }
        let label = photons.label;
        let map = on.pool.install(|| {
            let positions = (0..count).into_par_iter().with_min_len(4096).map(|index| photons.photon(index).position);
            self.positions.clear();
            memory::reserve(&mut self.positions, count, "photon positions")?;
            positions.collect_into_vec(&mut self.positions);
            let index =
                PointIndex::build_in(&self.positions, self.kind, &mut self.workspace).map_err(|error| match error {
                    crate::index::IndexError::NotFinite { index, position } => Error::InvalidInput {
                        what: "photon",
                        index: index as u64,
                        why: format!("position {position:?} is not finite"),
                    },
                    crate::index::IndexError::OutOfMemory(refused) => refused.into(),
                    other => Error::Backend { backend: "cpu: building the photon map", source: Box::new(other) },
                })?;
            Ok::<_, Error>(CpuMap::arrange(index, photons)?)
        })?;
        on.note_memory(&format!("map of {label}"), map.bytes());
        let kept = self.workspace.bytes() + (self.positions.capacity() * size_of::<[f32; 3]>()) as u64;
        on.note_memory("building maps", kept);
        Ok(map)
    }

    fn reclaim(&mut self, map: CpuMap) -> CpuBuffer<Photon> {
        let mut photons = map.photons;
        photons.clear();
        photons
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }
}

//! Photon records truncated to a [`PhotonFormat`]: only their first words are stored.

use photon_core::memory::{self, OutOfMemory};
use photon_core::{Photon, PhotonFormat};

/// 32-bit words in a full photon record.
const WORDS: usize = size_of::<Photon>() / 4;

/// Truncated photon records.
#[derive(Debug)]
pub(crate) enum Rows {
    /// Of [`PhotonFormat::Mono`].
    Mono(Vec<[u32; 5]>),
    /// Of [`PhotonFormat::NoDirection`].
    NoDirection(Vec<[u32; 7]>),
}

impl Rows {
    /// Allocates room for `count` photons; `None` for [`PhotonFormat::Full`].
    pub(crate) fn with_capacity(
        photon_format: PhotonFormat,
        count: usize,
        label: &'static str,
    ) -> Result<Option<Self>, OutOfMemory> {
        Ok(match photon_format {
            PhotonFormat::Mono => Some(Self::Mono(memory::with_capacity(count, label)?)),
            PhotonFormat::NoDirection => Some(Self::NoDirection(memory::with_capacity(count, label)?)),
            PhotonFormat::Full => None,
        })
    }

    pub(crate) fn photon_format(&self) -> PhotonFormat {
        match self {
            Self::Mono(_) => PhotonFormat::Mono,
            Self::NoDirection(_) => PhotonFormat::NoDirection,
        }
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Mono(rows) => rows.len(),
            Self::NoDirection(rows) => rows.len(),
        }
    }

    pub(crate) fn clear(&mut self) {
        match self {
            Self::Mono(rows) => rows.clear(),
            Self::NoDirection(rows) => rows.clear(),
        }
    }

    /// Appends photons, truncated to the format.
    pub(crate) fn append(&mut self, photons: &[Photon]) {
        match self {
            Self::Mono(rows) => rows.extend(photons.iter().map(front)),
            Self::NoDirection(rows) => rows.extend(photons.iter().map(front)),
        }
    }

    /// A photon with direction 0; a mono photon has the same power in every channel.
    #[inline]
    pub(crate) fn get(&self, index: usize) -> Photon {
        match self {
            Self::Mono(rows) => {
                let photon = whole(&rows[index]);
                Photon { power: [photon.power[0]; 3], ..photon }
            }
            Self::NoDirection(rows) => whole(&rows[index]),
        }
    }
}

#[inline]
fn front<const N: usize>(photon: &Photon) -> [u32; N] {
    let words: [u32; WORDS] = bytemuck::cast(*photon);
    std::array::from_fn(|i| words[i])
}

#[inline]
fn whole<const N: usize>(row: &[u32; N]) -> Photon {
    let words: [u32; WORDS] = std::array::from_fn(|i| if i < N { row[i] } else { 0 });
    bytemuck::cast(words)
}

//! Photons of which less than the whole record is stored: as many words from its front on as are kept.

use photon_core::{Kept, Photon};

/// Words of a photon.
const WORDS: usize = size_of::<Photon>() / 4;

/// Records that are cut short.
#[derive(Debug)]
pub(crate) enum Rows {
    /// Of [`Kept::Grey`].
    Grey(Vec<[u32; 5]>),
    /// Of [`Kept::Power`].
    Power(Vec<[u32; 7]>),
}

impl Rows {
    /// With room for so many; `None` of whole records, or if there is no such room.
    pub(crate) fn with_capacity(kept: Kept, count: usize) -> Option<Self> {
        fn room<const N: usize>(count: usize) -> Option<Vec<[u32; N]>> {
            let mut rows = Vec::new();
            rows.try_reserve_exact(count).ok().map(|()| rows)
        }
        match kept {
            Kept::Grey => room(count).map(Self::Grey),
            Kept::Power => room(count).map(Self::Power),
            Kept::Whole => None,
        }
    }

    pub(crate) fn kept(&self) -> Kept {
        match self {
            Self::Grey(_) => Kept::Grey,
            Self::Power(_) => Kept::Power,
        }
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Grey(rows) => rows.len(),
            Self::Power(rows) => rows.len(),
        }
    }

    pub(crate) fn clear(&mut self) {
        match self {
            Self::Grey(rows) => rows.clear(),
            Self::Power(rows) => rows.clear(),
        }
    }

    /// Appends what is kept of some photons.
    pub(crate) fn append(&mut self, photons: &[Photon]) {
        match self {
            Self::Grey(rows) => rows.extend(photons.iter().map(front)),
            Self::Power(rows) => rows.extend(photons.iter().map(front)),
        }
    }

    /// A photon, its direction 0; that of one power has it in every channel.
    #[inline]
    pub(crate) fn get(&self, index: usize) -> Photon {
        match self {
            Self::Grey(rows) => {
                let photon = whole(&rows[index]);
                Photon { power: [photon.power[0]; 3], ..photon }
            }
            Self::Power(rows) => whole(&rows[index]),
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

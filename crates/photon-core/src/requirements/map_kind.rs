//! The kinds of photon maps, and containers with one element per kind.

use bytemuck::Zeroable;
use std::ops::{Index, IndexMut};

use crate::film::Layer;

/// A photon map, classified by the paths of its photons (Jensen 1996).
///
/// To add a map, add a variant: the compiler then reports every match that has to handle it. Packed words
/// on the GPU reserve [`MapKind::BITS`] bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum MapKind {
    /// Photons that come directly from a light.
    Direct,
    /// Photons that came from a light by way of specular surfaces only.
    Caustic,
    /// Photons that were scattered by a diffuse surface before.
    Global,
}

impl MapKind {
    /// All kinds, in the order in which maps are built and read.
    pub const ALL: [Self; 3] = [Self::Direct, Self::Caustic, Self::Global];

    /// Number of kinds.
    pub const COUNT: usize = Self::ALL.len();

    /// Number of bits of a kind next to an ordinal in a packed word: enough for eight kinds.
    pub const BITS: u32 = 3;

    /// Name in reports: `direct`, `caustic`, `global`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Caustic => "caustic",
            Self::Global => "global",
        }
    }

    /// Label of the buffer of its photons, in reports and errors.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Direct => "photons: direct",
            Self::Caustic => "photons: caustic",
            Self::Global => "photons: global",
        }
    }

    /// The layer of the film to which estimates from the map at visible points are added.
    #[must_use]
    pub const fn layer(self) -> Layer {
        match self {
            Self::Direct => Layer::Direct,
            Self::Caustic => Layer::Caustic,
            Self::Global => Layer::Indirect,
        }
    }

    /// The map of a photon stored after `bounce` surfaces, none of them diffuse if `specular_only`.
    #[inline]
    #[must_use]
    pub const fn of_path(specular_only: bool, bounce: u32) -> Self {
        match (specular_only, bounce) {
            (false, _) => Self::Global,
            (true, 0) => Self::Direct,
            (true, _) => Self::Caustic,
        }
    }

    /// Whether the map is filled by the paths aimed at specular surfaces, if there are any.
    #[must_use]
    pub const fn is_aimed(self) -> bool {
        match self {
            Self::Caustic => true,
            Self::Direct | Self::Global => false,
        }
    }
}

const _: () = assert!(MapKind::COUNT <= 1 << MapKind::BITS, "a kind does not fit into its bits");

/// One element per [`MapKind`], in the order of [`MapKind::ALL`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Zeroable)]
pub struct PerMap<T>([T; MapKind::COUNT]);

impl<T> PerMap<T> {
    /// The values of `of` for each kind.
    #[must_use]
    pub fn from_fn(mut of: impl FnMut(MapKind) -> T) -> Self {
        Self(MapKind::ALL.map(&mut of))
    }

    /// The same value for all kinds.
    #[must_use]
    pub const fn splat(value: T) -> Self
    where
        T: Copy,
    {
        Self([value; MapKind::COUNT])
    }

    /// Applies `of` to each element.
    #[must_use]
    pub fn map<U>(self, of: impl FnMut(T) -> U) -> PerMap<U> {
        PerMap(self.0.map(of))
    }

    /// References to all.
    #[must_use]
    pub fn each_ref(&self) -> PerMap<&T> {
        PerMap(self.0.each_ref())
    }

    /// Mutable references to all.
    #[must_use]
    pub fn each_mut(&mut self) -> PerMap<&mut T> {
        PerMap(self.0.each_mut())
    }

    /// All elements, each with its kind.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (MapKind, &T)> {
        MapKind::ALL.into_iter().zip(&self.0)
    }

    /// All elements, each with its kind.
    pub fn iter_mut(&mut self) -> impl DoubleEndedIterator<Item = (MapKind, &mut T)> {
        MapKind::ALL.into_iter().zip(&mut self.0)
    }

    /// All elements.
    pub fn values(&self) -> std::slice::Iter<'_, T> {
        self.0.iter()
    }

    /// All elements.
    pub fn values_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.0.iter_mut()
    }

    /// The elements as an array, in the order of [`MapKind::ALL`].
    #[must_use]
    pub fn into_array(self) -> [T; MapKind::COUNT] {
        self.0
    }
}

impl<T> PerMap<Option<T>> {
    /// A value for one map, `None` for the others.
    #[must_use]
    pub fn only(kind: MapKind, value: T) -> Self {
        let mut all = Self([const { None }; MapKind::COUNT]);
        all[kind] = Some(value);
        all
    }
}

impl PerMap<bool> {
    /// Whether any element is true.
    #[must_use]
    pub fn any(&self) -> bool {
        self.0.contains(&true)
    }

    /// Bit `kind as u32` for each map whose element is true.
    #[must_use]
    pub fn bits(&self) -> u32 {
        self.iter().map(|(kind, &set)| u32::from(set) << kind as u32).sum()
    }
}

impl<T> Index<MapKind> for PerMap<T> {
    type Output = T;

    #[inline]
    fn index(&self, kind: MapKind) -> &T {
        &self.0[kind as usize]
    }
}

impl<T> IndexMut<MapKind> for PerMap<T> {
    #[inline]
    fn index_mut(&mut self, kind: MapKind) -> &mut T {
        &mut self.0[kind as usize]
    }
}

impl<T> IntoIterator for PerMap<T> {
    type Item = (MapKind, T);
    type IntoIter =
        std::iter::Zip<std::array::IntoIter<MapKind, { MapKind::COUNT }>, std::array::IntoIter<T, { MapKind::COUNT }>>;

    fn into_iter(self) -> Self::IntoIter {
        MapKind::ALL.into_iter().zip(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_stand_in_the_order_of_their_numbers() {
        for (number, kind) in MapKind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, number);
            assert!(kind.label().ends_with(kind.name()));
        }
        let numbers = PerMap::from_fn(|kind| kind as u32);
        assert!(numbers.iter().all(|(kind, &number)| number == kind as u32 && numbers[kind] == number));
        assert_eq!(numbers.into_array(), [0, 1, 2]);
    }

    #[test]
    fn a_photon_belongs_to_the_map_of_its_path() {
        assert_eq!(MapKind::of_path(true, 0), MapKind::Direct);
        assert_eq!(MapKind::of_path(true, 3), MapKind::Caustic);
        assert_eq!(MapKind::of_path(false, 1), MapKind::Global);
    }

    #[test]
    fn bits_are_those_of_the_kinds() {
        let set = PerMap::from_fn(|kind| kind != MapKind::Caustic);
        assert_eq!((set.bits(), set.any()), (0b101, true));
        assert!(!PerMap::<bool>::default().any());
        let only = PerMap::only(MapKind::Global, 7);
        assert_eq!(only.map(|value| value.is_some()).bits(), 1 << MapKind::Global as u32);
    }
}

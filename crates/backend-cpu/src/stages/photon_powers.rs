//! The powers of the photons near a point, as its estimate sums them.

use photon_core::glam::Vec3;
use photon_core::{ReflectionLobe, Vectors, gloss_caustics, octahedral, shading_normal};

use crate::index::{Batches, Fold, WIDTH};
use crate::map::CpuMap;
use crate::map::power::Power;

/// Powers of photons, times the factor that the surface at a point gives them.
pub(crate) trait PhotonPowers {
    type Power: Power;

    /// That of the photon in `slot`.
    fn of(&self, map: &CpuMap, slot: u32) -> Self::Power;

    /// Folds slot, squared distance and power of each photon within the squared radius `r2` of `position` that is accepted
    /// into `state`.
    #[inline]
    fn fold_within<T>(
        &self,
        map: &CpuMap,
        (position, r2): ([f32; 3], f32),
        accept: impl Fn(u32) -> bool,
        state: T,
        fold: impl FnMut(T, u32, f32, Self::Power) -> T,
    ) -> T {
        map.index().fold_with(position, r2, state, OneByOne { powers: self, map, accept, fold })
    }
}

struct OneByOne<'a, P: ?Sized, A, F> {
    powers: &'a P,
    map: &'a CpuMap,
    accept: A,
    fold: F,
}

impl<T, P, A, F> Fold<T> for OneByOne<'_, P, A, F>
where
    P: PhotonPowers + ?Sized,
    A: Fn(u32) -> bool,
    F: FnMut(T, u32, f32, P::Power) -> T,
{
    #[inline(always)]
    fn fold(&mut self, state: T, slot: u32, d2: f32) -> T {
        if (self.accept)(slot) { (self.fold)(state, slot, d2, self.powers.of(self.map, slot)) } else { state }
    }
}

/// The stored powers: diffuse, without shading normals.
pub(crate) struct Stored<'a, P>(pub(crate) &'a [P]);

impl<P: Power> PhotonPowers for Stored<'_, P> {
    type Power = P;

    #[inline(always)]
    fn of(&self, _map: &CpuMap, slot: u32) -> P {
        self.0[slot as usize]
    }
}

/// Diffuse, with this shading normal.
pub(crate) struct Shaded<'a>(pub(crate) &'a [Vec3], pub(crate) Vec3);

impl PhotonPowers for Shaded<'_> {
    type Power = Vec3;

    #[inline(always)]
    fn of(&self, map: &CpuMap, slot: u32) -> Vec3 {
        let (Self(powers, shading), geometric) = (self, map.normal(slot));
        // The ratio of a number to itself, and a quotient that the length of the direction cancels from.
        let ratio = match geometric == *shading {
            true => 1.0,
            false => shading_normal::cosine_ratio(map.toward(slot), geometric, *shading),
        };
        powers[slot as usize] * ratio
    }
}

/// The reflection of a glossy surface.
pub(crate) struct Reflected<'a> {
    pub(crate) powers: &'a [Vec3],
    pub(crate) lobe: ReflectionLobe,
    /// Only those photons count that do for the query with this word: [`gloss_caustics::counts`].
    pub(crate) mark: Option<u32>,
}

impl Reflected<'_> {
    #[inline(always)]
    fn counts(&self, direction: u32) -> bool {
        self.mark.is_none_or(|query| gloss_caustics::counts(direction, query))
    }
}

impl PhotonPowers for Reflected<'_> {
    type Power = Vec3;

    #[inline(always)]
    fn of(&self, map: &CpuMap, slot: u32) -> Vec3 {
        match self.counts(map.packed_direction(slot)) {
            true => self.powers[slot as usize] * self.lobe.weight(map.direction(slot), map.normal(slot)),
            false => Vec3::ZERO,
        }
    }

    /// The reflection is evaluated for sixteen photons at a time.
    fn fold_within<T>(
        &self,
        map: &CpuMap,
        (position, r2): ([f32; 3], f32),
        accept: impl Fn(u32) -> bool,
        state: T,
        fold: impl FnMut(T, u32, f32, Vec3) -> T,
    ) -> T {
        let mut batches = ReflectedBatches { reflected: self, map, accept, state: Some(state), fold };
        map.index().batches_within(position, r2, &mut batches);
        batches.state.expect("the state is put back after every batch")
    }
}

/// Fewer photons are evaluated one by one: sixteen at a time take as long as about so many.
const FEW: usize = 5;

struct ReflectedBatches<'a, T, A, F> {
    reflected: &'a Reflected<'a>,
    map: &'a CpuMap,
    accept: A,
    state: Option<T>,
    fold: F,
}

impl<T, A: Fn(u32) -> bool, F: FnMut(T, u32, f32, Vec3) -> T> Batches for ReflectedBatches<'_, T, A, F> {
    #[inline(always)]
    fn accepts(&self, slot: u32) -> bool {
        (self.accept)(slot)
    }

    #[inline(always)]
    fn take(&mut self, slots: &[u32; WIDTH], d2: &[f32; WIDTH], count: usize) {
        // The state is moved out for all of them, so that it stays in registers.
        let Some(mut state) = self.state.take() else { return };
        let packed = slots.map(|slot| self.map.packed_direction(slot));
        if packed[..count].iter().filter(|&&packed| self.reflected.counts(packed)).count() < FEW {
            for (&slot, &d2) in slots[..count].iter().zip(d2) {
                state = (self.fold)(state, slot, d2, self.reflected.of(self.map, slot));
            }
            self.state = Some(state);
            return;
        }
        let (mut toward, mut normals): (Vectors<WIDTH>, Vectors<WIDTH>) = Default::default();
        for lane in 0..WIDTH {
            let normal = self.map.normal(slots[lane]);
            (0..3).for_each(|c| normals[c][lane] = normal[c]);
        }
        for lane in 0..WIDTH {
            let direction = octahedral::unpack(packed[lane]);
            (0..3).for_each(|c| toward[c][lane] = direction[c]);
        }
        let weights = self.reflected.lobe.weights(&toward, &normals);
        for lane in 0..count {
            let slot = slots[lane];
            let power = match self.reflected.counts(packed[lane]) {
                true => self.reflected.powers[slot as usize] * Vec3::from_array(weights.map(|weight| weight[lane])),
                false => Vec3::ZERO,
            };
            state = (self.fold)(state, slot, d2[lane], power);
        }
        self.state = Some(state);
    }
}

#[cfg(test)]
mod tests {
    use photon_core::random::{SplitMix64, unit_f32};
    use photon_core::{Backend as _, IndexKind, KdTreeBuilder as _, Material, MaterialKind, Photon, sampling};

    use super::*;
    use crate::cpu::Cpu;
    use crate::map::{CpuBuilder, Powers};

    /// As the trait does it by itself.
    struct Plain<'a>(&'a Reflected<'a>);

    impl PhotonPowers for Plain<'_> {
        type Power = Vec3;

        fn of(&self, map: &CpuMap, slot: u32) -> Vec3 {
            self.0.of(map, slot)
        }
    }

    /// Photons along a line, 1/64 apart, from directions around the normal; every third is not accepted by its normal.
    fn map(count: usize) -> CpuMap {
        let mut numbers = SplitMix64(11);
        let mut number = || unit_f32(numbers.word() as u32);
        let photons: Vec<Photon> = (0..count)
            .map(|i| Photon {
                position: [i as f32 / 64.0, 0.0, 0.0],
                direction: octahedral::pack(sampling::about(Vec3::Z, 1.5 * number() - 0.5, number())),
                power: [number(), number(), number()],
                normal: octahedral::pack(if i % 3 == 0 { Vec3::X } else { Vec3::Z }),
            })
            .collect();
        let mut on = Cpu::with_threads(1).unwrap();
        let photons = on.upload("photons", &photons).unwrap();
        CpuBuilder::new(IndexKind::Vvh).build(&mut on, photons).unwrap()
    }

    #[test]
    fn sixteen_at_a_time_are_the_same_in_the_same_order() {
        let map = map(200);
        let Powers::Colour(powers) = map.powers() else { panic!("full photons have colours") };
        let material = Material {
            kind: MaterialKind::Glossy as u32,
            albedo: [0.9, 0.5, 0.1],
            metallic: 1.0,
            roughness: 0.6,
            ..Material::default()
        };
        let words = ReflectionLobe::pack(&material, &photon_core::Layers::NONE).0;
        let lobe = ReflectionLobe::new(words, sampling::about(Vec3::Z, 0.7, 0.2), Vec3::Z);
        let mut counts = Vec::new();
        for mark in [None, Some(0), Some(1)] {
            let reflected = Reflected { powers, lobe, mark };
            // One more photon with each radius: none, one, 16 and 17 that are accepted among them.
            for i in 0..60 {
                let within = ([0.0, 0.01, 0.0], (i as f32 / 64.0).powi(2));
                let accept = |slot: u32| map.normal(slot) == Vec3::Z;
                let note = |mut all: Vec<(u32, u32, [u32; 3])>, slot, d2: f32, power: Vec3| {
                    all.push((slot, d2.to_bits(), power.to_array().map(f32::to_bits)));
                    all
                };
                let found = reflected.fold_within(&map, within, accept, Vec::new(), note);
                let expected = Plain(&reflected).fold_within(&map, within, accept, Vec::new(), note);
                assert_eq!(found, expected, "{mark:?} {i}");
                counts.push(found.len());
            }
        }
        assert!([0, 1, 16, 17, 32].iter().all(|count| counts.contains(count)), "{counts:?}");
    }
}

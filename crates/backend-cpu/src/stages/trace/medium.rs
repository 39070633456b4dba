//! Photons in media that scatter light.

use photon_core::flight::{self, FOCUSED_DEPOSITS, Flight};
use photon_core::glam::Vec3;
use photon_core::phase::Phase;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{MapKind, Medium, MediumStack, Pass, PerMap, Photon, PhotonRay, RandomKind, Ray, octahedral};

use super::{PhotonList, Walk};
use crate::stretches::Stretch;

/// Bit of the blocks of aimed paths, whose numbers may be those of other paths.
const AIMED_BLOCKS: u32 = 1 << 31;

/// Bits of blocks below the number of a stretch of the ray, which has as many numbers as there are bits up to that of aimed paths.
const STRETCH_BITS: u32 = 18;
const MOST_STRETCHES: u32 = (1 << (31 - STRETCH_BITS)) - 1;

/// Largest number below 1.
const LAST_PLACE: f32 = 1.0 - f32::EPSILON / 2.0;

/// A ray of a path up to its next surface.
#[derive(Clone, Copy)]
pub(super) struct Flown {
    pub(super) ray: Ray,
    /// Distance of the surface; infinite without one.
    pub(super) end: f32,
    pub(super) media: MediumStack,
    /// Number of surfaces before.
    pub(super) bounce: u32,
    pub(super) specular_only: bool,
}

/// Outcome of a flight.
pub(super) enum Crossing {
    /// It reaches the end.
    Passes,
    /// It is scattered, and goes on along this ray.
    Collides(Ray),
    /// It ends.
    Absorbed,
    /// It ends far from the scene, and others stand for it: `power` is 0.
    Thinned,
}

/// The part of a path's state that belongs to media.
pub(super) struct MediumWalk {
    flights: Sampler,
    deposits: Sampler,
    /// Power at the start of the path.
    start: Vec3,
    is_aimed: bool,
    /// Number of collisions so far.
    pub(super) collisions: u32,
}

impl MediumWalk {
    #[inline(always)]
    pub(super) fn new(pass: Pass, ray: &PhotonRay, is_aimed: bool) -> Self {
        let sampler = |domain| Sampler::new(RandomKind::Counter, pass.seed, pass.index, domain, ray.path);
        let [flights, deposits] = [Domain::Flight, Domain::Deposit].map(sampler);
        Self { flights, deposits, start: ray.power.into(), is_aimed, collisions: 0 }
    }

    /// Follows a ray through its media: changes `power` to what goes on, and leaves photons in `photons`. Aimed paths never
    /// collide: the power of those that would is left out.
    #[inline(never)]
    pub(super) fn fly(
        &mut self,
        walk: &Walk<'_>,
        flown: &Flown,
        power: &mut Vec3,
        photons: &mut PerMap<PhotonList>,
    ) -> Crossing {
        let mut number = 0;
        for stretch in walk.scene.stretches(&flown.ray, flown.end, flown.media) {
            let medium = walk.scene.medium_at(stretch.medium);
            if medium.scatters() {
                match self.cross(walk, (flown, &stretch, number << STRETCH_BITS), power, photons) {
                    Crossing::Passes => number = (number + 1) & MOST_STRETCHES,
                    ends => return ends,
                }
            } else if medium.attenuates() {
                *power *= walk.scene.stretch_transmittance(&flown.ray, &stretch);
            }
        }
        Crossing::Passes
    }

    /// Follows a ray through one stretch whose medium scatters light, for [`Self::fly`].
    fn cross(
        &mut self,
        walk: &Walk<'_>,
        (flown, stretch, block): (&Flown, &Stretch, u32),
        power: &mut Vec3,
        photons: &mut PerMap<PhotonList>,
    ) -> Crossing {
        let Flown { ray, bounce, specular_only, .. } = *flown;
        let event = bounce + self.collisions;
        let (scene, medium) = (walk.scene, walk.scene.medium_at(stretch.medium));
        let [channel, length, roulette, thinning] = self.flights.words(block + 2 * event);
        let drawn =
            if self.is_aimed { f32::INFINITY } else { flight::length(medium, *power, [channel, length].map(unit_f32)) };
        let (reached, place) = scene.until(&ray, stretch, stretch.from, drawn);
        let grid = scene.grid(stretch.medium);
        let collides = if grid.is_some() { reached >= drawn } else { reached < stretch.to - stretch.from };
        let ended = flight::ended(medium, *power, collides, reached);
        // Shadow rays find light that comes straight from a light source.
        let kind = MapKind::of_path(specular_only, bounce);
        if event > 0 && walk.wanted_in_media[kind] {
            let mut store = |distance: f32, power: Vec3| {
                photons[kind].push(Photon {
                    position: (ray.origin + ray.direction * distance).into(),
                    normal: stretch.medium,
                    power: power.into(),
                    direction: octahedral::pack(-ray.direction),
                });
            };
            if grid == Some(true) && !specular_only {
                if let Flight::Collides(found) = &ended
                    && found.albedo > 0.0
                {
                    store(place, found.power * found.albedo);
                }
            } else {
                // Walks through a grid go on where the flight ended.
                let (before, start) = if collides && grid.is_some() { (reached, place) } else { (0.0, stretch.from) };
                let rest = || scene.until(&ray, stretch, start, f32::INFINITY).0;
                let column = if collides { before + rest() } else { reached };
                if column > 0.0 {
                    for (within, power) in self.deposited(medium, (flown, block), column, *power) {
                        let from = if within < before { (stretch.from, within) } else { (start, within - before) };
                        store(scene.until(&ray, stretch, from.0, from.1).1, power);
                    }
                }
            }
        }
        if self.is_aimed {
            *power *= flight::transmittance(medium, reached);
            return Crossing::Passes;
        }
        let found = match ended {
            Flight::Passes(left) => {
                *power = left;
                return Crossing::Passes;
            }
            Flight::Collides(found) => found,
        };
        if !(unit_f32(roulette) < found.albedo) {
            return Crossing::Absorbed;
        }
        *power = found.power;
        let [u, v, ..] = self.flights.words(block + 2 * event + 1);
        let direction = Phase::of(medium).sample(ray.direction, [u, v].map(unit_f32));
        self.collisions += 1;
        let origin = ray.origin + ray.direction * place;
        // The medium around everything has no bounds.
        if stretch.medium == 0 {
            let left = flight::thinned(*power, self.start, origin, unit_f32(thinning));
            *power = left.unwrap_or(Vec3::ZERO);
            if left.is_none() {
                return Crossing::Thinned;
            }
        }
        Crossing::Collides(Ray { origin, direction, t_max: f32::INFINITY })
    }

    /// The columns and powers of the photons of a stretch with a column > 0: several where the light may be focused.
    fn deposited<'m>(
        &self,
        medium: &'m Medium,
        (flown, block): (&Flown, u32),
        column: f32,
        power: Vec3,
    ) -> impl Iterator<Item = (f32, Vec3)> + 'm {
        let count = if flown.specular_only { FOCUSED_DEPOSITS } else { 1 };
        let block = block + flown.bounce + self.collisions + if self.is_aimed { AIMED_BLOCKS } else { 0 };
        let mut deposits = self.deposits;
        let [channel, place, ..] = deposits.words(block).map(unit_f32);
        (0..count).map(move |number| {
            // Rounding may give 1, which is infinitely far in a dense medium.
            let place = ((number as f32 + place) / count as f32).min(LAST_PLACE);
            flight::deposit(medium, power, column, count, [channel, place])
        })
    }
}

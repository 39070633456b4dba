//! Radiance estimates together with moments of the same photons, from which the error is estimated.

use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

use photon_core::{ErrorMoments, Estimate, EstimateParams, PhotonMoments, sampling};

use crate::map::power::Power;
use crate::map::{CpuMap, Powers};
use crate::stages::estimate::{PowerFactor, Sum, VisiblePoint};
use crate::stages::photon_powers::{PhotonPowers, Reflected, Shaded, Stored};

/// The estimate of `Search::Radius`, identical to the bit, and the error moments of the photons within √2 times the
/// radius.
pub(crate) fn estimate_with_moments_at(
    map: &CpuMap,
    point: VisiblePoint,
    gather: &EstimateParams,
) -> (Estimate, ErrorMoments) {
    fn either<P: PhotonPowers>(
        map: &CpuMap,
        powers: P,
        point: VisiblePoint,
        gather: &EstimateParams,
    ) -> (Estimate, ErrorMoments) {
        match gather.is_flat() {
            false => estimate_with_moments_of::<false, _>(map, powers, point, gather),
            true => estimate_with_moments_of::<true, _>(map, powers, point, gather),
        }
    }
    match (map.powers(), point.factor) {
        (Powers::Grey(powers), _) => either(map, Stored(powers), point, gather),
        (Powers::Colour(powers), PowerFactor::Even) => either(map, Stored(powers), point, gather),
        (Powers::Colour(powers), PowerFactor::Shaded(shading)) => either(map, Shaded(powers, shading), point, gather),
        (Powers::Colour(powers), PowerFactor::Reflected { lobe, mark }) => {
            either(map, Reflected { powers, lobe, mark }, point, gather)
        }
    }
}

/// As [`estimate_with_moments_at`], for one type of power. If `FLAT`, only photons near the query's plane are used;
/// the maximum distance from the plane scales with each radius.
fn estimate_with_moments_of<const FLAT: bool, P: PhotonPowers>(
    map: &CpuMap,
    powers: P,
    point: VisiblePoint,
    gather: &EstimateParams,
) -> (Estimate, ErrorMoments) {
    let normal = point.normal;
    let radius_squared = point.radius * point.radius;
    let most = gather.max_plane_distance * point.radius;
    let sum = Sum::new(radius_squared);
    let scale = 1.0 / sum.radius_squared;
    let wide_squared = 2.0 * radius_squared;
    let reach = 1.0 / (2.0 * sum.radius_squared).sqrt();
    let (tangent, bitangent) = sampling::basis(normal);
    let state = (sum, Sums::<<P::Power as Power>::Sum>::default());
    let within = (point.position, wide_squared);
    let (sum, sums) = powers.fold_within(
        map,
        within,
        |_| true,
        state,
        |(mut sum, mut sums), slot, d2, carried| {
            let power = f64::from(carried.mean());
            let off = if FLAT { point.off_plane(map, slot) } else { 0.0 };
            if map.normal(slot).dot(normal) < gather.min_normal_cosine || (FLAT && off > SQRT_2 * most) {
                sums.stray += power;
                return (sum, sums);
            }
            let u = d2 * scale;
            if d2 <= radius_squared && !(FLAT && off > most) {
                sum = sum.and(carried, gather.kernel.weight(u.min(1.0)));
                if 2.0 * u <= 1.0 && !(FLAT && off > FRAC_1_SQRT_2 * most) {
                    carried.add(&mut sums.narrow, gather.kernel.weight(2.0 * u));
                }
            }
            carried.add(&mut sums.wide, gather.kernel.weight((0.5 * u).min(1.0)));
            let offset = point.to(map, slot) * reach;
            if offset.dot(normal).abs() > PhotonMoments::OFF_PLANE {
                sums.stray += power;
            }
            sums.add(power, [offset.dot(tangent), offset.dot(bitangent)]);
            (sum, sums)
        },
    );
    (sum.finish(), sums.finish(P::Power::rgb))
}

/// [`ErrorMoments`], accumulated in f64.
#[derive(Default)]
pub(super) struct Sums<F> {
    pub(super) wide: F,
    pub(super) narrow: F,
    power: f64,
    power_squared: f64,
    slope: [f64; 2],
    quadrupole: [f64; 2],
    pub(super) stray: f64,
    photons: u32,
}

impl<F> Sums<F> {
    /// Adds a photon of this mean power to the sums of the distribution, at its offset in units of the wide radius.
    pub(super) fn add(&mut self, power: f64, offset: [f32; 2]) {
        let [x, y] = offset.map(f64::from);
        self.power += power;
        self.power_squared += power * power;
        self.slope = [self.slope[0] + power * x, self.slope[1] + power * y];
        self.quadrupole = [self.quadrupole[0] + power * (x * x - y * y), self.quadrupole[1] + power * 2.0 * x * y];
        self.photons += 1;
    }

    pub(super) fn finish(self, rgb: impl Fn(F) -> [f64; 3]) -> ErrorMoments {
        ErrorMoments {
            wide: rgb(self.wide).map(|x| x as f32),
            power: self.power as f32,
            narrow: rgb(self.narrow).map(|x| x as f32),
            power_squared: self.power_squared as f32,
            slope: self.slope.map(|x| x as f32),
            quadrupole: self.quadrupole.map(|x| x as f32),
            stray: self.stray as f32,
            photons: self.photons,
            reserved: [0; 2],
        }
    }
}

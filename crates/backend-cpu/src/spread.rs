//! An estimate, and what the same photons say about its error.

use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

use photon_core::glam::Vec3;
use photon_core::{Estimate, Gather, Spread, sampling};

use crate::estimate::{Sum, off_plane};
use crate::map::CpuMap;

/// A photon farther from the query's plane than this share of the wide radius is on another surface.
const OFF_PLANE: f32 = 0.25;

/// The estimate of `Rule::Radius`, to the bit, and what the photons within √2 times the radius tell.
pub(crate) fn spread_at(
    map: &CpuMap,
    position: [f32; 3],
    normal: Vec3,
    radius: f32,
    gather: &Gather,
) -> (Estimate, Spread) {
    if gather.is_flat() {
        spread::<true>(map, position, normal, radius, gather)
    } else {
        spread::<false>(map, position, normal, radius, gather)
    }
}

/// The same; if `FLAT`, of photons near the query's plane, each radius with its own share of itself.
fn spread<const FLAT: bool>(
    map: &CpuMap,
    position: [f32; 3],
    normal: Vec3,
    radius: f32,
    gather: &Gather,
) -> (Estimate, Spread) {
    let radius_squared = radius * radius;
    let most = gather.max_plane_distance * radius;
    let sum = Sum::new(radius_squared);
    let scale = 1.0 / sum.radius_squared;
    let wide_squared = 2.0 * radius_squared;
    let reach = 1.0 / (2.0 * sum.radius_squared).sqrt();
    let (tangent, bitangent) = sampling::basis(normal);
    let state = (sum, Sums::default());
    let (sum, sums) = map.index().fold_within(position, wide_squared, state, |(mut sum, mut sums), slot, d2| {
        let arrived = map.arrived(slot);
        let power = f64::from((arrived.power.x + arrived.power.y + arrived.power.z) * (1.0 / 3.0));
        let off = if FLAT { off_plane(map, slot, position, normal) } else { 0.0 };
        if arrived.normal.dot(normal) < gather.min_normal_cosine || (FLAT && off > SQRT_2 * most) {
            sums.stray += power;
            return (sum, sums);
        }
        let u = d2 * scale;
        if d2 <= radius_squared && !(FLAT && off > most) {
            sum = sum.and(arrived.power, gather.kernel.weight(u.min(1.0)));
            if 2.0 * u <= 1.0 && !(FLAT && off > FRAC_1_SQRT_2 * most) {
                add(&mut sums.narrow, arrived.power, gather.kernel.weight(2.0 * u));
            }
        }
        add(&mut sums.wide, arrived.power, gather.kernel.weight((0.5 * u).min(1.0)));
        let offset = (Vec3::from(map.index().position(slot)) - Vec3::from(position)) * reach;
        if offset.dot(normal).abs() > OFF_PLANE {
            sums.stray += power;
        }
        let (x, y) = (f64::from(offset.dot(tangent)), f64::from(offset.dot(bitangent)));
        sums.power += power;
        sums.power_squared += power * power;
        sums.slope = [sums.slope[0] + power * x, sums.slope[1] + power * y];
        sums.stretch = [sums.stretch[0] + power * (x * x - y * y), sums.stretch[1] + power * 2.0 * x * y];
        sums.photons += 1;
        (sum, sums)
    });
    (sum.finish(), sums.finish())
}

fn add(sum: &mut [f64; 3], power: Vec3, weight: f32) {
    for (sum, p) in sum.iter_mut().zip(power.to_array()) {
        *sum += f64::from(p) * f64::from(weight);
    }
}

/// [`Spread`] in f64.
#[derive(Default)]
struct Sums {
    wide: [f64; 3],
    narrow: [f64; 3],
    power: f64,
    power_squared: f64,
    slope: [f64; 2],
    stretch: [f64; 2],
    stray: f64,
    photons: u32,
}

impl Sums {
    fn finish(self) -> Spread {
        Spread {
            wide: self.wide.map(|x| x as f32),
            power: self.power as f32,
            narrow: self.narrow.map(|x| x as f32),
            power_squared: self.power_squared as f32,
            slope: self.slope.map(|x| x as f32),
            stretch: self.stretch.map(|x| x as f32),
            stray: self.stray as f32,
            photons: self.photons,
            reserved: [0; 2],
        }
    }
}

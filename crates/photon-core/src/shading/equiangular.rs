//! Places on a segment for light from a point: in proportion to the inverse square of the distance (Kulla and Fajardo 2012),
//! or to the transmittance.

use std::f32::consts::TAU;

use glam::Vec3;

use crate::shading::math;

/// Angles under which a point sees a segment.
#[derive(Clone, Copy, Debug)]
pub struct Equiangular {
    /// Distance of the point from the line.
    height: f32,
    /// Position of the start of the segment relative to the foot of the point, along the line.
    start: f32,
    /// Angle between both ends, in turns.
    turns: f32,
}

impl Equiangular {
    /// For a segment of length `end` from `origin` along the unit vector `direction`, seen from `point`.
    #[inline]
    #[must_use]
    pub fn new(origin: Vec3, direction: Vec3, end: f32, point: Vec3) -> Self {
        let gap = point - origin;
        let foot = gap.dot(direction);
        // A point on the line sees a line beside it.
        let height = (gap - direction * foot).length().max(1e-6);
        let start = -foot;
        // The angle itself instead of a difference of two, which loses digits for segments far away.
        let turns = math::turns_of(height * end, height * height + start * (start + end));
        Self { height, start, turns }
    }

    /// Distance from the start of the segment for `u` in `[0, 1)`.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: f32) -> f32 {
        let (sine, cosine) = math::sin_cos_turns(u * self.turns);
        let squared = self.height * self.height + self.start * self.start;
        (sine * squared / (self.height * cosine - self.start * sine).max(f32::MIN_POSITIVE)).max(0.0)
    }

    /// Density of a distance.
    #[inline]
    #[must_use]
    pub fn density(&self, distance: f32) -> f32 {
        let along = self.start + distance;
        self.height / (TAU * self.turns * (self.height * self.height + along * along))
    }
}

/// Distance along a segment of length `end`, in proportion to the transmittance for the coefficient `extinction`.
#[inline]
#[must_use]
pub fn exponential(extinction: f32, end: f32, u: f32) -> f32 {
    let collides = math::one_minus_exp(extinction * end);
    if collides > 1e-20 { (math::minus_ln_one_minus(u * collides) / extinction).min(end) } else { u * end }
}

/// Density of a distance of [`exponential`].
#[inline]
#[must_use]
pub fn exponential_density(extinction: f32, end: f32, distance: f32) -> f32 {
    let collides = math::one_minus_exp(extinction * end);
    if collides > 1e-20 { extinction * math::exp_neg(extinction * distance) / collides } else { 1.0 / end }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Densities integrate to 1, and the share of samples before a distance is that of the density.
    #[test]
    fn densities_are_those_of_the_samples() {
        for (end, point) in [
            (1.0, Vec3::new(0.3, 0.2, 0.0)),
            (50.0, Vec3::new(10.0, 0.1, 0.0)),
            (1e-3, Vec3::new(0.0, 4.0, 0.0)),
            (2.0, Vec3::new(-3.0, 0.5, 0.0)),
            (2.0, Vec3::new(7.0, 0.0, 0.0)),
        ] {
            let angles = Equiangular::new(Vec3::ZERO, Vec3::X, end, point);
            let check = |name: &str, sample: &dyn Fn(f32) -> f32, density: &dyn Fn(f32) -> f32| {
                for step in 1..256 {
                    let (before, after) = ((step as f32 - 0.5) / 256.0, (step as f32 + 0.5) / 256.0);
                    let (low, high) = (sample(before), sample(after));
                    let middle = sample(step as f32 / 256.0);
                    assert!(
                        0.0 <= low && low <= middle && middle <= high && high <= end * 1.00001,
                        "{name} {end} {point}"
                    );
                    // Of the mean by Simpson's rule.
                    let mean =
                        (f64::from(density(low)) + 4.0 * f64::from(density(middle)) + f64::from(density(high))) / 6.0;
                    let uneven = f64::from(middle - low) / f64::from(high - low);
                    if (uneven - 0.5).abs() < 0.02 {
                        let share = mean * f64::from(high - low);
                        assert!((share * 256.0 - 1.0).abs() < 0.01, "{name} {end} {point} {step}: {share}");
                    }
                }
            };
            check("equiangular", &|u| angles.sample(u), &|t| angles.density(t));
            for extinction in [0.0, 1e-6, 0.3, 20.0] {
                check("exponential", &|u| exponential(extinction, end, u), &|t| {
                    exponential_density(extinction, end, t)
                });
            }
        }
    }
}

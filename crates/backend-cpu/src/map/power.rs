//! Photon power: three channels, or one that stands for all three.

use photon_core::glam::Vec3;

/// A photon's contribution to sums.
pub(crate) trait Power: Copy {
    /// Sum of powers, in f64, so that a million photons add up accurately.
    type Sum: Copy + Default;

    /// Adds `weight` times this power to `sum`.
    fn add(self, sum: &mut Self::Sum, weight: f32);

    /// Mean over the channels.
    fn mean(self) -> f32;

    /// The channels of `sum`.
    fn rgb(sum: Self::Sum) -> [f64; 3];
}

impl Power for Vec3 {
    type Sum = [f64; 3];

    #[inline]
    fn add(self, sum: &mut [f64; 3], weight: f32) {
        for (sum, p) in sum.iter_mut().zip(self.to_array()) {
            *sum += f64::from(p) * f64::from(weight);
        }
    }

    #[inline]
    fn mean(self) -> f32 {
        (self.x + self.y + self.z) * (1.0 / 3.0)
    }

    fn rgb(sum: [f64; 3]) -> [f64; 3] {
        sum
    }
}

/// Performs the same operations as each of three equal channels, hence gives the same bits.
impl Power for f32 {
    type Sum = f64;

    #[inline]
    fn add(self, sum: &mut f64, weight: f32) {
        *sum += f64::from(self) * f64::from(weight);
    }

    #[inline]
    fn mean(self) -> f32 {
        (self + self + self) * (1.0 / 3.0)
    }

    fn rgb(sum: f64) -> [f64; 3] {
        [sum; 3]
    }
}

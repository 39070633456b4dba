//! Power of photons: three channels, or one that stands for all of them.

use photon_core::glam::Vec3;

/// What a photon adds to sums.
pub(crate) trait Power: Copy {
    /// Σ in f64, so that a million photons add up.
    type Sum: Copy + Default;

    /// Adds `weight` times it.
    fn add(self, sum: &mut Self::Sum, weight: f32);

    /// Over the channels.
    fn mean(self) -> f32;

    /// The channels of a sum.
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

/// The same operations as each of three equal channels goes through, hence the same bits.
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

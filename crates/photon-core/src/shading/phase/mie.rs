//! Scattering by droplets of water: a lobe of Henyey and Greenstein, and one of Draine (Jendersie and d'Eon 2023, "An
//! Approximate Mie Scattering Function for Fog and Cloud Rendering").

use super::{henyey_greenstein, henyey_greenstein_versine};
use crate::scene::medium::Medium;

/// Steps of the search for an angle, at most. 10 were the most that were needed.
const MAX_STEPS: u32 = 16;

/// The sum of two lobes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mie {
    /// Mean cosine of the lobe of Henyey and Greenstein, in [0, 1).
    pub forward: f32,
    /// Parameter g of the other lobe, in (0, 1): that lobe is Henyey and Greenstein's times `1 + alpha cos²`, normalised.
    pub draine: f32,
    /// Its parameter α, finite and ≥ 0.
    pub alpha: f32,
    /// Its share of the light, in [0, 1].
    pub share: f32,
}

impl Mie {
    /// Droplets of this diameter in micrometres, from 5 to 50: equations 4 to 7 of the paper.
    #[must_use]
    pub fn droplets(micrometres: f64) -> Self {
        let d = micrometres;
        let forward = libm::exp(-0.099_056_7 / (d - 1.671_54));
        let draine = libm::exp(-2.206_79 / (d + 3.910_29) - 0.428_934);
        let alpha = libm::exp(3.624_89 - 8.292_88 / (d + 5.528_25));
        let share = libm::exp(-0.599_085 / (d - 0.641_583) - 0.665_888);
        Self { forward: forward as f32, draine: draine as f32, alpha: alpha as f32, share: share as f32 }
    }

    #[inline]
    pub(super) fn of(medium: &Medium) -> Self {
        let [draine, alpha, share] = medium.draine;
        Self { forward: medium.anisotropy, draine, alpha, share }
    }

    pub(super) fn mean_cosine(self) -> f32 {
        let Self { forward, draine: g, alpha, share } = self;
        let draine = g * (1.0 + alpha * (3.0 + 2.0 * g * g) / 5.0) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0);
        forward + share * (draine - forward)
    }

    #[inline]
    pub(super) fn value(self, versine: f32) -> f32 {
        let Self { forward, draine: g, alpha, share } = self;
        let cosine = 1.0 - versine;
        let factor = (1.0 + alpha * cosine * cosine) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0);
        (1.0 - share) * henyey_greenstein(forward, versine) + share * (henyey_greenstein(g, versine) * factor)
    }

    /// Versine of an angle with the density [`Self::value`].
    #[inline]
    pub(super) fn versine(self, u: f32) -> f32 {
        if u < self.share {
            return draine_versine(self.draine, self.alpha, 1.0 - u / self.share);
        }
        henyey_greenstein_versine(self.forward, ((u - self.share) / (1.0 - self.share)).min(1.0))
    }
}

/// Versine of an angle with the density of Draine's lobe; a share `u` of the light is scattered by smaller ones.
///
/// With the distance s = √(1 + g² − 2g cos), the density is proportional to (1 + α cos²)/s² in s, whose integral from 1 − g is a
/// rational function. It is inverted by Newton's method within brackets, for d = s − (1 − g): nothing cancels at small angles,
/// and as only sums, products and quotients occur, all devices agree.
#[inline]
pub(super) fn draine_versine(g: f32, alpha: f32, u: f32) -> f32 {
    let (start, middle) = (1.0 - g, 1.0 + g * g);
    let cubic = alpha / (12.0 * g * g);
    let linear = 6.0 * middle * cubic;
    let inverse = 1.0 + 3.0 * middle * middle * cubic;
    let integral = |d: f32| {
        let s = start + d;
        d * (inverse / (start * s) - linear + cubic * (s * s + s * start + start * start))
    };
    let wanted = u * integral(2.0 * g);
    let (mut low, mut high) = (0.0, 2.0 * g);
    let mut d = high * u * u;
    for _ in 0..MAX_STEPS {
        let off = integral(d) - wanted;
        if off > 0.0 {
            high = d;
        } else {
            low = d;
        }
        let s = start + d;
        let cosine = (middle - s * s) / (2.0 * g);
        let newton = d - off * (s * s) / (1.0 + alpha * cosine * cosine);
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        let change = (next - d).abs();
        d = next;
        if change <= 2e-7 * d {
            break;
        }
    }
    d * (2.0 * start + d) / (2.0 * g)
}

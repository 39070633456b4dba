//! Kernels for density estimation on the unit disc.

/// How a photon is weighted by its distance from the query.
///
/// All are weights relative to the constant kernel: an estimate is `Σ W(u)·power / (π r²)` with `u =
/// d²/r²`, and `∫₀¹ W(u) du = 1`, so that each integrates to 1 over the disc (Silverman 1986, section 4.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kernel {
    /// `1`.
    Constant,
    /// `2 (1 − u)`: the smallest error per photon, and zero at the edge of the disc.
    Epanechnikov,
}

impl Kernel {
    /// The weight at `u`, the squared distance divided by the squared radius, in `[0, 1]`.
    #[inline]
    #[must_use]
    pub fn weight(self, u: f32) -> f32 {
        match self {
            Self::Constant => 1.0,
            Self::Epanechnikov => 2.0 * (1.0 - u),
        }
    }

    /// Standard deviation of the difference between estimates with radii r and √2 r from the same photons,
    /// divided by that of the first: the square root of `∫₀² (W(u) − W(u/2)/2)² du / ∫₀¹ W²`; 1/2 for
    /// Epanechnikov's.
    #[must_use]
    pub fn second_radius_noise(self) -> f64 {
        // The midpoint rule, with steps such that the constant kernel's discontinuities fall between them.
        const STEPS: u32 = 1000;
        let mid = |step: u32| (step as f32 + 0.5) / STEPS as f32;
        let (mut difference, mut alone) = (0.0, 0.0);
        for step in 0..2 * STEPS {
            let u = mid(step);
            let inner = if u < 1.0 { f64::from(self.weight(u)) } else { 0.0 };
            difference += (inner - 0.5 * f64::from(self.weight(0.5 * u))).powi(2);
            alone += inner * inner;
        }
        (difference / alone).sqrt()
    }

    /// The number by which shaders identify it: its position in the declaration.
    #[must_use]
    pub fn number(self) -> u32 {
        match self {
            Self::Constant => 0,
            Self::Epanechnikov => 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Kernel; 2] = [Kernel::Constant, Kernel::Epanechnikov];

    /// Integrals of `f(W)` over `u` in `[0, 1]`, by Simpson's rule in `t = √u`, in which all kernels are
    /// smooth.
    fn integral(kernel: Kernel, f: impl Fn(f64) -> f64) -> f64 {
        let steps = 2000;
        let h = 1.0 / f64::from(steps);
        (0..=steps)
            .map(|i| {
                let t = f64::from(i) * h;
                let simpson = if i == 0 || i == steps {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                simpson * 2.0 * t * f(f64::from(kernel.weight((t * t) as f32)))
            })
            .sum::<f64>()
            * h
            / 3.0
    }

    #[test]
    fn each_integrates_to_one() {
        for kernel in ALL {
            let sum = integral(kernel, |w| w);
            assert!((sum - 1.0).abs() < 1e-6, "{kernel:?}: {sum}");
        }
    }

    /// Roughness R(K) of closed-forms A6 is `E[W²]/π`.
    #[test]
    fn roughness_is_as_tabulated() {
        for (kernel, roughness) in [(Kernel::Constant, std::f64::consts::FRAC_1_PI), (Kernel::Epanechnikov, 0.424_413)]
        {
            let r = integral(kernel, |w| w * w) / std::f64::consts::PI;
            assert!((r - roughness).abs() < 2e-6, "{kernel:?}: {r}");
        }
    }

    #[test]
    fn noise_of_the_second_radius_is_the_closed_form() {
        assert!((Kernel::Epanechnikov.second_radius_noise() - 0.5).abs() < 1e-5);
        assert!((Kernel::Constant.second_radius_noise() - 0.5_f64.sqrt()).abs() < 1e-5);
    }
}

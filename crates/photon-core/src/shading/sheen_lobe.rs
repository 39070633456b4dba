//! The lobe of a sheen, without layers below ([`crate::sheen`]), and its albedo; `sheen_lobe.glsl` is the twin.

use std::f32::consts::FRAC_1_PI;
use std::sync::LazyLock;

use glam::Vec3;

use crate::parallel;
use crate::shading::math::{cube_root, exp_neg, ln};

/// The least roughness; lower ones are rendered as this.
pub const MIN_ROUGHNESS: f32 = 0.07;

/// The least cosine at which Λ, visibility and albedo are evaluated; lower ones count as this.
pub const MIN_COSINE: f32 = 1e-3;

/// The distribution and visibility of one roughness, with Λ and the limit of the direction that a path comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Charlie {
    alpha: f32,
    pub(super) roughness: f32,
    /// Coefficients of Λ.
    fit: [f32; 5],
    lambda: f32,
    /// E in the direction of the path.
    pub(super) albedo: f32,
}

/// Coefficients of the fit of Λ at α = 1 and at α = 0.
const FIT: [[f32; 2]; 5] =
    [[21.5473, 25.3245], [3.82987, 3.32435], [0.19823, 0.16801], [-1.97760, -1.27393], [-4.32054, -4.85967]];

/// The exponent of Λ.
#[inline]
fn exponent(fit: &[f32; 5], x: f32) -> f32 {
    let [a, b, c, d, e] = *fit;
    // Above 0 for the logarithm.
    let power = exp_neg(-c * ln(x.max(1e-30)));
    a / (1.0 + b * power) + d * x + e
}

#[inline]
fn exp(x: f32) -> f32 {
    if x > 0.0 { 1.0 / exp_neg(x) } else { exp_neg(-x) }
}

/// Λ for a direction with this cosine.
#[inline]
fn lambda(fit: &[f32; 5], cosine: f32) -> f32 {
    let x = cosine.clamp(MIN_COSINE, 1.0);
    if x < 0.5 { exp(exponent(fit, x)) } else { exp(2.0 * exponent(fit, 0.5) - exponent(fit, 1.0 - x)) }
}

impl Charlie {
    /// The lobe of this roughness for a path that comes from a direction with this cosine.
    #[inline]
    pub(crate) fn new(roughness: f32, cosine: f32) -> Self {
        let roughness = roughness.max(MIN_ROUGHNESS);
        let alpha = roughness * roughness;
        let weight = (1.0 - alpha) * (1.0 - alpha);
        let fit = FIT.map(|[one, zero]| one + (zero - one) * weight);
        let albedo = SheenTable::get().directional(cosine, roughness);
        Self { alpha, roughness, fit, lambda: lambda(&fit, cosine), albedo }
    }

    /// D V of light from `i` towards `o`, in the frame of the normal, limited.
    #[inline]
    pub(crate) fn evaluate(&self, o: Vec3, i: Vec3, h: Vec3) -> f32 {
        let sine_squared = (1.0 - h.z * h.z).clamp(1e-30, 1.0);
        let half = 0.5 / self.alpha;
        let distribution = (2.0 + 2.0 * half) * exp_neg(-half * ln(sine_squared)) * (0.5 * FRAC_1_PI);
        let cosines = o.z.max(MIN_COSINE) * i.z.max(MIN_COSINE);
        let visibility = 0.25 / ((1.0 + self.lambda + lambda(&self.fit, i.z)) * cosines);
        let other = SheenTable::get().directional(i.z, self.roughness);
        distribution * visibility / self.albedo.max(other).max(1.0)
    }

    /// What a sheen of this strength lets through in a direction with this cosine.
    #[inline]
    pub(super) fn through_at(&self, strength: f32, cosine: f32) -> f32 {
        1.0 - strength * SheenTable::get().directional(cosine, self.roughness).min(1.0)
    }
}

/// E by cosine and roughness.
#[derive(Debug)]
pub struct SheenTable {
    /// Row by roughness, column by cosine.
    entries: Vec<f32>,
}

static TABLE: LazyLock<SheenTable> = LazyLock::new(SheenTable::compute);

/// Points of the quadrature over the cosine and the angle around.
const ACROSS: usize = 64;
const AROUND: usize = 24;

impl SheenTable {
    /// Entries along each axis.
    pub const SIZE: usize = 64;

    /// The table, computed at first use by all cores: some 200 milliseconds of processor time.
    #[must_use]
    pub fn get() -> &'static Self {
        &TABLE
    }

    /// All entries: [`Self::SIZE`] rows of that many columns.
    #[must_use]
    pub fn entries(&self) -> &[f32] {
        &self.entries
    }

    /// E for a direction with this cosine, at a roughness in `[0, 1]`.
    #[inline]
    #[must_use]
    pub fn directional(&self, cosine: f32, roughness: f32) -> f32 {
        let last = (Self::SIZE - 1) as f32;
        let place = |coordinate: f32| {
            let at = coordinate * last;
            let first = (at as usize).min(Self::SIZE - 2);
            (first, at - first as f32)
        };
        let (column, across) = place(cube_root(cosine.clamp(MIN_COSINE, 1.0)));
        let (row, down) = place(((roughness - MIN_ROUGHNESS).max(0.0) / (1.0 - MIN_ROUGHNESS)).sqrt());
        let at = |row: usize| {
            let first = row * Self::SIZE + column;
            self.entries[first] * (1.0 - across) + self.entries[first + 1] * across
        };
        at(row) * (1.0 - down) + at(row + 1) * down
    }

    fn compute() -> Self {
        let last = (Self::SIZE - 1) as f64;
        let rows = parallel::map(parallel::threads(), 0..Self::SIZE, |_, row| {
            let root = row as f64 / last;
            let least = f64::from(MIN_ROUGHNESS);
            let quadrature = Quadrature::new(least + (1.0 - least) * root * root);
            let albedo = |column: usize| {
                let root = column as f64 / last;
                quadrature.albedo((root * root * root).max(f64::from(MIN_COSINE))) as f32
            };
            std::array::from_fn::<f32, { Self::SIZE }, _>(albedo)
        });
        Self { entries: rows.into_iter().flatten().collect() }
    }
}

/// E of one roughness by a quadrature over directions, dense where they graze.
struct Quadrature {
    alpha: f64,
    fit: [f64; 5],
    /// Cosine, weight and Λ of each ring.
    rings: Vec<[f64; 3]>,
}

impl Quadrature {
    fn new(roughness: f64) -> Self {
        let alpha = roughness * roughness;
        let weight = (1.0 - alpha) * (1.0 - alpha);
        let fit = FIT.map(|[one, zero]| f64::from(one) + f64::from(zero - one) * weight);
        let mut of = Self { alpha, fit, rings: Vec::new() };
        of.rings = (0..ACROSS)
            .map(|k| {
                let root = (k as f64 + 0.5) / ACROSS as f64;
                let cosine = root * root;
                [cosine, 2.0 * root / ACROSS as f64 * cosine, of.lambda(cosine)]
            })
            .collect();
        of
    }

    fn lambda(&self, cosine: f64) -> f64 {
        let exponent = |x: f64| {
            let [a, b, c, d, e] = self.fit;
            a / (1.0 + b * libm::pow(x, c)) + d * x + e
        };
        let x = cosine.max(f64::from(MIN_COSINE));
        if x < 0.5 { libm::exp(exponent(x)) } else { libm::exp(2.0 * exponent(0.5) - exponent(1.0 - x)) }
    }

    fn albedo(&self, cosine: f64) -> f64 {
        let least = f64::from(MIN_COSINE);
        let (sine, own) = ((1.0 - cosine * cosine).sqrt(), self.lambda(cosine));
        let half = 0.5 / self.alpha;
        let mut sum = 0.0;
        for &[other, weight, lambda] in &self.rings {
            let across = sine * (1.0 - other * other).sqrt();
            let total = cosine + other;
            let around: f64 = (0..AROUND)
                .map(|k| {
                    let turn = std::f64::consts::PI * (k as f64 + 0.5) / AROUND as f64;
                    let squared = 2.0 + 2.0 * (across * libm::cos(turn) + cosine * other);
                    libm::pow((1.0 - total * total / squared).max(0.0), half)
                })
                .sum();
            let visibility = 0.25 / ((1.0 + own + lambda) * cosine * other.max(least));
            // The distribution's 1/2π and the whole turn cancel.
            sum += weight * visibility * around / AROUND as f64;
        }
        sum * (2.0 + 2.0 * half)
    }
}

//! Separable filters, and the contrast sensitivity function of the eye.

use std::f64::consts::PI;

/// One channel of a picture, row by row.
pub(super) struct Plane {
    pub(super) values: Vec<f64>,
    pub(super) width: usize,
}

impl Plane {
    pub(super) fn new(values: Vec<f64>, width: usize) -> Self {
        Self { values, width }
    }

    /// Filtered by `across` along rows and by `down` along columns. Both have an odd number of weights; the
    /// outermost pixels are repeated beyond the border.
    pub(super) fn filtered(&self, across: &[f64], down: &[f64]) -> Self {
        let (width, height) = (self.width, self.values.len() / self.width);
        let pass = |from: &[f64], weights: &[f64], length: usize, at: &dyn Fn(usize, usize) -> usize| {
            let radius = weights.len() / 2;
            let lines = from.len() / length;
            let mut to = vec![0.0; from.len()];
            for line in 0..lines {
                for place in 0..length {
                    let sum = weights.iter().enumerate().map(|(offset, weight)| {
                        let neighbour = (place + offset).saturating_sub(radius).min(length - 1);
                        weight * from[at(line, neighbour)]
                    });
                    to[at(line, place)] = sum.sum();
                }
            }
            to
        };
        let rows = pass(&self.values, across, width, &|row, column| row * width + column);
        Self::new(pass(&rows, down, height, &|column, row| row * width + column), width)
    }

    /// `a · self + b · other`.
    fn mix(&self, a: f64, other: &Self, b: f64) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(x, y)| a * x + b * y).collect();
        Self::new(values, self.width)
    }
}

/// The weights `weight(x)` at integer distances up to `radius` on either side.
pub(super) fn weights(radius: usize, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..=2 * radius).map(|place| weight(place as f64 - radius as f64)).collect()
}

/// Terms `(a, b)` of `Σ a √(π/b) exp(−π² x²/b)`, x in degrees, for Y, Cx and Cz (table 1).
const TERMS: [[(f64, f64); 2]; 3] =
    [[(1.0, 0.0047), (0.0, 1e-5)], [(1.0, 0.0053), (0.0, 1e-5)], [(34.1, 0.04), (13.5, 0.025)]];

/// Blurs the channels of the opponent space as the eye does (section 4.1.1).
pub(super) fn contrast_sensitivity(channels: [Plane; 3], pixels_per_degree: f64) -> [Plane; 3] {
    let widest = TERMS.iter().flatten().map(|term| term.1).fold(0.0, f64::max);
    // Three standard deviations of the widest filter.
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize;
    let mut terms = TERMS.iter();
    channels.map(|channel| {
        let terms = terms.next().copied().unwrap_or_default();
        let parts = terms.map(|(a, b)| {
            let gaussian = weights(radius, |x| (-(PI * x / pixels_per_degree).powi(2) / b).exp());
            let sum: f64 = gaussian.iter().sum();
            // In two dimensions, where the total weight is the square of the sum.
            (gaussian.iter().map(|weight| weight / sum).collect::<Vec<_>>(), a * (PI / b).sqrt() * sum * sum)
        });
        let whole = parts[0].1 + parts[1].1;
        let [first, second] = [0, 1].map(|part: usize| (&parts[part].0, parts[part].1 / whole));
        let wide = channel.filtered(first.0, first.0);
        if second.1 == 0.0 {
            return wide;
        }
        wide.mix(first.1, &channel.filtered(second.0, second.0), second.1)
    })
}

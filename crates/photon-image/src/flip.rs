//! FLIP: the difference that a viewer perceives when two pictures alternate in the same place.
//!
//! Our implementation of LDR-FLIP: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference
//! Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020; the numbers of equations
//! and sections are theirs. Colours are compared after the contrast sensitivity of the eye has blurred them, and edges
//! and points that occur in only one picture have more weight.

mod colour;
mod features;
mod filter;

use self::colour::{hunt_lab, hyab, opponent, opponent_to_rgb};
use self::filter::Plane;

/// Pixels per degree of the paper's default viewer: 0.7 m in front of a screen 0.7 m wide with 3840 pixels.
pub const PIXELS_PER_DEGREE: f64 = 67.020_643_276_582_25;

/// Exponent of colour differences (section 4.1).
const Q_C: f64 = 0.7;
/// Differences below this share of the largest are spread over [`P_T`] of the range.
const P_C: f64 = 0.4;
const P_T: f64 = 0.95;
/// Exponent of feature differences (section 4.2).
const Q_F: f64 = 0.5;

/// The difference at each pixel, row by row, in `[0, 1]`: 0 for no visible difference. Pixels are linear RGB
/// with the primaries of sRGB, in `[0, 1]`; values outside are clamped.
///
/// # Panics
/// If a picture does not have `width × height` pixels.
#[must_use]
pub fn map(reference: &[[f32; 3]], test: &[[f32; 3]], width: usize, pixels_per_degree: f64) -> Vec<f64> {
    assert!(
        reference.len() == test.len() && (width == 0 || reference.len().is_multiple_of(width)),
        "pictures differ in size"
    );
    if reference.is_empty() || width == 0 {
        return Vec::new();
    }
    let [reference, test] = [reference, test].map(|picture| Seen::new(picture, width, pixels_per_degree));
    let largest = largest_colour_difference();
    (0..reference.lab.len())
        .map(|pixel| {
            let colour = redistribute(hyab(reference.lab[pixel], test.lab[pixel]).powf(Q_C), largest);
            let edge = (reference.edges[pixel] - test.edges[pixel]).abs();
            let point = (reference.points[pixel] - test.points[pixel]).abs();
            let feature = (edge.max(point) / std::f64::consts::SQRT_2).powf(Q_F).min(1.0);
            // Equation 14.
            colour.powf(1.0 - feature)
        })
        .collect()
}

/// The mean of [`map`], which the paper uses as the difference of two pictures.
///
/// # Panics
/// Those of [`map`].
#[must_use]
pub fn mean(reference: &[[f32; 3]], test: &[[f32; 3]], width: usize, pixels_per_degree: f64) -> f64 {
    let all = map(reference, test, width, pixels_per_degree);
    all.iter().sum::<f64>() / all.len().max(1) as f64
}

/// A picture as perceived by a viewer.
struct Seen {
    /// Blurred by contrast sensitivity, in Lab with Hunt's adjustment.
    lab: Vec<[f64; 3]>,
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl Seen {
    fn new(picture: &[[f32; 3]], width: usize, pixels_per_degree: f64) -> Self {
        let clamp = |c: f32| if c.is_nan() { 0.0 } else { f64::from(c).clamp(0.0, 1.0) };
        let colours: Vec<[f64; 3]> = picture.iter().map(|pixel| opponent(pixel.map(clamp))).collect();
        let plane = |channel: usize| Plane::new(colours.iter().map(|colour| colour[channel]).collect(), width);
        let luminance = Plane::new(colours.iter().map(|colour| (colour[0] + 16.0) / 116.0).collect(), width);
        let blurred = filter::contrast_sensitivity([plane(0), plane(1), plane(2)], pixels_per_degree);
        let lab = (0..picture.len())
            .map(|pixel| {
                let rgb = opponent_to_rgb(std::array::from_fn(|channel| blurred[channel].values[pixel]));
                hunt_lab(rgb.map(|c| c.clamp(0.0, 1.0)))
            })
            .collect();
        let (edges, points) = features::detect(&luminance, pixels_per_degree);
        Self { lab, edges, points }
    }
}

/// Between green and blue, to the power [`Q_C`].
fn largest_colour_difference() -> f64 {
    hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0])).powf(Q_C)
}

/// Maps a colour difference to `[0, 1]` (section 4.1.3).
fn redistribute(difference: f64, largest: f64) -> f64 {
    let knee = P_C * largest;
    let mapped = if difference < knee {
        P_T * difference / knee
    } else {
        P_T + (1.0 - P_T) * (difference - knee) / (largest - knee)
    };
    mapped.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests;

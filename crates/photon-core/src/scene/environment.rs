//! Environment maps: light from infinitely far away, by direction.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};

use crate::error::{Error, Result};
use crate::scene::{guide, light_cdf};

/// Radiance by direction: an image in latitude and longitude, and the cells by which directions are sampled.
///
/// With u from 0 to 1 along a row and v from 0 to 1 down the rows, a texel stands for the direction
/// `(sin φ sin θ, cos θ, −cos φ sin θ)`, φ = 2π (u − ½), θ = π v: the centre of the image is −z, and u grows to the
/// right as seen from inside, with y up. Radiance is bilinear between the centres of texels.
///
/// Cells lie between the centres of texels, so that the radiance within a cell is at most that of its corners. A cell
/// is chosen by its mean radiance times its solid angle, then a direction uniformly within it.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMap {
    width: u32,
    height: u32,
    texels: Arc<[[f32; 4]]>,
    rows: Arc<[EnvironmentRow]>,
    row_starts: Arc<[u32]>,
    column_starts: Arc<[u32]>,
    row_guide: Arc<[u16]>,
    column_guides: Arc<[u16]>,
    columns: u32,
    step: u32,
    rotation: f32,
    mean: [f64; 3],
}

/// A row of cells: an interval of `sin²(θ/2)`, which is uniform in solid angle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[non_exhaustive]
pub struct EnvironmentRow {
    /// `sin²(θ/2)` at its upper edge.
    pub above: f32,
    /// `cos²(θ/2)` at its lower edge.
    pub below: f32,
    /// The difference of `sin²(θ/2)` between its edges; the row's solid angle is 4π times this.
    pub extent: f32,
    /// The probability of the row.
    pub probability: f32,
}

/// More cells than this along a row or down the rows are joined: their starts would not fit into caches.
const MAX_CELLS: u32 = 2048;

/// Largest number of texels in a row, and of rows.
const MAX_TEXELS: usize = 32_768;

impl EnvironmentMap {
    /// The map of `radiance`, row by row from the top (θ = 0), `width` texels in each; in user units, W/(m²·sr), finite
    /// and ≥ 0. `rotation` turns it counter-clockwise as seen from +y, in turns.
    ///
    /// # Errors
    /// [`Error::InvalidInput`] for a size that is 0, does not divide the number of texels or exceeds 32,768 texels in a
    /// row or 32,768 rows; for texels that are negative or not finite; for a rotation that is not finite.
    pub fn new(width: usize, radiance: &[[f32; 3]], rotation: f64) -> Result<Self> {
        let invalid =
            |index: usize, why: String| Error::InvalidInput { what: "environment texel", index: index as u64, why };
        if width == 0 || radiance.is_empty() || !radiance.len().is_multiple_of(width) {
            return Err(invalid(0, format!("{} texels do not fill rows of {width}", radiance.len())));
        }
        let height = radiance.len() / width;
        if width > MAX_TEXELS || height > MAX_TEXELS {
            let why = format!("a map of {width} × {height} is larger than {MAX_TEXELS} × {MAX_TEXELS}: scale it down");
            return Err(invalid(0, why));
        }
        if let Some(index) = radiance.iter().position(|texel| texel.iter().any(|&c| !(c.is_finite() && c >= 0.0))) {
            return Err(invalid(index, format!("{:?} must be finite and at least 0", radiance[index])));
        }
        if !rotation.is_finite() {
            return Err(invalid(0, format!("its rotation {rotation} must be a finite number of turns")));
        }
        let texels: Arc<[[f32; 4]]> = radiance.iter().map(|&[r, g, b]| [r, g, b, 0.0]).collect();
        let (width, height) = (width as u32, height as u32);
        let step = width.max(height + 1).div_ceil(MAX_CELLS);
        let mut map = Self {
            width,
            height,
            texels,
            rows: Arc::default(),
            row_starts: Arc::default(),
            column_starts: Arc::default(),
            row_guide: Arc::default(),
            column_guides: Arc::default(),
            columns: width.div_ceil(step),
            step,
            rotation: rotation.rem_euclid(1.0) as f32,
            mean: [0.0; 3],
        };
        map.divide();
        Ok(map)
    }

    /// The same radiance in all directions.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn constant(radiance: [f32; 3]) -> Result<Self> {
        Self::new(1, &[radiance], 0.0)
    }

    /// Computes the cells and the mean radiance.
    fn divide(&mut self) {
        let mean = |color: [f64; 3]| color.iter().sum::<f64>() / 3.0;
        let (mut starts, mut weights) = (Vec::new(), Vec::new());
        let mut edges = Vec::new();
        for row in 0..(self.height + 1).div_ceil(self.step) {
            let mut columns = vec![0.0; self.columns as usize];
            let fine = row * self.step..((row + 1) * self.step).min(self.height + 1);
            for y in fine.clone() {
                let solid = (self.edge(y + 1) - self.edge(y)) * 4.0 * std::f64::consts::PI / f64::from(self.width);
                for x in 0..self.width {
                    let color = self.cell_mean(x, y).map(|c| c * solid);
                    columns[(x / self.step) as usize] += mean(color);
                }
            }
            starts.extend(light_cdf(&columns));
            weights.push(columns.iter().sum::<f64>());
            edges.push((self.edge(fine.start), self.edge(fine.end), 1.0 - self.edge(fine.end)));
        }
        self.mean = self.integral_over_sphere();
        let row_starts = light_cdf(&weights);
        let probability = |row: usize| crate::scene::light_probability(&row_starts, row) as f32;
        let rows = edges.iter().enumerate().map(|(row, &(above, end, below))| EnvironmentRow {
            above: above as f32,
            below: below as f32,
            extent: (end - above) as f32,
            probability: probability(row),
        });
        self.rows = rows.collect();
        self.row_guide = guide::table(&row_starts).into();
        self.column_guides = starts.chunks(self.columns as usize).flat_map(guide::table).collect();
        self.row_starts = row_starts.into();
        self.column_starts = starts.into();
    }

    /// `sin²(θ/2)` at the upper edge of a fine row of cells: the pole, or the centre of a row of texels.
    fn edge(&self, row: u32) -> f64 {
        let v = ((f64::from(row) - 0.5) / f64::from(self.height)).clamp(0.0, 1.0);
        let half = libm::sin(0.5 * std::f64::consts::PI * v);
        half * half
    }

    /// Mean radiance over all directions. It is linear in θ between the centres of rows, and constant beyond the first and
    /// the last: the mean at the corners of a cell would be up to 15 % off for a map that is bright at a pole alone.
    fn integral_over_sphere(&self) -> [f64; 3] {
        let step = std::f64::consts::PI / f64::from(self.height);
        // ∫ t/h cos t dt and ∫ t/h sin t dt, from 0 to h.
        let (sine, half) = (libm::sin(step), libm::sin(0.5 * step));
        let along = sine - 2.0 * half * half / step;
        let across = sine / step - libm::cos(step);
        let mean = |row: &[[f32; 4]]| {
            let mut sum = [0.0; 3];
            row.iter().for_each(|texel| (0..3).for_each(|c| sum[c] += f64::from(texel[c])));
            sum.map(|total: f64| total / f64::from(self.width))
        };
        let means: Vec<[f64; 3]> = self.texels.chunks(self.width as usize).map(mean).collect();
        let mut sum = [0.0; 3];
        for y in 0..=self.height {
            // ∫ sin θ dθ/2 of this row of cells, which the rows of texels above and below share.
            let solid = self.edge(y + 1) - self.edge(y);
            let theta = step * (f64::from(y) - 0.5);
            let lower = match y {
                0 => 0.0,
                y if y == self.height => 0.0,
                _ => 0.5 * (libm::sin(theta) * along + libm::cos(theta) * across),
            };
            for (row, weight) in [(y.max(1) - 1, solid - lower), (y.min(self.height - 1), lower)] {
                sum.iter_mut().zip(means[row as usize]).for_each(|(sum, mean)| *sum += mean * weight);
            }
        }
        sum
    }

    /// Mean of the radiance at the corners of a fine cell.
    fn cell_mean(&self, x: u32, y: u32) -> [f64; 3] {
        let rows = [y.max(1) - 1, y.min(self.height - 1)];
        let columns = [x, (x + 1) % self.width];
        let at = |x: u32, y: u32| self.texels[(y * self.width + x) as usize];
        std::array::from_fn(|c| rows.iter().flat_map(|&y| columns.map(|x| f64::from(at(x, y)[c]))).sum::<f64>() / 4.0)
    }

    /// Mean radiance over all directions, in the units of the texels.
    #[must_use]
    pub fn mean_radiance(&self) -> [f64; 3] {
        self.mean
    }

    /// The map with all radiance multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let texels = self.texels.iter().map(|texel| texel.map(|c| (f64::from(c) * factor) as f32)).collect();
        Self { texels, mean: self.mean.map(|c| c * factor), ..self.clone() }
    }

    /// Texels in a row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows of texels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Rotation, counter-clockwise as seen from +y, in turns, in `[0, 1]`.
    #[must_use]
    pub fn rotation(&self) -> f32 {
        self.rotation
    }

    /// Texels, row by row from the top; the fourth number is 0.
    #[must_use]
    pub fn texels(&self) -> &[[f32; 4]] {
        &self.texels
    }

    /// Rows of cells, from the top.
    #[must_use]
    pub fn rows(&self) -> &[EnvironmentRow] {
        &self.rows
    }

    /// Where each row's interval in the range of a random `u32` begins.
    #[must_use]
    pub fn row_starts(&self) -> &[u32] {
        &self.row_starts
    }

    /// The same for the cells of each row, one row after another.
    #[must_use]
    pub fn column_starts(&self) -> &[u32] {
        &self.column_starts
    }

    /// For as many equal parts of the range of a random `u32` as there are rows of cells: the row in whose interval the part
    /// begins.
    #[must_use]
    pub fn row_guide(&self) -> &[u16] {
        &self.row_guide
    }

    /// The same for the cells of each row, one row after another.
    #[must_use]
    pub fn column_guides(&self) -> &[u16] {
        &self.column_guides
    }

    /// Cells in a row.
    #[must_use]
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Texels that a cell spans.
    #[must_use]
    pub fn step(&self) -> u32 {
        self.step
    }
}

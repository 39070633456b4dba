//! Texture coordinates as tables hold them: few, small and finite.

use photon_core::{Texture, Wrap};

use crate::texture::TextureRef;

/// Texture coordinates of one mesh and one UV set, on their way into the table.
pub(super) struct UvSet<'a> {
    /// Uses of the set by the mesh's material, with their images.
    uses: Vec<(TextureRef, &'a Texture)>,
    /// By which multiples each coordinate can be shifted without a change of any texture.
    periods: [Option<f64>; 2],
}

/// Counts for warnings.
#[derive(Default)]
pub(super) struct Census {
    /// Triangles with coordinates that are not finite in single precision.
    pub(super) invalid: u64,
    /// Triangles whose coordinates are so large that they are rounded to steps of more than an eighth of a texel.
    pub(super) coarse: u64,
}

impl<'a> UvSet<'a> {
    pub(super) fn new(uses: Vec<(TextureRef, &'a Texture)>) -> Self {
        let periods = std::array::from_fn(|axis| period(&uses, axis));
        Self { uses, periods }
    }

    /// The coordinates of a triangle, shifted towards 0 by whole periods.
    pub(super) fn pack(&self, mut corners: [[f64; 2]; 3], census: &mut Census) -> [[f32; 2]; 3] {
        let mut is_valid = true;
        for axis in 0..2 {
            let values = corners.map(|corner| corner[axis]);
            if values.iter().any(|value| !value.is_finite()) {
                is_valid = false;
                corners.iter_mut().for_each(|corner| corner[axis] = finite(corner[axis]));
            }
            if let Some(period) = self.periods[axis] {
                let least = corners.iter().fold(f64::INFINITY, |least, corner| least.min(corner[axis]));
                let shift = (least / period).floor() * period;
                corners.iter_mut().for_each(|corner| corner[axis] -= shift);
            }
        }
        let narrow = corners.map(|corner| {
            corner.map(|value| {
                let value = value as f32;
                is_valid &= value.is_finite();
                if value.is_finite() { value } else { 0.0 }
            })
        });
        census.invalid += u64::from(!is_valid);
        census.coarse += u64::from(is_valid && self.is_coarse(corners));
        narrow
    }

    /// Whether rounding to single precision moves a corner by more than an eighth of a texel.
    fn is_coarse(&self, corners: [[f64; 2]; 3]) -> bool {
        self.uses.iter().any(|(used, image)| {
            let size = [image.width, image.height].map(f64::from);
            corners
                .into_iter()
                .map(|corner| used.place(corner))
                .any(|place| (0..2).any(|axis| place[axis].abs() * f64::from(f32::EPSILON) * size[axis] > 0.125))
        })
    }
}

/// The number itself, or 0 in place of NaN and infinities.
pub(super) fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// The shift of a coordinate that changes no texture: 1 if all uses repeat, 2 if some are mirrored, none if a use is
/// clamped or scales the coordinate by a fraction.
fn period(uses: &[(TextureRef, &Texture)], axis: usize) -> Option<f64> {
    let mut period = 1.0;
    for (used, image) in uses {
        for (row, wrap) in used.transform.iter().zip(image.wrap) {
            // As the table has it: rounding may make a factor 0 or whole.
            let factor = row[axis] as f32;
            if factor == 0.0 {
                continue;
            }
            if factor.fract() != 0.0 {
                return None;
            }
            period = f64::max(period, wrap.period()?);
        }
    }
    Some(period)
}

/// The transform in single precision, its offset reduced by whole periods.
pub(super) fn transform(used: &TextureRef, wrap: [Wrap; 2]) -> [[f32; 3]; 2] {
    std::array::from_fn(|row| {
        let [a, b, c] = used.transform[row];
        let c = wrap[row].period().map_or(c, |period| c - period * (c / period).floor());
        [a as f32, b as f32, c as f32]
    })
}

//! Means of an image over ever larger squares.

use glam::{DVec2, DVec3};
use photon_core::texture::axis;
use photon_core::{Filter, Texture, Wrap};

use super::texel::Decoder;

/// Number of texels above which the finest level is coarser than the image.
const MAX_TEXELS: usize = 1 << 22;

/// An image, and means of it.
#[derive(Clone, Debug)]
pub(super) struct Pyramid {
    /// From fine to coarse; the last has one texel.
    pub(super) levels: Vec<Level>,
    /// Whether the first level is the image itself.
    pub(super) is_exact: bool,
}

/// An image in linear colours.
#[derive(Clone, Debug)]
pub(super) struct Level {
    pub(super) width: usize,
    pub(super) height: usize,
    texels: Vec<[f32; 3]>,
}

impl Pyramid {
    pub(super) fn new(image: &Texture) -> Self {
        let size = [image.width as usize, image.height as usize];
        let mut block = 1;
        while size[0].div_ceil(block) * size[1].div_ceil(block) > MAX_TEXELS {
            block *= 2;
        }
        let decoder = Decoder::new(image);
        let mut levels = vec![Level::means(size, block, |x, y| DVec3::from_array(decoder.color(x, y)))];
        while let Some(fine) = levels.last().filter(|level| level.texels.len() > 1) {
            levels.push(Level::means([fine.width, fine.height], 2, |x, y| fine.texel(x, y)));
        }
        Self { levels, is_exact: block == 1 }
    }
}

impl Level {
    /// Means over blocks of an image of that size.
    fn means([width, height]: [usize; 2], block: usize, texel: impl Fn(usize, usize) -> DVec3) -> Self {
        let (columns, rows) = (width.div_ceil(block), height.div_ceil(block));
        let mut texels = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            for column in 0..columns {
                let (x, y) =
                    (column * block..width.min((column + 1) * block), row * block..height.min((row + 1) * block));
                let count = x.len() * y.len();
                let sum: DVec3 = y.flat_map(|y| x.clone().map(move |x| (x, y))).map(|(x, y)| texel(x, y)).sum();
                let mean = sum / count as f64;
                // A mean that is not 0 does not become 0 by rounding.
                let round = |part: f64| if part > 0.0 { (part as f32).max(f32::MIN_POSITIVE) } else { 0.0 };
                texels.push(mean.to_array().map(round));
            }
        }
        Self { width: columns, height: rows, texels }
    }

    fn texel(&self, x: usize, y: usize) -> DVec3 {
        glam::Vec3::from_array(self.texels[y * self.width + x]).as_dvec3()
    }

    /// The colour at texture coordinates, which must be finite.
    pub(super) fn lookup(&self, place: DVec2, wrap: [Wrap; 2], filter: Filter) -> DVec3 {
        // As the renderer looks textures up.
        let (left, right, across) = axis(place.x as f32, self.width as u32, wrap[0], filter);
        let (upper, lower, down) = axis(place.y as f32, self.height as u32, wrap[1], filter);
        let texel = |x: u32, y: u32| self.texel(x as usize, y as usize);
        let row = |y: u32| texel(left, y).lerp(texel(right, y), f64::from(across));
        row(upper).lerp(row(lower), f64::from(down))
    }
}

//! Radius that contains a given number of neighbours around most photons: code shared by backends.

/// Maximum number of photons whose neighbours are searched: evenly spread over the map.
pub const SAMPLE: u32 = 1024;

/// Maximum search radius, a quarter of the scene.
pub const MAX_RADIUS: f32 = 0.25;

/// Minimum radius of an estimate, 2⁻²⁰ of the scene; it avoids a division by zero.
pub const MIN_RADIUS: f32 = 1.0 / 1_048_576.0;

/// The median of the radii whose squares were found around `asked` photons, clamped to [`MIN_RADIUS`] and
/// [`MAX_RADIUS`]; the latter if fewer than half of the photons have enough neighbours within it.
#[must_use]
pub fn median(mut squares: Vec<f32>, asked: u32) -> f32 {
    if squares.is_empty() || squares.len() * 2 < asked as usize {
        return MAX_RADIUS;
    }
    squares.sort_unstable_by(f32::total_cmp);
    squares[squares.len() / 2].sqrt().clamp(MIN_RADIUS, MAX_RADIUS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_median_of_what_enough_photons_found() {
        assert_eq!(median(vec![0.04, 0.01, 0.0], 4), 0.1);
        assert_eq!(median(vec![0.0; 3], 3), MIN_RADIUS);
        assert_eq!(median(vec![1e-4, 1e-4], 5), MAX_RADIUS);
        assert_eq!(median(Vec::new(), 0), MAX_RADIUS);
    }
}

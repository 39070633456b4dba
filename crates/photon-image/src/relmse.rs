//! Relative mean square error.

/// The mean over pixels of `(x − y)² / (y² + ȳ²/100)`, where `x` is the picture, `y` the reference and `ȳ` the mean
/// of the reference, all as the mean of RGB. Infinite if the reference is black and the picture is not.
///
/// # Panics
/// If the numbers of pixels differ.
#[must_use]
pub fn relmse(reference: &[[f32; 3]], picture: &[[f32; 3]]) -> f64 {
    assert_eq!(reference.len(), picture.len(), "pictures differ in size");
    let grey = |pixel: &[f32; 3]| pixel.iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0;
    let count = reference.len().max(1) as f64;
    let mean = reference.iter().map(grey).sum::<f64>() / count;
    let terms = reference.iter().zip(picture).map(|(y, x)| {
        let (x, y) = (grey(x), grey(y));
        // 0/0 where both are black.
        if x == y { 0.0 } else { (x - y).powi(2) / (y * y + 0.01 * mean * mean) }
    });
    terms.sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        let reference = [[1.0; 3], [3.0; 3]];
        assert_eq!(relmse(&reference, &reference), 0.0);
        // (1/(1 + 0.04) + 0) / 2
        let error = relmse(&reference, &[[2.0; 3], [3.0; 3]]);
        assert!((error - 0.5 / 1.04).abs() < 1e-12, "{error}");
        assert_eq!(relmse(&[[0.0; 3]], &[[0.0; 3]]), 0.0);
        assert_eq!(relmse(&[[0.0; 3]], &[[1.0; 3]]), f64::INFINITY);
    }
}

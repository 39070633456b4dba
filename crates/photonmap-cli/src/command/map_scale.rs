//! Scaling of the points of `photonmap map`, so that the squares of their distances are normal 32-bit numbers.

use crate::fault::Fault;

/// The largest coordinate after scaling is at least this and less than twice as much: squared distances are below 12 · 2¹²⁰.
const LARGEST: f64 = (1_u64 << 59) as f64;
/// Squares of smaller distances have not all of their digits.
const SHORTEST: f64 = 1.0 / (1_u64 << 50) as f64;
/// A radius above every distance, whose square is finite.
const REACH: f64 = (1_u64 << 62) as f64;

/// A power of two, by which scaling changes no digit of any coordinate, nor the order of distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale(f64);

impl Scale {
    /// The scale at which the largest coordinate is between 2⁵⁹ and 2⁶⁰.
    pub(super) fn of(photons: &[[f32; 3]], queries: &[[f32; 3]]) -> Self {
        let all = photons.as_flattened().iter().chain(queries.as_flattened());
        let largest = f64::from(all.fold(0.0_f32, |most, c| most.max(c.abs())));
        // Coordinates of 32 bits are normal numbers of 64 bits: the power of two in their bits, without mantissa and sign.
        let power = f64::from_bits(largest.to_bits() & (0x7FF << 52));
        Self(if largest > 0.0 { LARGEST / power } else { 1.0 })
    }

    pub(super) fn points(self, mut points: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
        points.as_flattened_mut().iter_mut().for_each(|c| *c = (f64::from(*c) * self.0) as f32);
        points
    }

    /// A radius, which may be infinite; `name` is that of its option.
    ///
    /// # Errors
    /// [`Fault::Input`] for one that is so much smaller than the coordinates that its square loses digits.
    pub(super) fn radius(self, name: &str, radius: f32) -> Result<f32, Fault> {
        let scaled = f64::from(radius) * self.0;
        if scaled < SHORTEST {
            let least = SHORTEST / self.0;
            return Err(Fault::input(format!(
                "{name} is {radius:e}, too small beside the largest coordinate: with these points it must be at least \
                 {least:.1e}"
            )));
        }
        Ok(if radius.is_finite() { scaled.min(REACH) as f32 } else { radius })
    }

    /// Checks that the distances of the neighbours that were found, `k` for each query, are 0 or have exact squares.
    ///
    /// # Errors
    /// [`Fault::Input`] names the first pair that is too close together beside the largest coordinate.
    pub(super) fn check(
        self,
        photons: &[[f32; 3]],
        queries: &[[f32; 3]],
        neighbours: &[u32],
        k: usize,
    ) -> Result<(), Fault> {
        for (number, (query, row)) in queries.iter().zip(neighbours.chunks_exact(k.max(1))).enumerate() {
            for &id in row {
                let Some(photon) = photons.get(id as usize) else { continue };
                let square: f64 = query.iter().zip(photon).map(|(q, p)| (f64::from(*q) - f64::from(*p)).powi(2)).sum();
                if square > 0.0 && square < SHORTEST * SHORTEST {
                    return Err(Fault::input(format!(
                        "query {number} and photon {id} are {:.1e} apart, too close beside the largest coordinate for \
                         32-bit squares; search a part of the points, or move them to the origin",
                        square.sqrt() / self.0
                    )));
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_of_any_size_have_squares() {
        for largest in [f32::MAX, 1e30, 3.0, 1e-21, f32::MIN_POSITIVE, f32::from_bits(1)] {
            let points = vec![[largest, -largest, 0.0], [largest / 4.0, 0.0, 0.0]];
            let scale = Scale::of(&points, &[]);
            let scaled = scale.points(points.clone());
            let most = f64::from(scaled[0][0]);
            assert!((LARGEST..2.0 * LARGEST).contains(&most), "{largest}: {most}");
            assert_eq!(f64::from(scaled[0][0]) / scale.0, f64::from(largest));
            assert_eq!(f64::from(scaled[1][0]) / scale.0, f64::from(points[1][0]));
            assert!(scale.radius("--radius", largest).unwrap().powi(2).is_finite());
        }
        assert_eq!(Scale::of(&[[0.0; 3]], &[]).points(vec![[0.0; 3]]), [[0.0; 3]]);
        assert_eq!(Scale::of(&[], &[]), Scale::of(&[[0.0; 3]], &[]));
        let scale = Scale::of(&[[1.0; 3]], &[]);
        assert_eq!(scale.radius("--max-radius", f32::INFINITY).unwrap(), f32::INFINITY);
        assert!(scale.radius("--radius", f32::MAX).unwrap().powi(2).is_finite());
        let why = scale.radius("--radius", 1e-35).unwrap_err().to_string();
        assert!(why.contains("--radius is 1e-35") && why.contains("at least"), "{why}");
    }

    /// Pairs at a distance of 10⁻³⁵ beside a coordinate of 1, equal ones, and others.
    #[test]
    fn pairs_that_are_too_close_are_named() {
        let photons = vec![[1.0, 0.0, 0.0], [1e-35, 0.0, 0.0], [0.0; 3], [1e-30, 0.0, 0.0]];
        let queries = vec![[1.0, 1.0, 0.0], [0.0; 3]];
        let scale = Scale::of(&photons, &queries);
        let [photons, queries] = [photons, queries].map(|points| scale.points(points));
        assert!(scale.check(&photons, &queries, &[0, 1, 2, 3], 2).is_ok());
        assert!(scale.check(&photons, &queries, &[0, u32::MAX, 2, u32::MAX], 2).is_ok());
        assert!(scale.check(&photons, &queries, &[], 0).is_ok());
        let why = scale.check(&photons, &queries, &[0, 1, 2, 1], 2).unwrap_err().to_string();
        assert!(why.contains("query 1 and photon 1 are 1.0e-35 apart"), "{why}");
    }
}

//! Flights of photons through a medium: how far they go, and the photons that they leave on the way.
//!
//! Coefficients may differ between the channels of a colour. A channel is drawn in proportion to the power that it carries, a
//! length with the density of that channel, and all channels are divided by the density of the mixture: their sum is then
//! kept, exactly but for rounding, and no weight is larger than the number of channels (one-sample balance heuristic,
//! Veach 1997, section 9.2.4).

use glam::Vec3;

use crate::scene::medium::Medium;
use crate::shading::math;
use crate::shading::reflection_lobe::Vectors;

/// Distance at which a flight that meets nothing ends, normalised: 64 times the radius of the unit box. Less than 2.3·10⁻⁵
/// of the light would return from beyond: the largest value of σR²e^(−σX)/4X for all coefficients σ.
pub const FAR: f32 = 56.0;

/// Length up to which a stretch of a ray is none, normalised: what rounding leaves between boundaries that coincide, or between one
/// and a surface or the camera.
pub const SHORTEST_STRETCH: f32 = 1.0 / 1_048_576.0;

/// Maximum number of collisions of a path. The light of longer ones is counted as truncated.
pub const MAX_COLLISIONS: u32 = 1024;

/// Photons stored on a stretch that only perfect surfaces came before: such light shows focused beams.
pub const FOCUSED_DEPOSITS: u32 = 8;

/// A collision in a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// Distance from the start of the flight.
    pub distance: f32,
    /// Power that is scattered there, times the inverse of the probability that it is not absorbed.
    pub power: Vec3,
    /// Albedo of the mixture: the probability that it is not absorbed.
    pub albedo: f32,
}

/// End of a flight: a collision, or the power with which the end of the stretch is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flight {
    /// It collided before.
    Collides(Collision),
    /// It reached the end of the stretch.
    Passes(Vec3),
}

/// Shares of the channels in a power, ≥ 0 and with a sum of 1; even for a power of 0.
#[inline]
fn shares(power: Vec3) -> Vec3 {
    let sum = power.element_sum();
    if sum > 0.0 { power / sum } else { Vec3::splat(1.0 / 3.0) }
}

/// The channel that `u` in `[0, 1)` chooses.
#[inline]
fn channel(shares: Vec3, u: f32) -> usize {
    let green = u >= shares.x;
    // The last channel may have a share of 0, and sums are rounded.
    let blue = u >= shares.x + shares.y && shares.z > 0.0;
    if blue {
        2
    } else if green && shares.y > 0.0 {
        1
    } else if shares.x > 0.0 {
        0
    } else {
        1 + usize::from(!(shares.y > 0.0))
    }
}

/// `exp(-depth)` of each channel over that of the clearest, so that no quotient of two of them is 0 by 0.
#[inline]
fn relative(depth: Vec3) -> Vec3 {
    let depth = depth - depth.min_element();
    Vec3::new(math::exp_neg(depth.x), math::exp_neg(depth.y), math::exp_neg(depth.z))
}

/// A flight of `power` through `medium`, whose stretch ends at distance `end`. `u` draws the channel, `v` the length.
#[inline]
#[must_use]
pub fn sample(medium: &Medium, power: Vec3, end: f32, uv: [f32; 2]) -> Flight {
    let distance = length(medium, power, uv);
    let collides = distance < end;
    ended(medium, power, collides, if collides { distance } else { end })
}

/// The length of a flight of `power` through `medium` up to a collision, > 0: infinity in a channel without extinction.
#[inline]
#[must_use]
pub fn length(medium: &Medium, power: Vec3, [u, v]: [f32; 2]) -> f32 {
    let coefficient = medium.extinction()[channel(shares(power), u)];
    let length = math::minus_ln_one_minus(v) / coefficient;
    if coefficient > 0.0 { length.max(f32::MIN_POSITIVE) } else { f32::INFINITY }
}

/// The end of a flight at a distance: a collision, or the end of its stretch.
#[inline]
#[must_use]
pub fn ended(medium: &Medium, power: Vec3, collides: bool, distance: f32) -> Flight {
    let (extinction, shares) = (medium.extinction(), shares(power));
    if !collides {
        let left = relative(extinction * distance);
        return Flight::Passes(power * left / shares.dot(left));
    }
    let left = relative(extinction * distance);
    let scattered = power * Vec3::from(medium.scattering) * left / shares.dot(extinction * left);
    let all = power.element_sum();
    let albedo = if all > 0.0 { (scattered.element_sum() / all).clamp(0.0, 1.0) } else { 0.0 };
    let power = if albedo > 0.0 { scattered / albedo } else { Vec3::ZERO };
    Flight::Collides(Collision { distance, power, albedo })
}

/// A photon of `count` left on a stretch of length `end`: its distance, and its power, whose expected value is that of the
/// light scattered there. `u` draws the channel, `v` the place.
#[inline]
#[must_use]
pub fn deposit(medium: &Medium, power: Vec3, end: f32, count: u32, [u, v]: [f32; 2]) -> (f32, Vec3) {
    let (extinction, shares) = (medium.extinction(), shares(power));
    // Probability of a collision, and the density of places at the start, of each channel.
    let share = |coefficient: f32| {
        let depth = coefficient * end;
        let collides = math::one_minus_exp(depth);
        // In the limit of no extinction, places are even.
        if depth > 1e-20 { (collides, coefficient / collides) } else { (depth, 1.0 / end) }
    };
    let each = [share(extinction.x), share(extinction.y), share(extinction.z)];
    let chosen = channel(shares, u);
    let (collides, _) = each[chosen];
    let coefficient = extinction[chosen];
    let distance =
        if collides > 1e-20 { math::minus_ln_one_minus(v * collides) / coefficient } else { v * end }.min(end);
    let left = relative(extinction * distance);
    let density = Vec3::new(each[0].1, each[1].1, each[2].1) * left;
    let scattered = Vec3::from(medium.scattering) * left;
    (distance, power * scattered / (shares.dot(density) * count as f32))
}

/// Russian roulette at a collision at `position`, in a medium without bounds: the power with which a path that started with
/// `start` goes on, or `None`. `u` decides.
///
/// At a distance d > 1, a path that goes on has at least d^(3/2) times the power that it started with. The mean is the same for
/// any exponent k. A random walk returns to the unit sphere with probability 1/d: for k ≤ 1 the walks that do are infinitely long
/// in the mean, for k ≥ 2 the variance of the light that they bring back is infinite.
#[inline]
#[must_use]
pub fn thinned(power: Vec3, start: Vec3, position: Vec3, u: f32) -> Option<Vec3> {
    let distance = position.length();
    let chance = power.element_sum() / (start.element_sum() * (distance * distance.sqrt()));
    // All surfaces are in the unit sphere. Numbers that are not finite end the path elsewhere.
    if !(distance > 1.0 && chance < 1.0) {
        return Some(power);
    }
    if u < chance { Some(power / chance) } else { None }
}

/// Transmittance of each channel over a distance (Beer–Lambert law).
#[inline]
#[must_use]
pub fn transmittance(medium: &Medium, distance: f32) -> Vec3 {
    let depth = medium.extinction() * distance;
    Vec3::new(math::exp_neg(depth.x), math::exp_neg(depth.y), math::exp_neg(depth.z))
}

/// [`transmittance`] over several distances, for each channel; the loops become vector instructions.
#[inline(always)]
#[must_use]
pub fn transmittances<const N: usize>(medium: &Medium, distances: &[f32; N]) -> Vectors<N> {
    let [red, green, blue] = medium.extinction().to_array();
    let mut all = [[0.0; N]; 3];
    for (channel, extinction) in [red, green, blue].into_iter().enumerate() {
        if channel > 0 && extinction == red {
            all[channel] = all[0];
            continue;
        }
        for lane in 0..N {
            all[channel][lane] = math::exp_neg(extinction * distances[lane]);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::Phase;
    use crate::random::{SplitMix64, unit_f32};

    fn media() -> [Medium; 4] {
        let of = |scattering, absorption| Medium { scattering, absorption, ..Medium::VACUUM };
        [
            of([0.5; 3], [0.2; 3]),
            of([2.0, 0.3, 0.1], [0.0, 0.5, 1.0]),
            of([1e3, 1e-3, 0.0], [0.0, 0.0, 2.0]),
            of([1e-20; 3], [0.0; 3]),
        ]
    }

    fn numbers() -> impl FnMut() -> [f32; 2] {
        let mut numbers = SplitMix64(3);
        move || [0; 2].map(|_: i32| unit_f32(numbers.word() as u32))
    }

    #[test]
    fn several_transmittances_are_those_of_each() {
        let distances = [0.0, 1e-3, 0.3, 2.0, 40.0, FAR, f32::NAN, 1e9];
        for medium in media() {
            let all = transmittances(&medium, &distances);
            for (lane, &distance) in distances.iter().enumerate() {
                assert_eq!(
                    Vec3::from(all.map(|channel| channel[lane])),
                    transmittance(&medium, distance),
                    "{distance}"
                );
            }
        }
    }

    /// Means of each channel: e^(−σs) passes a stretch, and σ_s/σ of the rest is scattered; their sum is kept but for
    /// absorption. |z| ≤ 4.5 of the standard error of the mean.
    #[test]
    fn flights_keep_the_light_of_each_channel() {
        const N: u32 = 100_000;
        let power = Vec3::new(0.7, 0.2, 0.1);
        for (index, medium) in media().iter().enumerate() {
            for end in [0.01, 1.0, FAR] {
                let mut next = numbers();
                let mut values = vec![[0.0_f64; 6]; N as usize];
                for value in &mut values {
                    match sample(medium, power, end, next()) {
                        Flight::Passes(left) => {
                            assert!((left.element_sum() - 1.0).abs() < 1e-5, "{left}");
                            (0..3).for_each(|c| value[c] = f64::from(left[c]));
                        }
                        Flight::Collides(Collision { distance, power, albedo }) => {
                            assert!(distance < end && power.is_finite() && (0.0..=1.0).contains(&albedo));
                            (0..3).for_each(|c| value[3 + c] = f64::from(power[c] * albedo));
                        }
                    }
                }
                for c in 0..3 {
                    let (sigma, scattering) = (f64::from(medium.extinction()[c]), f64::from(medium.scattering[c]));
                    let passes = (-sigma * f64::from(end)).exp();
                    let share = if sigma > 0.0 { scattering / sigma } else { 0.0 };
                    for (at, expected) in [(c, passes), (3 + c, share * -(-sigma * f64::from(end)).exp_m1())] {
                        let expected = expected * f64::from(power[c]);
                        let mean = values.iter().map(|value| value[at]).sum::<f64>() / f64::from(N);
                        let square = values.iter().map(|value| value[at].powi(2)).sum::<f64>() / f64::from(N);
                        let error = ((square - mean * mean).max(0.0) / f64::from(N)).sqrt();
                        assert!((mean - expected).abs() <= 4.5 * error + 1e-6, "{index} {end} {at}: {mean} {expected}");
                    }
                }
            }
        }
    }

    /// Of many paths at a place, those that go on have the power of all; near the scene all go on unchanged.
    #[test]
    fn thinned_paths_keep_their_power() {
        const N: u32 = 10_000;
        let start = Vec3::new(0.9, 1.2, 0.3);
        for position in [Vec3::X, Vec3::new(0.9, 0.9, 0.1), Vec3::new(-40.0, 3.0, 7.0), Vec3::new(0.0, 1e4, 0.0)] {
            for power in [start, Vec3::new(0.2, 0.1, 0.0), 30.0 * start] {
                let places = (0..N).map(|i| (i as f32 + 0.5) / N as f32);
                let left: Vec<Vec3> = places.filter_map(|u| thinned(power, start, position, u)).collect();
                let chance = power.element_sum() / start.element_sum() / position.length().powf(1.5);
                let kept = if position.length() > 1.0 { chance.min(1.0) } else { 1.0 };
                let expected = f64::from(kept) * f64::from(N);
                assert!(
                    (left.len() as f64 - expected).abs() <= 1.0,
                    "{position} {power}: {} of {expected}",
                    left.len()
                );
                // Each stands for those that ended.
                assert!(left.iter().all(|left| (*left * kept).distance(power) <= 1e-6 * power.length()));
            }
        }
    }

    /// Random walks from the centre collide as often within the unit sphere with roulette as without, in a fraction of the steps.
    #[test]
    fn thinned_walks_return_as_often() {
        const N: u32 = 4_000;
        let medium = Medium { scattering: [1.0; 3], ..Medium::VACUUM };
        let mut next = numbers();
        let mut walk = |thins: bool| {
            let (mut sums, mut steps) = ([0.0_f64; 2], 0_u32);
            for _ in 0..N {
                let (mut position, mut power, mut within) = (Vec3::ZERO, Vec3::ONE, 0.0);
                for _ in 0..400 {
                    let Flight::Collides(found) = sample(&medium, power, FAR, next()) else { break };
                    position += Phase::HenyeyGreenstein(0.0).sample(Vec3::X, next()) * found.distance;
                    power = found.power;
                    steps += 1;
                    if position.length() < 1.0 {
                        within += f64::from(power.x);
                    }
                    if thins {
                        let Some(left) = thinned(power, Vec3::ONE, position, next()[0]) else { break };
                        power = left;
                    }
                }
                sums[0] += within;
                sums[1] += within * within;
            }
            let [mean, square] = sums.map(|sum| sum / f64::from(N));
            (mean, (square - mean * mean) / f64::from(N), steps)
        };
        let ((all, first, long), (few, second, short)) = (walk(false), walk(true));
        let error = (first + second).sqrt();
        assert!((all - few).abs() <= 4.5 * error && error < 0.05 * all, "{all} {few} ± {error}");
        assert!(short < long / 5, "{short} of {long} steps");
    }

    /// The photons left on a stretch have the power that is scattered there, in the mean and by places.
    #[test]
    fn deposits_have_the_power_that_is_scattered() {
        const N: u32 = 100_000;
        let power = Vec3::new(0.7, 0.2, 0.1);
        for (index, medium) in media().iter().enumerate() {
            for end in [1e-4, 1.0, FAR] {
                let mut next = numbers();
                // Power, and power times distance.
                let mut sums = [[0.0_f64; 2]; 6];
                for _ in 0..N {
                    let (distance, left) = deposit(medium, power, end, 1, next());
                    assert!((0.0..=end).contains(&distance) && left.is_finite(), "{index} {distance} {left}");
                    for c in 0..3 {
                        for (at, value) in [(c, left[c]), (3 + c, left[c] * distance / end)] {
                            sums[at][0] += f64::from(value);
                            sums[at][1] += f64::from(value).powi(2);
                        }
                    }
                }
                for c in 0..3 {
                    let (sigma, scattering) = (f64::from(medium.extinction()[c]), f64::from(medium.scattering[c]));
                    let depth = sigma * f64::from(end);
                    let share = if sigma > 0.0 { scattering / sigma } else { 0.0 };
                    // ∫ σ_s e^(−σt) dt, and the same times t over the length; series for small depths.
                    let zeroth = share * -(-depth).exp_m1();
                    let first = if depth < 1e-4 {
                        share * depth * (0.5 - depth / 3.0)
                    } else {
                        share * (1.0 - (1.0 + depth) * (-depth).exp()) / depth
                    };
                    for (at, expected) in [(c, zeroth), (3 + c, first)] {
                        let expected = expected * f64::from(power[c]);
                        let [mean, square] = sums[at].map(|sum| sum / f64::from(N));
                        let error = ((square - mean * mean).max(0.0) / f64::from(N)).sqrt();
                        let least = 2e-5 * expected;
                        assert!(
                            (mean - expected).abs() <= 4.5 * error + least,
                            "{index} {end} {at}: {mean} {expected}"
                        );
                    }
                }
            }
        }
    }
}

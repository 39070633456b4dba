//! Probabilities with which several shadow rays are spread over groups of lights.
//!
//! If one light outweighs the others and is occluded, rays in proportion to the weights rarely find the others, and their
//! estimates are noisy. A second ray to the same light is worth less than one to another: with rays enough, each group of
//! lights gets one, as by a loop over all lights; with fewer, strong groups do not get more than one.

use super::{DEFENSIVE_SHARE, LightSampler, MAX_LIGHTS};
use crate::scene::light_groups::LightGroups;

/// Where all groups in view get a ray, lights without weight, which are not in view except for rounding, get this probability,
/// divided by the number of all lights.
pub const UNSEEN_SHARE: f64 = 1e-3;

impl LightSampler {
    /// For `rays` shadow rays, whose random words are the same but for a multiple of `1/rays` of their range (systematic
    /// sampling, Madow and Madow 1944): a group of probability `1/rays` is sampled by exactly one of them.
    ///
    /// If no more groups than rays have weights, each of these gets `1/rays` (but for [`UNSEEN_SHARE`]), and the other rays are
    /// in proportion to the weights. Otherwise the probabilities are those of [`LightSampler::new`], except that groups with more
    /// than `1/rays` by their weights are limited to that.
    #[inline]
    #[must_use]
    pub fn for_rays(lights: usize, groups: LightGroups, rays: u32, weight: impl Fn(usize) -> f32) -> Self {
        if groups.starts() == 0 || !(2..=MAX_LIGHTS).contains(&lights) {
            return Self::new(lights, weight);
        }
        let mut weights = [0.0_f32; MAX_LIGHTS];
        for (index, place) in weights[..lights].iter_mut().enumerate() {
            *place = weight(index);
        }
        Self::spread(&weights[..lights], groups, rays).unwrap_or_else(|| Self::new(lights, |index| weights[index]))
    }

    /// `None` if no group has a ray of its own.
    #[inline]
    fn spread(weights: &[f32], groups: LightGroups, rays: u32) -> Option<Self> {
        let count = weights.len();
        let sum_of = |[first, end]: [usize; 2]| weights[first..end].iter().copied().map(f64::from).sum::<f64>();
        let has_weight = |group: &[usize; 2]| sum_of(*group) > 0.0;
        let seen = groups.of(count).filter(has_weight).fold(0_u32, |seen, [first, _]| seen | 1 << first);
        let enough = seen.count_ones() <= rays;
        let with_ray = if enough { seen } else { strongest(count, groups, rays, sum_of) };
        let total = sum_of([0, count]);
        if with_ray == 0 || !total.is_finite() {
            return None;
        }
        // Lights whose groups have no ray of their own.
        let has_none = |&[first, _]: &[usize; 2]| with_ray >> first & 1 == 0;
        let others = || groups.of(count).filter(has_none);
        let other_lights = others().map(|[first, end]| end - first).sum::<usize>() as f64;
        let other_weights = others().map(sum_of).sum::<f64>();
        let floor = UNSEEN_SHARE / count as f64;
        let in_view = if enough { 1.0 - floor * other_lights } else { 1.0 };
        let of_group = f64::from(rays).recip();
        let rest = f64::from(rays - with_ray.count_ones()) * of_group;
        let within = |weight: f64, sum: f64, lights: f64| {
            DEFENSIVE_SHARE / lights + (1.0 - DEFENSIVE_SHARE) * if sum > 0.0 { weight / sum } else { lights.recip() }
        };
        let mut light_sampler = Self { cdf: [0.0; MAX_LIGHTS], count };
        let mut cumulative = 0.0;
        for [first, end] in groups.of(count) {
            let (sum, lights) = (sum_of([first, end]), (end - first) as f64);
            for index in first..end {
                let weight = f64::from(weights[index]);
                cumulative += match (with_ray >> first & 1 != 0, enough) {
                    (true, true) => in_view * (of_group * within(weight, sum, lights) + rest * weight / total),
                    (true, false) => of_group * within(weight, sum, lights),
                    (false, true) => floor,
                    (false, false) => rest * within(weight, other_weights, other_lights),
                };
                light_sampler.cdf[index] = cumulative;
            }
        }
        Some(light_sampler)
    }
}

/// Groups, as bits of their first lights, that would get more than one of the rays by their weights: at most all rays but one.
#[inline]
fn strongest(count: usize, groups: LightGroups, rays: u32, sum_of: impl Fn([usize; 2]) -> f64) -> u32 {
    let mut found = 0_u32;
    while found.count_ones() + 1 < rays {
        let (mut sum, mut largest, mut at) = (0.0, 0.0, 0);
        for group in groups.of(count).filter(|&[first, _]| found >> first & 1 == 0) {
            let of_group = sum_of(group);
            sum += of_group;
            if of_group > largest {
                (largest, at) = (of_group, group[0]);
            }
        }
        if !(largest * f64::from(rays - found.count_ones()) > sum) {
            break;
        }
        found |= 1 << at;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles of an area light, and two other lights.
    const GROUPS: LightGroups = LightGroups::from_starts(0b1101);

    fn probabilities(rays: u32, weights: [f32; 4]) -> [f64; 4] {
        let sampler = LightSampler::for_rays(4, GROUPS, rays, |index| weights[index]);
        std::array::from_fn(|index| sampler.probability(&[], index))
    }

    #[track_caller]
    fn assert_near(found: [f64; 4], expected: [f64; 4]) {
        let near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12);
        assert!(near, "{found:?} instead of {expected:?}");
        assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn each_group_has_a_ray_whatever_its_weight() {
        let weights = [3.0, 1.0, 1e-6, 900.0];
        let third = 1.0 / 3.0;
        assert_near(probabilities(3, weights), [third * (0.05 + 0.675), third * (0.05 + 0.225), third, third]);
        // The fourth ray goes to the strongest.
        let found = probabilities(4, weights);
        assert!(found[2] >= 0.25 && (found[0] + found[1]) >= 0.25 && found[3] > 0.49, "{found:?}");
    }

    #[test]
    fn nothing_changes_without_a_strong_group() {
        let weights = [3.0, 1.0, 2.0, 4.0];
        let plain = LightSampler::new(4, |index| weights[index]);
        for (rays, groups) in [(2, GROUPS), (1, GROUPS), (16, LightGroups::default())] {
            let found = LightSampler::for_rays(4, groups, rays, |index| weights[index]);
            assert_eq!(found.cdf(), plain.cdf(), "{rays} rays: no group has more than half of the weight");
        }
        assert!(LightSampler::for_rays(4, GROUPS, 4, |_| 0.0).cdf().is_empty());
    }

    /// Of more groups than rays, the strongest have one ray, and the others share the rest.
    #[test]
    fn no_group_has_more_than_a_ray() {
        let others = |weight: f64| 0.5 * (0.1 / 3.0 + 0.9 * weight / 4.0);
        assert_near(probabilities(2, [1.0, 1.0, 2.0, 40.0]), [others(1.0), others(1.0), others(2.0), 0.5]);
        let of_group = |weight: f64| 0.5 * (0.1 / 2.0 + 0.9 * weight / 40.0);
        let other = |weight: f64| 0.5 * (0.1 / 2.0 + 0.9 * weight / 3.0);
        assert_near(probabilities(2, [10.0, 30.0, 2.0, 1.0]), [of_group(10.0), of_group(30.0), other(2.0), other(1.0)]);
        // Four groups and three rays: two groups are stronger than a ray, the second only among those that are left.
        let groups = LightGroups::from_starts(0b1111);
        let sampler = LightSampler::for_rays(4, groups, 3, |index| [100.0, 8.0, 1.0, 1.0][index]);
        let found: [f64; 4] = std::array::from_fn(|index| sampler.probability(&[], index));
        assert_near(found, [1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0]);
    }

    /// Groups without weight are not counted, but remain possible.
    #[test]
    fn groups_out_of_view_have_hardly_any_rays() {
        let one = 1.0 - 3.0 * UNSEEN_SHARE / 4.0;
        assert_near(
            probabilities(1, [0.0, 0.0, 1.0, 0.0]),
            [0.0, 0.0, 1.0, 0.0].map(|whole| one * whole + 2.5e-4 * (1.0 - whole)),
        );
        let floor = UNSEEN_SHARE / 4.0;
        let half = 0.5 * (1.0 - 2.0 * floor);
        assert_near(probabilities(2, [0.0, 0.0, 1.0, 8.0]), [floor, floor, half, half]);
        let half = 0.5 * (1.0 - floor);
        assert_near(probabilities(2, [1.0, 3.0, 0.0, 8.0]), [half * 0.275, half * 0.725, floor, half]);
    }

    /// Whatever the order of strong and weak lights, one of the rays picks each group that is to have one.
    #[test]
    fn each_group_is_picked_once() {
        let each = LightGroups::from_starts(0b1111);
        for (groups, rays, weights) in [
            (GROUPS, 3, [3.0, 1.0, 0.5, 40.0]),
            (GROUPS, 5, [3.0, 1.0, 0.5, 40.0]),
            (each, 3, [1.0, 100.0, 1.0, 8.0]),
            (each, 2, [1.0, 1.0, 1.0, 8.0]),
        ] {
            let sampler = LightSampler::for_rays(4, groups, rays, |index| weights[index]);
            for word in (0..1000).map(|step| step * 4_294_967 + 77) {
                let ray_to = |ray: u32| {
                    let word = ((u64::from(ray) << 32) + word) / u64::from(rays);
                    sampler.pick(&[], word as u32).0
                };
                let picked: Vec<usize> = (0..rays).map(ray_to).collect();
                for [first, end] in groups.of(4) {
                    let probability: f64 = (first..end).map(|index| sampler.probability(&[], index)).sum();
                    let expected = probability * f64::from(rays);
                    let times = picked.iter().filter(|&&light| (first..end).contains(&light)).count() as f64;
                    // Systematic sampling: the expected number, rounded up or down.
                    assert!((times - expected).abs() < 1.0, "{picked:?}, group {first}: {expected}");
                }
            }
        }
    }
}

//! The part of a segment in the cone of a spot light.

use glam::Vec3;

/// Sine squared of the half angle, and part of it that the leading coefficient is, below which rounding decides what is inside;
/// then the whole segment counts.
const NARROW: f32 = 1e-5;

/// Rounding of the discriminant, relative to its terms, and room at both ends, relative to the part.
const ROUNDING: f32 = 1e-6;
const ROOM: f32 = 1e-3;

/// Distances from `origin`, at most `end` along the unit vector `direction`, between which lie all points in the cone from `apex`
/// around the unit vector `axis` with the versine `versine_outer` of its half angle; `None` if there are none. With some room for
/// rounding, and the whole segment where rounding is too coarse, or the cone is no narrower than a half space.
#[inline]
#[must_use]
pub fn part([origin, direction]: [Vec3; 2], end: f32, [apex, axis]: [Vec3; 2], versine_outer: f32) -> Option<[f32; 2]> {
    let cosine = 1.0 - versine_outer;
    let (sine_squared, cosine_squared) = (versine_outer * (2.0 - versine_outer), cosine * cosine);
    if cosine <= 0.0 || sine_squared < NARROW {
        return Some([0.0, end]);
    }
    // Points inside have a positive height along the axis, and (height · sine)² ≥ (distance from the axis · cosine)², which is
    // a t² + 2 b t + c ≥ 0.
    // Distances t are from the foot of the apex, so that nothing cancels if the line all but meets it.
    let to_apex = apex - origin;
    let foot = to_apex.dot(direction);
    let gap = direction * foot - to_apex;
    let [rise, height] = [direction, gap].map(|vector| vector.dot(axis));
    let [across, beside] = [direction - axis * rise, gap - axis * height];
    let a = sine_squared * (rise * rise) - cosine_squared * across.dot(across);
    let b = sine_squared * (rise * height) - cosine_squared * across.dot(beside);
    let c = sine_squared * (height * height) - cosine_squared * beside.dot(beside);
    if a.abs() < NARROW * sine_squared {
        return Some([0.0, end]);
    }
    // Rounded so that the part grows: for a > 0 it is outside of the roots.
    let discriminant = b * b - a * c - (ROUNDING * (b * b + (a * c).abs())).copysign(a);
    if discriminant <= 0.0 {
        return if a > 0.0 { Some([0.0, end]) } else { None };
    }
    let sum = -(b + discriminant.sqrt().copysign(b));
    let [one, other] = [sum / a, if sum == 0.0 { 0.0 } else { c / sum }];
    let (low, high) = (one.min(other), one.max(other));
    let [first, last] = if a < 0.0 {
        // Both ends are on the cone, or on its mirror image behind the apex.
        if height + rise * (0.5 * (low + high)) < 0.0 {
            return None;
        }
        [foot + low, foot + high]
    } else if rise > 0.0 {
        [foot + high, end]
    } else {
        [0.0, foot + low]
    };
    let room = ROOM * (last.min(end) - first.max(0.0)).abs();
    let (first, last) = ((first - room).max(0.0), (last + room).min(end));
    (first < last).then_some([first, last])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{SplitMix64, unit_f32};
    use crate::sampling;

    /// All points in the cone are in the part, and the part ends near the cone.
    #[test]
    fn parts_are_those_in_the_cone() {
        let mut numbers = SplitMix64(9);
        let mut number = || unit_f32(numbers.word() as u32);
        let (mut parts, mut whole, mut none) = (0, 0, 0);
        for _ in 0..20_000 {
            let mut vector = || sampling::uniform_sphere(number() - 0.5, number());
            let [direction, axis, toward] = [vector(), vector(), vector()];
            let (end, versine) = (3.0 * number(), number() * number() * 1.1 + 1e-4);
            let (origin, apex) = (toward * (2.0 * number()), Vec3::splat(0.1));
            let found = part([origin, direction], end, [apex, axis], versine);
            let inside = |t: f32| {
                let offset = (origin + direction * t - apex).as_dvec3();
                let versine = f64::from(versine);
                offset.dot(axis.as_dvec3()) - (1.0 - versine) * offset.length()
            };
            let steps = 200;
            for step in 0..=steps {
                let t = end * (step as f32 / steps as f32);
                let counts = found.is_some_and(|[first, last]| first <= t && t <= last);
                assert!(counts || inside(t) < 1e-5, "{t} of {found:?}: {}", inside(t));
            }
            match found {
                None => none += 1,
                Some([first, last]) if first == 0.0 && last == end => whole += 1,
                Some([first, last]) => {
                    parts += 1;
                    let near = 0.02 * (last - first);
                    // Unless it all but misses the cone.
                    let is_deep = inside(0.5 * (first + last)) > 0.01;
                    for t in [first + near, last - near] {
                        assert!(!is_deep || inside(t) > -2e-3, "{t} of {found:?}: {}", inside(t));
                    }
                }
            }
        }
        assert!(parts > 3000 && whole > 500 && none > 3000, "{parts} {whole} {none}");
    }
}

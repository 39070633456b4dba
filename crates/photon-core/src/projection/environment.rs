//! Cells of an environment: a disc across each direction, around the specular surfaces, times the directions.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use glam::{DVec2, DVec3, Vec3};

use super::clusters::Sphere;
use crate::scene::environment::EnvironmentMap;
use crate::scene::light::Light;

/// The disc through which the aimed photons of a light that is infinitely far away start: across each direction of an
/// environment, and across the axis of a directional light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ProjectionDisc {
    /// Its centre, normalised space.
    pub centre: Vec3,
    /// Its radius.
    pub radius: f32,
}

impl ProjectionDisc {
    /// A disc that every line of a photon through one of the spheres crosses, at most that of all photons of `light`.
    pub(super) fn around(spheres: &[Sphere], light: &Light) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for sphere in spheres {
            low = low.min(sphere.centre - sphere.radius);
            high = high.max(sphere.centre + sphere.radius);
        }
        let centre = (0.5 * (low + high)).as_vec3();
        let axis = Vec3::from(light.direction).as_dvec3();
        let reach = |sphere: &Sphere| {
            let from_centre = sphere.centre - centre.as_dvec3();
            if light.kind == Light::ENVIRONMENT {
                return from_centre.length() + sphere.radius;
            }
            let aside = slope(light) * (from_centre.dot(axis).abs() + sphere.radius);
            from_centre.reject_from_normalized(axis).length() + sphere.radius + aside
        };
        let radius = (spheres.iter().map(reach).fold(0.0, f64::max) as f32).next_up();
        if radius < light.radius { Self { centre, radius } } else { Self { centre: Vec3::ZERO, radius: light.radius } }
    }

    /// Its area over that of the disc of all photons of `light`.
    pub(super) fn share(&self, light: &Light) -> f64 {
        (f64::from(self.radius) / f64::from(light.radius)).powi(2)
    }

    pub(super) fn words(&self) -> [u32; 4] {
        [self.centre.x, self.centre.y, self.centre.z, self.radius].map(f32::to_bits)
    }

    pub(super) fn from_words(words: [u32; 4]) -> Self {
        let [x, y, z, radius] = words.map(f32::from_bits);
        Self { centre: Vec3::new(x, y, z), radius }
    }
}

/// Tangent of the largest angle between a photon of a directional light and its axis.
pub(super) fn slope(light: &Light) -> f64 {
    let versine = f64::from(light.versine_outer);
    (versine * (2.0 - versine)).sqrt() / (1.0 - versine)
}

/// The directions of all blocks of cells, and the disc.
pub(super) struct EnvironmentBeams {
    disc: ProjectionDisc,
    /// Those of all blocks of 0 bits for each number of the direction, of 1 bit, and so on.
    caps: Vec<Cap>,
}

/// The directions of a block: all within an angle to an axis.
#[derive(Clone, Copy)]
pub(super) struct Cap {
    angle: f64,
    /// For the bases of directions with z ≥ 0 and of those with z < 0: tangent and bitangent of the axis, and the largest
    /// angle by which the basis of a direction is turned from that of the axis. None if no direction has that basis.
    bases: [Option<([DVec3; 2], f64)>; 2],
}

/// With larger angles, a block is not tested.
const MAX_ANGLE: f64 = 1.0;

impl EnvironmentBeams {
    pub(super) fn new(map: &EnvironmentMap, disc: ProjectionDisc, direction_bits: u32) -> Self {
        let blocks = (0..=direction_bits).flat_map(|bits| (0..1 << (2 * bits)).map(move |at: u32| (at, bits)));
        let caps = blocks.map(|(at, bits)| Cap::of(map, [at >> bits, at & ((1 << bits) - 1)], bits)).collect();
        Self { disc, caps }
    }

    /// The cap of a block of directions.
    pub(super) fn cap(&self, [row, column]: [u32; 2], bits: u32) -> &Cap {
        let before = ((1_usize << (2 * bits)) - 1) / 3;
        &self.caps[before + (row << bits | column) as usize]
    }

    /// Whether a photon that starts in a part of the disc, given by centre and radius for a disc of radius 1, could hit a
    /// sphere. Conservative.
    pub(super) fn meets(&self, cap: &Cap, (centre, radius): (DVec2, f64), sphere: &Sphere) -> bool {
        if cap.angle > MAX_ANGLE {
            return true;
        }
        let scale = f64::from(self.disc.radius);
        let from_centre = sphere.centre - self.disc.centre.as_dvec3();
        // A direction and the start of its photon are those of the axis, turned by the angle between the bases. Seen from
        // the axis, the sphere is turned back by it.
        cap.bases.iter().flatten().any(|([tangent, bitangent], turned)| {
            let at = DVec2::new(from_centre.dot(*tangent), from_centre.dot(*bitangent));
            at.distance(centre * scale) <= radius * scale + sphere.radius + from_centre.length() * turned
        })
    }
}

impl Cap {
    fn of(map: &EnvironmentMap, block: [u32; 2], bits: u32) -> Self {
        let ([top, bottom], turns) = directions(map, block, bits);
        let middle = 0.5 * (top + bottom);
        let steepest =
            if top <= FRAC_PI_2 && bottom >= FRAC_PI_2 { 1.0 } else { libm::sin(top).max(libm::sin(bottom)) };
        // At most the length of the path that is linear in both angles; and rounding.
        let angle = libm::hypot(0.5 * (bottom - top), 0.5 * steepest * TAU * (turns[1] - turns[0])) + 1e-5;
        let (sin, cos) = libm::sincos(TAU * (0.5 * (turns[0] + turns[1]) - 0.5 - f64::from(map.rotation())));
        // Photons fly away from where they come from.
        let axis = -DVec3::new(sin * libm::sin(middle), libm::cos(middle), -cos * libm::sin(middle));
        let basis = |sign: f64| {
            let from_pole = libm::acos((axis.z * sign).clamp(-1.0, 1.0));
            (angle <= MAX_ANGLE && from_pole - angle <= FRAC_PI_2).then(|| {
                // The basis is that of the pole, turned along a great circle. A step of the direction turns it as far, and
                // about the direction by at most the tangent of half the angle from the pole, which exceeds a quarter turn by
                // at most the angle to a direction that has this basis.
                let spin = libm::tan((0.5 * (from_pole + angle)).min(FRAC_PI_4 + 0.5 * angle));
                (basis_of(axis, sign), angle * (1.0 + spin * spin).sqrt())
            })
        };
        Self { angle, bases: [basis(1.0), basis(-1.0)] }
    }
}

/// [`crate::shading::sampling::basis`] for a given sign of z, which a direction near the plane z = 0 need not have.
fn basis_of(n: DVec3, sign: f64) -> [DVec3; 2] {
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y)]
}

/// A height in the image: `sin²(θ/2)` and `cos²(θ/2)`.
struct Place {
    from_top: f64,
    from_bottom: f64,
}

impl Place {
    fn theta(&self) -> f64 {
        2.0 * libm::atan2(self.from_top.max(0.0).sqrt(), self.from_bottom.max(0.0).sqrt())
    }
}

/// The smallest and the largest θ of the directions of a block, and the same of their turns along the rows of the image.
fn directions(map: &EnvironmentMap, block: [u32; 2], bits: u32) -> ([f64; 2], [f64; 2]) {
    let [(first, last), (left, right)] = block.map(|at| words(at, bits));
    // From the nearer pole, as directions are sampled: what the other pole's number leaves is rounded.
    let place = |(row, within): (usize, f64)| {
        let cell = map.rows()[row];
        let [above, below, extent] = [cell.above, cell.below, cell.extent].map(f64::from);
        let from_top = above + extent * within;
        if from_top < 0.5 {
            Place { from_top, from_bottom: 1.0 - from_top }
        } else {
            let from_bottom = below + extent * (1.0 - within);
            Place { from_top: 1.0 - from_bottom, from_bottom }
        }
    };
    let (top, bottom) = (interval(map.row_starts(), first, 0.0), interval(map.row_starts(), last, 1.0));
    let columns = map.columns() as usize;
    let mut turns = [f64::INFINITY, f64::NEG_INFINITY];
    for row in top.0..=bottom.0 {
        let starts = &map.column_starts()[row * columns..(row + 1) * columns];
        let turn = |(column, within): (usize, f64)| {
            let begin = column as u32 * map.step();
            let texels = (begin + map.step()).min(map.width()) - begin;
            (f64::from(begin) + 0.5 + f64::from(texels) * within) / f64::from(map.width())
        };
        turns[0] = turns[0].min(turn(interval(starts, left, 0.0)));
        turns[1] = turns[1].max(turn(interval(starts, right, 1.0)));
    }
    ([place(top), place(bottom)].map(|place| place.theta()), turns)
}

/// The first and the last random word of part `at` of 2^`bits`.
fn words(at: u32, bits: u32) -> (u32, u32) {
    let width = 1_u64 << (32 - bits);
    let first = u64::from(at) * width;
    (first as u32, (first + width - 1) as u32)
}

/// The interval of `starts` that contains a word, and the position in it of the word (`after` 0) or of the end of its step (1).
fn interval(starts: &[u32], word: u32, after: f64) -> (usize, f64) {
    let index = starts.partition_point(|&start| start <= word) - 1;
    let end = starts.get(index + 1).map_or(1_u64 << 32, |&end| u64::from(end));
    let begin = u64::from(starts[index]);
    (index, ((u64::from(word) - begin) as f64 + after) / (end - begin) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;
    use crate::shading::sampling;

    fn map(width: usize, height: usize) -> EnvironmentMap {
        let mut numbers = SplitMix64(width as u64);
        let texel = |word: u64| if word.is_multiple_of(97) { 1000.0 } else { (word % 100) as f32 * 0.01 };
        let mut texels: Vec<[f32; 3]> = (0..width * height).map(|_| [texel(numbers.word()); 3]).collect();
        if height > 1000 {
            // Next to the lower pole, angles are the roots of differences from 1.
            texels[(height - 1) * width..].fill([1e9; 3]);
        }
        EnvironmentMap::new(width, &texels, 0.3).unwrap()
    }

    /// All directions of a block are in its cap, and its cap has a basis from which that of the direction is turned by no
    /// more than the cap says.
    #[test]
    fn directions_are_in_their_caps() {
        let disc = ProjectionDisc { centre: Vec3::ZERO, radius: 1.0 };
        for (width, height) in [(1, 1), (2, 1), (64, 32), (4100, 8), (2, 2000)] {
            let (map, mut numbers) = (map(width, height), SplitMix64(5));
            let beams = EnvironmentBeams::new(&map, disc, 5);
            let mut tested = 0;
            for _ in 0..50_000 {
                let word = numbers.word();
                let random = [word as u32, (word >> 32) as u32];
                let direction = -map.sample(random).direction;
                for bits in 0..=5_u32 {
                    let cap = beams.cap(random.map(|w| (u64::from(w) >> (32 - bits)) as u32), bits);
                    if cap.angle > MAX_ANGLE {
                        continue;
                    }
                    tested += 1;
                    let ([t, b], turned) = cap.bases[usize::from(direction.z.is_sign_negative())].unwrap();
                    let axis = t.cross(b);
                    let from_axis = 2.0 * libm::asin(0.5 * direction.as_dvec3().distance(axis));
                    assert!(from_axis <= cap.angle, "{width} × {height}, {bits} bits: {from_axis} > {}", cap.angle);
                    let (tangent, bitangent) = sampling::basis(direction);
                    let columns = [tangent, bitangent, direction].map(Vec3::as_dvec3);
                    // The root of the sum of squared differences of two bases is √8 times the sine of half the angle; directions of
                    // single precision add to it.
                    let squares = columns.iter().zip([t, b, axis]).map(|(a, b)| a.distance_squared(b)).sum::<f64>();
                    let angle = 2.0 * libm::asin((squares / 8.0).sqrt());
                    assert!(angle <= turned + 2e-6, "{bits} bits: {angle} > {turned}");
                }
            }
            assert!(tested > 100_000, "{width} × {height}: {tested}");
        }
    }

    /// Photons that hit a sphere are in blocks that meet it: for discs around it and for one that is much larger.
    #[test]
    fn photons_that_hit_are_in_blocks_that_meet() {
        let map = map(64, 32);
        let (mut hits, mut apart) = (0, 0);
        for (i, radius) in [0.06_f32, 0.2, 0.8].into_iter().enumerate() {
            let disc = ProjectionDisc { centre: Vec3::new(0.1, -0.2, 0.15 * i as f32), radius };
            let beams = EnvironmentBeams::new(&map, disc, 5);
            let sphere = Sphere {
                centre: disc.centre.as_dvec3() + f64::from(radius) * DVec3::new(0.3, 0.5, -0.4),
                radius: 0.02,
            };
            let mut numbers = SplitMix64(9);
            for _ in 0..200_000 {
                let (point, way) = (numbers.word(), numbers.word());
                let random = [way as u32, (way >> 32) as u32];
                let direction = -map.sample(random).direction;
                let (tangent, bitangent) = sampling::basis(direction);
                let unit = |word: u64| (word >> 40) as f32 / 16_777_216.0;
                let (x, y) = sampling::disc(unit(point), unit(point << 24));
                let start = (disc.centre + (tangent * x + bitangent * y) * radius).as_dvec3();
                let across = (sphere.centre - start).reject_from_normalized(direction.as_dvec3());
                let cap = beams.cap(random.map(|w| w >> 27), 5);
                let at = DVec2::new(f64::from(x), f64::from(y));
                let meets = beams.meets(cap, (at, 1e-6), &sphere);
                if across.length() < sphere.radius {
                    hits += 1;
                    assert!(meets, "{across} {direction}");
                } else if !meets {
                    apart += 1;
                }
            }
        }
        assert!(hits > 5000 && apart > 300_000, "{hits} {apart}");
    }
}

//! Lines through portals: where photons of infinitely distant lights start.
//!
//! The lines along one direction ω are sampled by two techniques: through a uniform point of the disc of radius R that
//! contains the scene's projection, with density 1/(πR²) per projected area, or through a point of the portals, uniform in
//! projected area, with density n/a. a(ω) = Σ Aᵢ |nᵢ·ω| is the projected area of all portals, n the number of portals that
//! the line crosses. Weights are those of the balance heuristic (Veach 1997, equation 9.13), so that expectations are the
//! same whatever portals there are.

use glam::Vec3;

use crate::scene::portal::Portal;
use crate::shading::sampling;

/// Share of the photons that start from the disc, where portals are seen at all. With one half, the density of
/// every line is at least half of that of either technique alone, so that no estimate needs more than twice the photons.
pub const DISC_SHARE: f32 = 0.5;

/// Random words below this choose the disc.
const DISC_WORDS: u32 = 1 << 31;

/// Projected areas up to this count as none, so that no quotient overflows.
const NO_AREA: f32 = 1e-25;

/// A line along a given direction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PortalLine {
    /// Its point in the plane through the origin that is perpendicular to its direction.
    pub across: Vec3,
    /// The density of the disc over that of both techniques: the factor on the power that photons from the disc alone
    /// have. At most `1 / DISC_SHARE`.
    pub factor: f32,
}

/// The projected area of a portal along `direction`.
#[inline]
#[must_use]
pub fn projected_area(portal: &Portal, direction: Vec3) -> f32 {
    Vec3::from(portal.area).dot(direction).abs()
}

/// The sum of the projected areas of `portals` along `direction`, a unit vector.
#[inline]
#[must_use]
pub fn total_area(portals: &[Portal], direction: Vec3) -> f32 {
    portals.iter().fold(0.0, |sum, portal| sum + projected_area(portal, direction))
}

/// Whether the line along `direction` through `across` crosses a portal, in whichever sense.
#[inline]
#[must_use]
pub fn crosses(portal: &Portal, across: Vec3, direction: Vec3) -> bool {
    // Cramer's rule (Möller and Trumbore 1997), without the division.
    let [first, second] = portal.edges.map(Vec3::from);
    let from_corner = across - Vec3::from(portal.corner);
    let twice = 2.0 * Vec3::from(portal.area).dot(direction);
    let sign = if twice < 0.0 { -1.0 } else { 1.0 };
    let u = sign * from_corner.dot(second.cross(direction));
    let v = sign * from_corner.dot(direction.cross(first));
    u >= 0.0 && v >= 0.0 && u + v <= sign * twice
}

/// Samples a line along `direction`, a unit vector: `choice` is a random word, `point` are two uniform numbers, `radius` is
/// that of the disc.
#[inline]
#[must_use]
pub fn sample(portals: &[Portal], direction: Vec3, choice: u32, point: [f32; 2], radius: f32) -> PortalLine {
    let total = total_area(portals, direction);
    let seen = total > NO_AREA;
    let [u, v] = point;
    let (chosen, across) = if seen && choice >= DISC_WORDS {
        // 24 bits are exact in f32.
        let target = ((choice - DISC_WORDS) >> 8) as f32 * (1.0 / 8_388_608.0) * total;
        let chosen = choose(portals, direction, target);
        (Some(chosen), through(&portals[chosen], direction, u, v))
    } else {
        let (x, y) = sampling::disc(u, v);
        let (tangent, bitangent) = sampling::basis(direction);
        (None, (tangent * x + bitangent * y) * radius)
    };
    if !seen {
        return PortalLine { across, factor: 1.0 };
    }
    // By rounding, a line might miss the portal that it was made for.
    let crossed = |(index, portal): &(usize, &Portal)| Some(*index) == chosen || crosses(portal, across, direction);
    let count = portals.iter().enumerate().filter(crossed).count() as f32;
    let disc = std::f32::consts::PI * radius * radius;
    PortalLine { across, factor: total / (DISC_SHARE * total + (1.0 - DISC_SHARE) * count * disc) }
}

/// The portal in whose interval of the running sum of projected areas `target` lies.
#[inline]
fn choose(portals: &[Portal], direction: Vec3, target: f32) -> usize {
    let (mut sum, mut chosen) = (0.0, 0);
    for (index, portal) in portals.iter().enumerate() {
        let area = projected_area(portal, direction);
        // Those that are seen edge-on have no interval, not even if rounding places `target` behind the last.
        if area > 0.0 && sum <= target {
            chosen = index;
        }
        sum += area;
    }
    chosen
}

/// The line along `direction` through a uniform point of a portal.
#[inline]
fn through(portal: &Portal, direction: Vec3, u: f32, v: f32) -> Vec3 {
    let (first, second) = sampling::triangle(u, v);
    let [one, two] = portal.edges.map(Vec3::from);
    let point = Vec3::from(portal.corner) + one * first + two * second;
    point - direction * point.dot(direction)
}

#[cfg(test)]
mod tests;

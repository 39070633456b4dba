//! Flights, phase functions and places on segments compared with photon-core's.

use photon_core::Medium;
use photon_core::equiangular::{Equiangular, exponential, exponential_density};
use photon_core::flight::{self, FOCUSED_DEPOSITS, Flight};
use photon_core::phase::{Mie, Phase};

use super::compare::Bound;
use super::draw::{Draw, input};
use super::table::{Row, output};
use super::{Input, assert_twin};
use crate::{Vulkan, shaders};

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_MEDIUM;
    let row = |name, function, bound, draw, twin| Row { name, module, function, bound, draw, twin };
    vec![
        // A square root and two divisions, relative to the smallest 1 + α cos².
        row("phase_value", 0, Bound::Relative(2e-6), scattered, |i| {
            output([phase(i, 7).value(i.vector(4), i.vector(8))])
        }),
        // A share of the light with twice the error of a division, the cosine that belongs to it, and the sine of it.
        row("phase_sample", 1, Bound::Conditioned(1.5e-6, "its condition", slope_of_direction), sampled, |i| {
            output(phase(i, 8).sample(i.vector(4), [i.float(7), i.float(11)]).to_array())
        }),
        // The error of a length by a division, times coefficients, and three divisions.
        row("flight_sample", 2, Bound::Scaled(1e-6, "its condition", depths), stretch, |i| {
            match flight::sample(&medium(i), i.vector(8), i.float(3), [i.float(7), i.float(11)]) {
                Flight::Passes(left) => output([left.x, left.y, left.z, -1.0, 1.0]),
                Flight::Collides(found) => {
                    let power = found.power;
                    output([power.x, power.y, power.z, found.distance, found.albedo])
                }
            }
        }),
        row("flight_deposit", 3, Bound::Scaled(1.5e-6, "its condition", depths), stretch, |i| {
            let (far, left) =
                flight::deposit(&medium(i), i.vector(8), i.float(3), FOCUSED_DEPOSITS, [i.float(7), i.float(11)]);
            output([left.x, left.y, left.z, far])
        }),
        // The angle has the error of a division, and the height that of a square root.
        row("equiangular_sample", 4, Bound::Conditioned(2e-6, "its condition", lengths), seen, |i| {
            output([angles(i).sample(i.float(7))])
        }),
        row("equiangular_density", 5, Bound::Relative(2.5e-6), seen, |i| {
            output([angles(i).density(i.float(7) * i.float(3))])
        }),
        row("exponential_sample, density", 6, Bound::Relative(7e-7), stretch, |i| {
            let (extinction, end) = (i.float(0), i.float(3));
            output([exponential(extinction, end, i.float(7)), exponential_density(extinction, end, i.float(11) * end)])
        }),
        // A square root and two divisions.
        row("flight_thinned", 7, Bound::Relative(1e-6), far_away, |i| {
            let left = flight::thinned(i.vector(0), i.vector(4), i.vector(8), i.float(7));
            left.map_or(output([0.0; 4]), |left| output([left.x, left.y, left.z, 1.0]))
        }),
    ]
}

/// Change of a direction by that of the random number: of the cosine, which is large where little light is scattered, and of
/// the sine by that of the cosine; near 0, of a sine that is the root of a rounding error.
fn slope_of_direction(i: &Input) -> f64 {
    const STEP: f32 = 1e-3;
    let (from, u) = (i.vector(4), i.float(7));
    let at = |u: f32| phase(i, 8).sample(from, [u, i.float(11)]);
    let [low, high] = [(u - STEP).max(0.0), (u + STEP).min(1.0_f32.next_down())];
    let cosine = f64::from(from.dot(at(high) - at(low)).abs() / (high - low));
    (1.0 + cosine) / f64::from(from.cross(at(u)).length()).max(1e-3)
}

fn medium(i: &Input) -> Medium {
    let three = |at: usize| i.vector(at).to_array();
    Medium { scattering: three(0), absorption: three(4), ..Medium::VACUUM }
}

/// The depths of all channels by which a power or a place may change.
fn depths(i: &Input) -> f64 {
    1.0 + 2.0 * f64::from(medium(i).extinction().element_sum() * i.float(3))
}

fn angles(i: &Input) -> Equiangular {
    Equiangular::new(i.vector(0), i.vector(4), i.float(3), i.vector(8))
}

/// The distance, and the change of it by a turn of the angle seen from the point.
fn lengths(i: &Input) -> f64 {
    let distance = angles(i).sample(i.float(7));
    f64::from(distance) + f64::from(1.0 / angles(i).density(distance))
}

/// The phase function whose parameters are first, with the kind at this place.
fn phase(i: &Input, kind: usize) -> Phase {
    let draine = [i.float(1), i.float(2), i.float(3)];
    Phase::of(&Medium { phase: i.float(kind) as u32, anisotropy: i.float(0), draine, ..Medium::VACUUM })
}

/// A phase function: its parameters and its kind.
fn function(d: &mut Draw) -> ([f32; 4], f32) {
    let henyey_greenstein = Phase::HenyeyGreenstein(d.pick(&[0.0, 1e-8, 0.3, -0.6, 0.9, -0.99, 0.999]));
    let mie = Phase::Mie(Mie::droplets(d.pick(&[5.0, 7.0, 10.0, 20.0, 50.0])));
    let medium = Medium::VACUUM.with_phase(d.pick(&[henyey_greenstein, Phase::Rayleigh, mie]));
    let [draine, alpha, share] = medium.draine;
    ([medium.anisotropy, draine, alpha, share], medium.phase as f32)
}

/// A phase function, and two directions.
fn scattered(d: &mut Draw) -> Input {
    let ((phase, kind), from, to) = (function(d), d.direction(), d.direction());
    input(phase, [from.x, from.y, from.z, kind], [to.x, to.y, to.z, 0.0])
}

/// A phase function, a direction, and two random numbers.
fn sampled(d: &mut Draw) -> Input {
    let ((phase, kind), from) = (function(d), d.direction());
    input(phase, [from.x, from.y, from.z, d.unit()], [kind, 0.0, 0.0, d.unit()])
}

/// Coefficients, a power, the length of a stretch, and two random numbers.
fn stretch(d: &mut Draw) -> Input {
    // Depths below 87, where the twins of exp end: beside it they differ by all of a negligible value.
    let end = d.pick(&[0.01, 0.3, 1.0]);
    let mut coefficient = || d.pick(&[0.0, 1.0, 1.0, 1.0]) * d.magnitude(-20, 5);
    let [a, b, c, e, f, g] = [(); 6].map(|()| coefficient());
    let mut channel = || d.pick(&[0.0, 1.0, 1.0]) * d.magnitude(-6, 3);
    let [r, s, t] = [(); 3].map(|()| channel());
    input([a.max(1e-6), b, c, end], [e, f, g, d.unit()], [r.max(1e-3), s, t, d.unit()])
}

/// A power now and at the start, a random number, and a position.
fn far_away(d: &mut Draw) -> Input {
    let mut power = |share: f32| [(); 3].map(|()| share * d.pick(&[0.0, 1.0, 1.0]) * d.magnitude(-3, 0));
    let ([r, s, t], [x, y, z]) = (power(1.0), power(1.0));
    let share = d.pick(&[1.0, 1.0, 40.0]);
    let position = d.direction() * d.magnitude(-2, 8);
    input(
        [share * r, share * s, share * t, 0.0],
        [x.max(1e-3), y, z, d.unit()],
        [position.x, position.y, position.z, 0.0],
    )
}

/// A segment, and a point.
fn seen(d: &mut Draw) -> Input {
    let (origin, direction, point) = (d.point(), d.direction(), d.point());
    let end = d.pick(&[0.01, 0.5, 3.0]);
    input(
        [origin.x, origin.y, origin.z, end],
        [direction.x, direction.y, direction.z, d.unit()],
        [point.x + 0.1, point.y + 0.2, point.z, 0.0],
    )
}

/// A phase function of the other sign is detected.
#[test]
fn functions_are_those_of_the_library() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    for row in rows() {
        assert_twin(&mut on, &row, &[], |i| output([i.float(3) + 0.01; 5]));
    }
}

//! Flights, phase functions and places on segments compared with photon-core's.

use photon_core::equiangular::{Equiangular, exponential, exponential_density};
use photon_core::flight::{self, FOCUSED_DEPOSITS, Flight};
use photon_core::{Medium, phase};

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
        // A square root and a division.
        row("phase_value", 0, Bound::Relative(1e-6), scattered, |i| output([phase::value(i.float(0), i.float(1))])),
        // A cosine with twice the error of a division, and the sine of it.
        row("phase_sample", 1, Bound::Conditioned(1.5e-6, "its condition", slope_of_sine), scattered, |i| {
            output(phase::sample(i.float(0), i.vector(4), [i.float(7), i.float(11)]).to_array())
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
    ]
}

/// Change of a sine by that of the cosine; near 0, of a sine that is the root of a rounding error.
fn slope_of_sine(i: &Input) -> f64 {
    let direction = phase::sample(i.float(0), i.vector(4), [i.float(7), i.float(11)]);
    let sine = i.vector(4).cross(direction).length();
    1.0 / f64::from(sine).max(1e-3)
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

/// Anisotropy and cosine; a direction and two random numbers.
fn scattered(d: &mut Draw) -> Input {
    let g = d.pick(&[0.0, 1e-8, 0.3, -0.6, 0.9, -0.99, 0.999]);
    let (cosine, direction) = (d.pick(&[-1.0, 1.0, 0.0, 0.999]) * d.unit(), d.direction());
    input([g, cosine, 0.0, 0.0], [direction.x, direction.y, direction.z, d.unit()], [0.0, 0.0, 0.0, d.unit()])
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

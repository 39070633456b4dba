//! Cosines to shading normals compared with photon-core's.

use photon_core::Lobe;
use photon_core::glam::Vec3;
use photon_core::shading_normal::{MAX_RATIO, bend, cosine, cosine_ratio, on_side_of, photon_factor};

use super::compare::Bound;
use super::draw::{Draw, input};
use super::table::{Row, Twin, output};
use super::{Input, Output, assert_twin};
use crate::{Vulkan, shaders};

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_SHADING_NORMAL;
    let row = |name, function, bound, twin| Row { name, module, function, bound, draw: directions, twin };
    // The limit multiplies what flushing changes.
    let limited = Bound::BitsMagnified(|_| f64::from(MAX_RATIO));
    vec![
        row("shading_cosine", 0, limited, |i| output([cosine(i.vector(0), i.vector(4), i.vector(8))])),
        // A quotient of two scalar products.
        row("shading_cosine_ratio", 1, Bound::Relative(4e-7), |i| {
            output([cosine_ratio(i.vector(0), i.vector(4), i.vector(8))])
        }),
        // As `normalize_or`, of the same vector.
        row("shading_bend", 2, Bound::Within(1e-6), |i| vectors([bend(i.vector(8), i.vector(4)), Vec3::ZERO])),
        row("shading_on_side", 3, Bound::Bits, |i| vectors(sides(i, i.vector(0)))),
        row("shading_specular_factor", 4, Bound::Relative(4e-7), |i| {
            output([photon_factor(Lobe::SpecularReflection, incoming(i), i.vector(0), i.vector(4), i.vector(8))])
        }),
    ]
}

/// A direction, the geometric normal, the shading normal, and the direction of arrival.
fn directions(d: &mut Draw) -> Input {
    let (direction, geometric, arrives) = (unit(d), unit(d), unit(d));
    // Shading normals near the geometric one, near its plane, and opposite to it.
    let other = unit(d);
    let near = (geometric + other * 0.4).normalize_or(geometric);
    let across = (other - geometric * other.dot(geometric)).normalize_or(geometric);
    let flat = (across + geometric * d.pick(&[0.0, 1e-3, -1e-3, 2e-3, 1e-6])).normalize_or(geometric);
    let shading = d.pick(&[near, near, flat, other, geometric, -geometric]);
    let with = |v: Vec3, w: f32| v.extend(w).to_array();
    input(with(direction, arrives.x), with(geometric, arrives.y), with(shading, arrives.z))
}

/// A unit vector, without coordinates whose products are below the normal range: a device that flushes them would change
/// quotients by any amount.
fn unit(d: &mut Draw) -> Vec3 {
    d.direction().map(|x| if x.abs() < 1e-8 { 0.0 } else { x })
}

fn incoming(i: &Input) -> Vec3 {
    Vec3::new(i.float(3), i.float(7), i.float(11))
}

/// `direction` on the side of a reflection and on that of a transmission.
fn sides(i: &Input, direction: Vec3) -> [Vec3; 2] {
    [Lobe::SpecularReflection, Lobe::SpecularTransmission].map(|lobe| on_side_of(lobe, direction, i.vector(4)))
}

fn vectors([a, b]: [Vec3; 2]) -> Output {
    output([a.x, a.y, a.z, 0.0, b.x, b.y, b.z, 0.0])
}

#[test]
fn cosines_to_shading_normals_are_those_of_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    for row in rows() {
        // The two normals exchanged, a bend by the other sign, no mirroring, the factor of diffuse surfaces: all are
        // detected.
        let wrong: Twin = match row.function {
            0 => |i| output([cosine(i.vector(0), i.vector(8), i.vector(4))]),
            1 => |i| output([cosine_ratio(i.vector(0), i.vector(8), i.vector(4))]),
            2 => |i| vectors([bend(i.vector(8), -i.vector(4)), Vec3::ZERO]),
            3 => |i| vectors([i.vector(0); 2]),
            _ => |i| output([photon_factor(Lobe::Diffuse, incoming(i), i.vector(0), i.vector(4), i.vector(8))]),
        };
        assert_twin(&mut on, &row, &[], wrong);
    }
}

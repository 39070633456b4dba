//! Simulation of a device that flushes denormals to 0: which differences the comparison accepts.

use std::ops::{Add, Div, Mul, Sub};

use super::compare::{Denormals, worst};
use super::draw::inputs;
use super::table::{Row, output, rows};
use super::{Input, Output};

/// Flushes values below 2 to the power of `EXPONENT` to 0, before and after each operation.
#[derive(Clone, Copy)]
struct Flushing<const EXPONENT: i32>(f32);

impl<const EXPONENT: i32> Flushing<EXPONENT> {
    fn of(x: f32) -> Self {
        Self(if x.abs() < 2.0_f32.powi(EXPONENT) { 0.0 } else { x })
    }
}

macro_rules! operation {
    ($($trait:ident $method:ident),+) => {$(
        impl<const EXPONENT: i32> $trait for Flushing<EXPONENT> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self::of(self.0.$method(other.0))
            }
        }
    )+};
}
operation!(Add add, Sub sub, Mul mul, Div div);

fn vector<const E: i32>(i: &Input, place: usize) -> [Flushing<E>; 3] {
    [0, 1, 2].map(|axis| Flushing::of(i.float(place + axis)))
}

fn cross_and_dot<const E: i32>(i: &Input) -> Output {
    let (a, b) = (vector::<E>(i, 0), vector::<E>(i, 4));
    let cross = [0, 1, 2].map(|axis| {
        let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
        a[y] * b[z] - b[y] * a[z]
    });
    let dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    output([cross[0].0, cross[1].0, cross[2].0, dot.0])
}

fn barycentric<const E: i32>(i: &Input) -> Output {
    let [a, b, c] = [0, 4, 8].map(|place| vector::<E>(i, place));
    let [one, u, v] = [1.0, i.float(3), i.float(7)].map(Flushing::of);
    output([0, 1, 2].map(|axis| (a[axis] * (one - u - v) + b[axis] * u + c[axis] * v).0))
}

fn cube_root<const E: i32>(i: &Input) -> Output {
    let bits = i.0[0];
    if bits.wrapping_sub(0x0080_0000) >= 0x7F00_0000 {
        return output([0.0]);
    }
    let [x, one, third] = [i.float(0), 1.0, 0.333_333_33].map(Flushing::<E>::of);
    let mut r = Flushing::of(f32::from_bits(0x54A2_3400 - bits / 3));
    for _ in 0..3 {
        r = r + r * ((one - x * r * r * r) * third);
    }
    let y = x * r * r;
    output([(y + (x - y * y * y) * (r * r * third)).0])
}

/// Without the steep and the diagonal part, whose results are not small.
fn turns_of<const E: i32>(row: &Row, i: &Input) -> Output {
    let (y, x) = (i.float(0), i.float(1));
    if y > 0.4 * x {
        return (row.twin)(i);
    }
    let t = Flushing::<E>::of(y) / Flushing::of(x);
    output([(t * Flushing::of(0.159_154_94)).0])
}

/// The functions whose results flushing affects. Each one fails the bound for devices that preserve denormals,
/// passes the one for devices that flush, and fails the latter if larger numbers are flushed as well.
#[test]
fn numbers_below_the_normal_range_may_be_0_and_no_others() {
    type Flushed = fn(&Row, &Input) -> Output;
    let functions: [(&str, Flushed, Flushed); 4] = [
        ("cross3, dot3", |_, i| cross_and_dot::<-126>(i), |_, i| cross_and_dot::<-110>(i)),
        ("barycentric", |_, i| barycentric::<-126>(i), |_, i| barycentric::<-90>(i)),
        ("cube_root", |_, i| cube_root::<-126>(i), |_, i| cube_root::<-110>(i)),
        ("turns_of", turns_of::<-126>, turns_of::<-80>),
    ];
    for (name, flushes, flushes_more) in functions {
        let row = rows().into_iter().find(|row| row.name == name).unwrap();
        // Restricted to small values, since the polynomial of `turns_of` is not simulated above.
        let inputs: Vec<Input> =
            inputs(row.draw).into_iter().filter(|i| name != "turns_of" || i.float(0) < 1e-4 * i.float(1)).collect();
        let by = |function: Flushed| inputs.iter().map(|input| function(&row, input)).collect::<Vec<_>>();
        let (flushed, more) = (by(flushes), by(flushes_more));
        assert!(worst(&row, &inputs, &flushed, Denormals::Kept).is_err(), "{name}: nothing was flushed");
        worst(&row, &inputs, &flushed, Denormals::Flushed).unwrap();
        assert!(
            worst(&row, &inputs, &more, Denormals::Flushed).is_err(),
            "{name}: flushing larger numbers was accepted"
        );
    }
}

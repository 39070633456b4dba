//! Stacks of media, their boundaries and transmittance compared with photon-core's.

use std::sync::LazyLock;

use photon_core::glam::Vec3;
use photon_core::random::unit_f32;
use photon_core::{
    Material, MaterialKind, MediaFeatures, Medium, MediumStack, Spectrum, SpectrumCell, Wavelength, flight, interface,
    math, radiance_scale,
};

use super::compare::Bound;
use super::draw::Draw;
use super::table::{Row, output, words};
use super::{Input, Output, run_with, worst_of};
use crate::{Vulkan, shaders};

specialized!(media_constants: MediaConstants => PROBE_MEDIA, 2 function: u32, 3 media: MediaFeatures; default shared_groups);

/// All features of media without the tables that the scene of the probe has not: grids of densities and boundaries.
const HOMOGENEOUS: MediaFeatures = MediaFeatures::ALL.difference(MediaFeatures::GRIDS.union(MediaFeatures::BOUNDARIES));

/// Coefficients of Sellmeier's formula.
const BK7: [f32; 6] = [1.039_612, 0.231_792_34, 1.010_469_4, 0.006_000_698_7, 0.020_017_914, 103.560_65];

/// The vacuum and media of various indices, with three priorities.
static MEDIA: LazyLock<Vec<Medium>> = LazyLock::new(|| {
    let medium = |index: u32| Medium {
        absorption: [0.3 * index as f32, 0.1, 0.0],
        ior: 1.0 + 0.17 * index as f32,
        priority: index % 3,
        dispersion: index % 3,
        terms: if index % 3 == 2 { BK7 } else { [1.5, 0.01 * index as f32, 0.0, 0.0, 0.0, 0.0] },
        scattering: [0.25 * index as f32, 0.0, 0.3],
        ..Medium::VACUUM
    };
    [Medium::VACUUM].into_iter().chain((1..8).map(medium)).collect()
});

/// The functions, their twins and their bounds, for scenes with nested media; the last one for others.
pub(super) fn rows() -> Vec<Row> {
    let row =
        |name, function, bound, twin| Row { name, module: &shaders::PROBE_MEDIA, function, bound, draw: stacks, twin };
    vec![
        row("media_enter, media_leave", 0, Bound::Words, |i| {
            let (stack, medium) = (stack(i), i.0[2]);
            let [enter, leave] = [stack.enter(medium), stack.leave(medium)].map(MediumStack::bits);
            words([enter, leave, stack.contains(medium).into(), stack.is_full().into()])
        }),
        row("media_current", 1, Bound::Words, |i| words([stack(i).current(&MEDIA)])),
        row("media_interface", 2, Bound::Words, |i| sides(i, true)),
        row("media_interface, index", 3, Bound::Relative(4e-7), |i| output([boundary(i, true).eta])),
        // The square of a quotient.
        row("radiance_scale", 4, Bound::Relative(8e-7), |i| {
            output([radiance_scale(&MEDIA, stack(i), MediumStack::from_bits(i.0[1]), wavelength(i))])
        }),
        // A square root, and quotients that count for less.
        row("media_index", 6, Bound::Relative(4e-7), |i| {
            let medium = MEDIA[stack(i).current(&MEDIA) as usize];
            output([medium.index(wavelength(i)), u8::from(boundary(i, true).is_dispersive(&MEDIA)).into()])
        }),
        row("media_disperse", 7, Bound::Relative(1e-6), |i| dispersed(i, i.0[8])),
        row("transmittance", 5, Bound::Bits, |i| {
            let medium = MEDIA[stack(i).current(&MEDIA) as usize];
            output(flight::transmittance(&medium, i.float(3)).to_array())
        }),
        row("media_interface, separate", 2, Bound::Words, |i| sides(i, false)),
    ]
}

/// Media that a kernel is compiled for: the last row is for separate ones.
fn features(row: &Row) -> MediaFeatures {
    if row.name.ends_with("separate") { MediaFeatures::NONE } else { HOMOGENEOUS }
}

/// Two stacks of up to four media, a medium, a distance, and a material.
fn stacks(d: &mut Draw) -> Input {
    let count = MEDIA.len() as u32;
    let mut stack = || (0..d.word() % 5).fold(0, |stack, _| stack << 8 | (1 + d.word() % (count - 1)));
    let (here, there) = (stack(), stack());
    let distance = if d.now_and_then() { d.pick(&[0.0, 1e-30, 1e4]) } else { d.magnitude(-20, 6) };
    let medium = d.word() % count;
    let mut input = Input::default();
    let kind = d.pick(&[MaterialKind::Lambert, MaterialKind::Mirror, MaterialKind::Dielectric, MaterialKind::Thin]);
    let there = if d.now_and_then() { here } else { there };
    input.0[..4].copy_from_slice(&[here, there, medium, distance.to_bits()]);
    let solid = d.word() % count;
    input.0[4..8].copy_from_slice(&[kind as u32, solid, MEDIA[solid as usize].ior.to_bits(), d.word() % 2]);
    let cell = 1 + d.word() % Spectrum::CELLS;
    input.0[8..10].copy_from_slice(&[d.word(), if d.now_and_then() { 0 } else { cell }]);
    input
}

fn wavelength(i: &Input) -> Wavelength {
    i.0[9].checked_sub(1).map_or(Wavelength::NONE, Wavelength::of_cell)
}

/// The wavelength that is drawn by a word, the power that is left, and the index of the interface.
fn dispersed(i: &Input, word: u32) -> Output {
    let mut power = Vec3::new(i.float(3), i.float(6), 0.25);
    let drawn = Spectrum::get().draw(&mut power, unit_f32(word));
    let eta = boundary(i, true).at_wavelength(&MEDIA, drawn).eta;
    output([drawn.bits() as f32, power.x, power.y, power.z, eta])
}

fn stack(i: &Input) -> MediumStack {
    MediumStack::from_bits(i.0[0])
}

fn boundary(i: &Input, nested: bool) -> photon_core::Interface {
    let material = Material { kind: i.0[4], medium: i.0[5], ior: i.float(6), ..Material::default() };
    interface(&MEDIA, &material, i.0[7] != 0, stack(i), nested)
}

fn sides(i: &Input, nested: bool) -> Output {
    let at = boundary(i, nested);
    words([at.before.bits(), at.transmitted.bits(), at.is_active.into(), at.is_too_deep.into()])
}

#[test]
fn media_are_entered_and_left_as_in_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let media = on.memory("media", (MEDIA.len() * size_of::<Medium>()) as u64).unwrap();
    on.write(&media, 0, bytemuck::cast_slice(&MEDIA)).unwrap();
    let cells = Spectrum::get().cells();
    let spectrum = on.memory("spectrum", size_of_val::<[SpectrumCell]>(cells) as u64).unwrap();
    on.write(&spectrum, 0, bytemuck::cast_slice(cells)).unwrap();
    // The functions read only two addresses of a scene.
    let scene = on.memory("scene", 128).unwrap();
    on.fill_words(&scene, 0, 128, 0).unwrap();
    on.write(&scene, 56, bytemuck::bytes_of(&media.address())).unwrap();
    on.write(&scene, 96, bytemuck::bytes_of(&spectrum.address())).unwrap();
    let address = [scene.address() as u32, (scene.address() >> 32) as u32];
    for mut row in rows() {
        let constants = MediaConstants { function: row.function, media: features(&row) };
        let (inputs, outputs) = run_with(&mut on, &row, &constants, &address);
        worst_of(&mut on, &row, &inputs, &outputs).unwrap();
        // The last entered medium instead of the one with the highest priority, and others: all are detected.
        row.twin = match (row.function, features(&row)) {
            (0, _) => |i| words([stack(i).enter(i.0[2]).bits(), stack(i).bits()]),
            (1, _) => |i| words([i.0[0] & 0xFF]),
            (2, HOMOGENEOUS) => |i| sides(i, false),
            (2, _) => |i| sides(i, true),
            (3, _) => |i| output([boundary(i, false).eta]),
            (4, _) => |i| output([radiance_scale(&MEDIA, MediumStack::from_bits(i.0[1]), stack(i), wavelength(i))]),
            (6, _) => |i| output([MEDIA[stack(i).current(&MEDIA) as usize].ior, 0.0]),
            (7, _) => |i| dispersed(i, i.0[8].rotate_left(1)),
            _ => |i| output(MEDIA[(i.0[0] & 0xFF) as usize].absorption.map(|sigma| math::exp_neg(sigma * i.float(3)))),
        };
        assert!(worst_of(&mut on, &row, &inputs, &outputs).is_err(), "{}", row.name);
    }
}

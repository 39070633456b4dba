//! Rainbows: light that is reflected once inside of a ball of water.

use std::collections::BTreeSet;

use photon_core::fresnel::fresnel;
use photon_core::glam::Vec3;
use photon_core::{MapKind, Photon, PhotonRay, Settings, Spectrum, Wavelength, octahedral, offset};
use photon_scene::{Dispersion, MaterialDesc, Scene, builtin};

use crate::extremes::scenes::{follow, ray};
use crate::harness::TestBackend;
use crate::stats::{agrees, assert_agrees};

const RAYS: u32 = 100_000;
/// Radius of the ball of the built-in scene, on which the sun shines along −z.
const BALL: f64 = 0.1;
/// Degrees of the bow, in steps.
const BOW: [f64; 2] = [40.0, 42.6];
const BINS: usize = 13;
/// 1.3311 at 0.7 µm, 1.3428 at 0.4 µm.
const WATER: Dispersion = Dispersion::Cauchy([1.325_427, 0.002_779_7]);

fn scene(water: Dispersion) -> Scene {
    let mut builder = builtin("rainbow").unwrap();
    let material = builder.materials_mut().iter_mut().find(|material| material.name == "water").unwrap();
    *material = MaterialDesc::glass("water", 1.333).with_dispersion(water);
    builder.build().unwrap()
}

/// Angles in degrees from the antisolar direction, and powers, of the light that the ball reflects once inside: what arrives after
/// four surfaces, the screen among them, and not after three. Rays are even over the ball.
fn reflected<T: TestBackend>(scene: &Scene) -> Vec<(f64, Vec3)> {
    let photons = |max_bounces: u32| -> Vec<Photon> {
        let even = |i: u32| {
            let (radius, turn) = (BALL * ((f64::from(i) + 0.5) / f64::from(RAYS)).sqrt(), 2.399_963_23 * f64::from(i));
            let start = scene.units().point([radius * turn.cos(), radius * turn.sin(), 0.9]);
            ray(start.into(), Vec3::NEG_Z)
        };
        let mut rays: Vec<PhotonRay> = (0..RAYS).map(even).collect();
        let (photons, tally) = follow::<T>(scene, &Settings { max_bounces, ..Settings::default() }, &mut rays);
        assert!(tally.balances());
        photons[MapKind::Caustic].clone()
    };
    let key = |photon: &Photon| photon.position.map(f32::to_bits);
    let before: BTreeSet<_> = photons(3).iter().map(key).collect();
    let own = photons(4).into_iter().filter(|photon| !before.contains(&key(photon)));
    own.map(|photon| {
        let back = -octahedral::unpack(photon.direction);
        (f64::from(back.z).clamp(-1.0, 1.0).acos().to_degrees(), Vec3::from(photon.power))
    })
    .collect()
}

/// Angle in degrees and share of the light that enters at the squared sine of incidence `u`.
fn exact(index: f64, u: f64) -> (f64, f64) {
    let (incidence, inside) = (u.sqrt().asin(), (u.sqrt() / index).asin());
    let reflected = f64::from(fresnel(incidence.cos() as f32, index as f32).reflectance);
    ((4.0 * inside - 2.0 * incidence).to_degrees(), reflected * (1.0 - reflected).powi(2))
}

/// Mean power of each channel in each step of the bow, per ray.
fn expected(water: Dispersion) -> [[f64; 3]; BINS] {
    const STEPS: u32 = 4000;
    let mut bins = [[0.0; 3]; BINS];
    for (cell, of) in (0..Spectrum::CELLS).zip(Spectrum::get().cells()) {
        let index = water.index(1.333, f64::from(Wavelength::of_cell(cell).micrometres()));
        for step in 0..STEPS {
            let (angle, share) = exact(index, (f64::from(step) + 0.5) / f64::from(STEPS));
            if let Some(bin) = bin(angle) {
                (0..3).for_each(|c| bins[bin][c] += share * f64::from(of.share[c]) / f64::from(STEPS));
            }
        }
    }
    bins
}

fn bin(angle: f64) -> Option<usize> {
    let place = (angle - BOW[0]) / (BOW[1] - BOW[0]) * BINS as f64;
    (0.0..BINS as f64).contains(&place).then_some(place as usize)
}

/// Whether each channel has the power in each step of the bow that it should have, within 4.5 standard errors.
fn is_bow(light: &[(f64, Vec3)], expected: &[[f64; 3]; BINS]) -> Result<(), String> {
    for (number, channels) in expected.iter().enumerate() {
        for (channel, &expected) in channels.iter().enumerate() {
            let there = light.iter().filter(|(angle, _)| bin(*angle) == Some(number));
            let powers = there.map(|(_, power)| f64::from(power[channel]) / f64::from(RAYS));
            let (sum, square) = powers.fold((0.0, 0.0), |(sum, square), power| (sum + power, square + power * power));
            // Few photons are not distributed normally; each has a power of 3 at most.
            let few = 12.0 / f64::from(RAYS);
            if !agrees(sum, expected, square.sqrt(), few) {
                return Err(format!("{sum} instead of {expected} of channel {channel} in step {number}"));
            }
        }
    }
    Ok(())
}

/// P21: the share of the light that comes back at 41° to the rim of the bow, which nothing exceeds; and, with the indices of water,
/// the colours by angle: red outside, violet inside.
pub fn p21_rainbow<T: TestBackend>() {
    let rim = |index: f64| {
        let incidence = ((index * index - 1.0) / 3.0).sqrt().acos();
        exact(index, incidence.sin().powi(2)).0
    };
    for (index, degrees) in [(4.0 / 3.0, 42.0297), (1.333, 42.0781), (1.3311, 42.3552), (1.3428, 40.6741)] {
        assert!((rim(index) - degrees).abs() < 1e-4, "{index}: {}", rim(index));
    }
    let plain = reflected::<T>(&scene(Dispersion::Cauchy([1.333, 0.0])));
    let beyond = |degrees: f64| plain.iter().filter(|(angle, _)| *angle > degrees).count() as f64 / f64::from(RAYS);
    let share = 0.010_909_7;
    assert_agrees("41° to the rim", beyond(41.0), share, (share / f64::from(RAYS)).sqrt(), 0.0);
    // Chords of the mesh and the steps of directions, and of points, which are moved off the ball twice inside of it.
    let moved = 2.0 * f64::from(offset::STEP) * scene(WATER).units().scale / BALL;
    assert_eq!(beyond(42.0781 + 0.02 + moved.to_degrees()), 0.0);

    // The index of water is that of the scene.
    assert_eq!(scene(WATER).view().media, builtin("rainbow").unwrap().build().unwrap().view().media);
    let (light, expected) = (reflected::<T>(&scene(WATER)), expected(WATER));
    is_bow(&light, &expected).unwrap();
    // Outermost angle of light that is mostly of one channel: in order, and at the rims for red and violet light.
    let outermost = |channel: usize| {
        let own = light.iter().filter(|(_, power)| power[channel] > 1.8);
        own.map(|(angle, _)| *angle).fold(0.0, f64::max)
    };
    let [red, green, blue] = [0, 1, 2].map(outermost);
    assert!(red > green + 0.3 && green > blue + 0.3, "{red} {green} {blue}");
    assert!((42.2..42.5).contains(&red) && (40.674..42.0).contains(&blue), "{red} {blue}");
    // The comparison fails without dispersion, and for the colours of a secondary bow.
    assert!(is_bow(&plain, &expected).is_err());
    let inverse: Vec<_> = light.iter().map(|&(angle, power)| (angle, Vec3::new(power.z, power.y, power.x))).collect();
    assert!(is_bow(&inverse, &expected).is_err());
}

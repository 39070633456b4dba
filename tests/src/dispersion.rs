//! Dispersion: refraction by wavelength, and the colours that it leaves.

use photon_core::fresnel::fresnel;
use photon_core::glam::{DVec2, Vec3};
use photon_core::{
    Direct, Indirect, MapKind, MediaFeatures, Medium, Photon, PhotonRay, Render as _, Requirements, Settings, Spectrum,
    Tally, TransportBackend, Wavelength, octahedral,
};
use photon_scene::{CameraDesc, Dispersion, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Surface, shapes};

use crate::extremes::scenes::{follow, ray};
use crate::harness::{TestBackend, renderer};
use crate::nesting::glow;
use crate::stats::{agrees, assert_agrees, moments, standard_error};

/// Angle of incidence on the first face of the prism.
const INCIDENCE: f64 = 56.41415;
/// The wall, along x.
const WALL: f64 = 4.0;
const HEAVY: Dispersion = Dispersion::Cauchy([1.6, 0.02]);

fn cells() -> impl Iterator<Item = (f64, [f64; 3])> {
    let cells = (0..Spectrum::CELLS).zip(Spectrum::get().cells());
    cells.map(|(cell, of)| (f64::from(Wavelength::of_cell(cell).micrometres()), of.share.map(f64::from)))
}

/// An equilateral prism of side 1 and height 2 along z, whose base lies on y = 0, and a wall on its right.
fn prism(dispersion: Dispersion) -> Scene {
    let mut builder = SceneBuilder::new();
    let glass = builder.material(MaterialDesc::glass("prism", 1.5).with_dispersion(dispersion));
    let [a, b, c] = [[0.0, 0.75_f64.sqrt()], [-0.5, 0.0], [0.5, 0.0]];
    let at = |z: f64| [a, b, c].map(|[x, y]| [x, y, z]);
    let positions = [at(1.0), at(-1.0)].concat();
    let triangles = vec![[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]];
    builder.mesh("prism", positions, triangles, glass);
    builder.light("light", LightDesc::Point { position: [-1.0, 0.5, 0.0], intensity: [1.0; 3] });
    let white = builder.material(MaterialDesc::lambert("wall", [0.5; 3]));
    let wall = [[WALL, -3.0, 1.0], [WALL, -0.5, 1.0], [WALL, -0.5, -1.0], [WALL, -3.0, -1.0]];
    builder.quad("wall", wall, white);
    let scene = builder.build().unwrap();
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    scene
}

/// The deviation in degrees of light by the prism at this index, where it meets the wall, and the share that does.
fn refracted(index: f64) -> (f64, f64, f64) {
    let (incidence, face) = (INCIDENCE.to_radians(), 60_f64.to_radians());
    let inside = (incidence.sin() / index).asin();
    let at_second = face - inside;
    let leaving = (index * at_second.sin()).asin();
    // Along the chord to the face through (1/2, 0), whose normal has an angle of 30°.
    let (start, normal) = (DVec2::new(-0.25, 0.75_f64.sqrt() / 2.0), DVec2::from_angle(30_f64.to_radians()));
    let along = DVec2::from_angle(inside - 30_f64.to_radians());
    let exit = start + along * ((DVec2::new(0.5, 0.0) - start).dot(normal) / along.dot(normal));
    let end = exit.y + (WALL - exit.x) * (30_f64.to_radians() - leaving).tan();
    let passes = |cosine: f64, eta: f64| 1.0 - f64::from(fresnel(cosine as f32, eta as f32).reflectance);
    let share = passes(incidence.cos(), index) * passes(at_second.cos(), 1.0 / index);
    ((incidence + leaving - face).to_degrees(), end, share)
}

fn through<T: TestBackend>(scene: &Scene) -> (Vec<Photon>, Tally) {
    let direction = DVec2::from_angle((INCIDENCE - 30.0).to_radians());
    let towards = Vec3::new(direction.x as f32, direction.y as f32, 0.0);
    let start = DVec2::new(-0.25, 0.75_f64.sqrt() / 2.0) - direction;
    let mut rays: Vec<PhotonRay> =
        (0..50_000).map(|_| ray(scene.units().point([start.x, start.y, 0.1]).into(), towards)).collect();
    // Both faces and the wall: what is reflected inside and gets there later is cut off.
    let settings = Settings { max_bounces: 3, ..Settings::default() };
    let (photons, tally) = follow::<T>(scene, &settings, &mut rays);
    (photons[MapKind::Caustic].clone(), tally)
}

/// Whether photons on the wall are where light of their colour arrives, and as many as there should be in each sixteenth of
/// the spectrum: binomial. Returns their cells.
fn is_spectrum(scene: &Scene, photons: &[Photon], dispersion: Dispersion) -> Result<Vec<usize>, String> {
    let expected: Vec<(f64, f64, f64, [f64; 3])> = cells()
        .map(|(length, share)| {
            let (deviation, end, passes) = refracted(dispersion.index(1.0, length));
            (deviation, end, passes, share)
        })
        .collect();
    let mut found = Vec::new();
    for photon in photons {
        let height = scene.units().point_to_user(photon.position)[1];
        let gap = |cell: usize| (expected[cell].1 - height).abs();
        let cell = (0..expected.len()).min_by(|&a, &b| gap(a).total_cmp(&gap(b))).unwrap_or(0);
        let next = if cell == 0 { 1 } else { cell - 1 };
        if gap(cell) > 0.05 * (expected[cell].1 - expected[next].1).abs() {
            return Err(format!("a photon at {height} is {} beside its colour", gap(cell)));
        }
        let share = expected[cell].3;
        for (channel, power) in photon.power.into_iter().enumerate() {
            let whole = 3.0 * share[channel] / share.iter().sum::<f64>();
            if (f64::from(power) - whole).abs() > 1e-5 {
                return Err(format!("power {:?} where the colour is {share:?}", photon.power));
            }
        }
        found.push(cell);
    }
    let weight = |cell: usize| expected[cell].2 * expected[cell].3.iter().sum::<f64>();
    let total: f64 = (0..expected.len()).map(weight).sum();
    for part in 0..16 {
        let share = (16 * part..16 * part + 16).map(weight).sum::<f64>() / total;
        let count = found.iter().filter(|&&cell| cell / 16 == part).count() as f64 / found.len() as f64;
        let error = (share * (1.0 - share) / found.len() as f64).sqrt();
        // A few photons are not distributed normally.
        let rare = if share * (found.len() as f64) < 20.0 { 20.0 / found.len() as f64 } else { 0.0 };
        if !agrees(count, share, error, rare) {
            return Err(format!("{count} instead of {share} in part {part} of the spectrum"));
        }
    }
    Ok(found)
}

/// P22: light in a prism is deviated by its wavelength, in the order of its colours. Deviations are those of the closed
/// form at nine wavelengths; directions are stored in steps of 2⁻¹⁵, which is 0.0035°.
pub fn p22_prism<T: TestBackend>() {
    let scene = prism(HEAVY);
    let (photons, tally) = through::<T>(&scene);
    let found = is_spectrum(&scene, &photons, HEAVY).unwrap();
    let deviation = |photon: &Photon| {
        let from = octahedral::unpack(photon.direction);
        INCIDENCE - 30.0 - f64::from(-from.y).atan2(f64::from(-from.x)).to_degrees()
    };
    for (nanometres, expected) in [
        (400.0, 59.4905),
        (440.0, 56.8860),
        (480.0, 55.0312),
        (520.0, 53.6495),
        (550.0, 52.8283),
        (580.0, 52.1439),
        (620.0, 51.3941),
        (660.0, 50.7860),
        (700.0, 50.2853),
    ] {
        assert!((refracted(HEAVY.index(1.0, nanometres * 1e-3)).0 - expected).abs() < 1e-4, "{nanometres}");
        // Between the two photons that are next.
        let length = |cell: usize| 1e3 * f64::from(Wavelength::of_cell(cell as u32).micrometres());
        let by = |side: f64| {
            let on_side = (0..photons.len()).filter(|&i| side * (length(found[i]) - nanometres) >= 0.0);
            on_side.min_by(|&a, &b| (side * length(found[a])).total_cmp(&(side * length(found[b])))).unwrap()
        };
        let [below, above] = [by(-1.0), by(1.0)];
        let part = (nanometres - length(found[below])) / (length(found[above]) - length(found[below])).max(1e-9);
        let seen = (1.0 - part) * deviation(&photons[below]) + part * deviation(&photons[above]);
        assert!((seen - expected).abs() < 0.005, "{nanometres} nm: {seen}° instead of {expected}°");
    }
    let mean = |channel: usize| {
        let (sum, power) = photons.iter().fold((0.0, 0.0), |(sum, power), photon| {
            let share = f64::from(photon.power[channel]);
            (sum + share * deviation(photon), power + share)
        });
        sum / power
    };
    assert!(mean(0) < mean(1) && mean(1) < mean(2), "red, green, blue");
    // Nothing absorbs; the channels of each path are exchanged, their sum is not, to the last bits of f32.
    assert!(tally.balances());
    let [emitted, ended] = [tally.flux_emitted, tally.flux_absorbed].map(|flux| flux.value().iter().sum::<f64>());
    let others = [tally.flux_escaped, tally.flux_truncated].map(|flux| flux.value().iter().sum::<f64>());
    let landed = 3.0 * photons.len() as f64;
    assert!((emitted - ended - others[0] - others[1]).abs() < 1e-9 && ended <= landed);
    // The comparison fails for another prism, one without dispersion, and other colours.
    let other = prism(Dispersion::Cauchy([1.6, 0.0201]));
    assert!(is_spectrum(&other, &through::<T>(&other).0, HEAVY).is_err());
    let plain = prism(Dispersion::Cauchy([HEAVY.index(1.0, 0.55), 0.0]));
    assert_eq!(Requirements::of(&plain.view(), &Settings::default()).media, MediaFeatures::NONE);
    assert!(is_spectrum(&plain, &through::<T>(&plain).0, HEAVY).is_err());
    let turned = photons.iter().map(|photon| {
        let [red, green, blue] = photon.power;
        Photon { power: [blue, green, red], ..*photon }
    });
    assert!(is_spectrum(&scene, &turned.collect::<Vec<_>>(), HEAVY).is_err());
    assert!(is_spectrum(&scene, &photons[..photons.len() / 2], HEAVY).is_ok());
    let blue: Vec<Photon> = photons.iter().filter(|photon| photon.power[2] > 1.0).copied().collect();
    assert!(is_spectrum(&scene, &blue, HEAVY).is_err());
}

/// P24: white light straight through a slab: of each channel what its wavelengths let pass, all orders of reflection. With
/// a dispersion of 10⁻⁶ that is as without any.
pub fn p24_slab<T: TestBackend>() {
    for (name, dispersion) in
        [("heavy", HEAVY), ("weak", Dispersion::Abbe(2e7)), ("none", Dispersion::Cauchy([1.5, 0.0]))]
    {
        let mut builder = SceneBuilder::new();
        let glass = builder.material(MaterialDesc::glass("slab", 1.5).with_dispersion(dispersion));
        let (positions, triangles) = shapes::cuboid([-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]);
        builder.mesh("slab", positions, triangles, glass);
        builder.light("light", LightDesc::Point { position: [0.0, 2.0, 0.0], intensity: [1.0; 3] });
        let white = builder.material(MaterialDesc::lambert("floor", [0.5; 3]));
        builder.quad("floor", [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, -1.0]], white);
        let scene = builder.build().unwrap();
        let count = 40_000;
        let from = scene.units().point([0.1, 2.0, 0.1]);
        let mut rays: Vec<PhotonRay> = (0..count).map(|_| ray(from.into(), Vec3::NEG_Y)).collect();
        let (photons, tally) = follow::<T>(&scene, &Settings { max_bounces: 64, ..Settings::default() }, &mut rays);
        assert!(tally.balances());
        // Light that the floor reflects is stored elsewhere.
        let photons = &photons[MapKind::Caustic];
        let passes = |index: f64| {
            let r = ((index - 1.0) / (index + 1.0)).powi(2);
            (1.0 - r) / (1.0 + r)
        };
        for channel in 0..3 {
            let truth: f64 =
                cells().map(|(length, share)| share[channel] * passes(dispersion.index(1.5, length))).sum();
            let mut values: Vec<f64> = photons.iter().map(|photon| f64::from(photon.power[channel])).collect();
            values.resize(count, 0.0);
            let (mean, error) = (moments(&values).0, standard_error(&values));
            assert_agrees(&format!("{name}, channel {channel}"), mean, truth, error, 1e-6);
            // An error of 5 % would exceed the noise.
            assert!(0.05 * truth > 4.5 * error, "{name}, channel {channel}: {error}");
        }
    }
}

/// An even glow of radiance 1, seen through smooth and rough glass that disperses: 1 in each channel on average, and in
/// their sum for every path; within such glass the square of its refractive index.
pub fn even_light_stays_white<T: TestBackend>() {
    for (name, roughness, camera) in [("smooth", 0.0, 1.6), ("rough", 0.6, 1.6), ("inside", 0.0, 0.1)] {
        let mut builder = SceneBuilder::new();
        let shell = builder.material(MaterialDesc::emissive("glow", [0.0; 3], [1.0; 3]));
        let (positions, triangles) = shapes::flip(shapes::icosphere(3, [0.0; 3], 2.0));
        builder.mesh("shell", positions, triangles, shell);
        let glass = Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [1.0; 3], roughness };
        let glass = builder.material(MaterialDesc::new("glass", glass).with_dispersion(HEAVY));
        let (positions, triangles) = shapes::cuboid([-0.5; 3], [0.55; 3]);
        builder.mesh("block", positions, triangles, glass);
        let projection = Projection::Orthographic { half_height: 0.3 };
        builder.camera("down", CameraDesc::new([0.0, camera, 0.0], [0.2, -1.0, 0.1], [0.0, 0.0, 1.0], projection));
        let scene = builder.build().unwrap();
        let mut renderer = renderer::<T>(&scene, &glow(), 8);
        let mut sums = [[0.0; 3]; 64];
        let mut values: [Vec<f64>; 3] = Default::default();
        for pass in 0..32 {
            renderer.pass(pass, &mut ()).unwrap();
            let film = renderer.film().unwrap().beauty();
            for (pixel, sum) in film.iter().zip(&mut sums) {
                // Pixels of a pass are independent; passes of a pixel are stratified.
                for c in 0..3 {
                    let all = f64::from(pixel[c]) * f64::from(pass + 1);
                    values[c].push(all - sum[c]);
                    sum[c] = all;
                }
            }
        }
        for channel in 0..3 {
            let square = |index: f64| if name == "inside" { index * index } else { 1.0 };
            let truth: f64 = cells().map(|(length, share)| share[channel] * square(HEAVY.index(1.0, length))).sum();
            let (mean, error) = (moments(&values[channel]).0, standard_error(&values[channel]));
            // Tables of rough glass are of a few wavelengths only.
            let bound = if roughness > 0.0 { 2e-3 } else { 1e-5 };
            assert_agrees(&format!("{name}, channel {channel}"), mean, truth, error, bound);
            assert!(error > 1e-3 && error < 0.1, "{name}: {error}");
        }
        if name == "smooth" {
            for pixel in 0..values[0].len() {
                let sum: f64 = values.iter().map(|channel| channel[pixel]).sum();
                assert!((sum - 3.0).abs() < 1e-4, "{sum}");
            }
        }
    }
}

/// Scenes that disperse light are refused without the feature, and with invalid coefficients.
pub fn dispersion_is_required_where_it_is<T: TestBackend>() {
    let scene = prism(HEAVY);
    let mut required = Requirements::of(&scene.view(), &Settings::default());
    assert_eq!(required.media, MediaFeatures::DISPERSION | MediaFeatures::NESTED);
    required.media = MediaFeatures::NESTED;
    assert!(T::make(1).prepare(&scene.view(), &required).is_err());
    // Coefficients are checked at the door, too.
    let mut media = scene.view().media.to_vec();
    media[1].terms[1] = f32::NAN;
    assert!(T::make(1).prepare(&photon_core::SceneView { media: &media, ..scene.view() }, &required).is_err());
    // An unknown formula, and that of a boundary around a solid.
    for dispersion in [Medium::MATCHED, Medium::MATCHED + 1] {
        media[1] = Medium { dispersion, ..scene.view().media[1] };
        assert!(photon_core::SceneView { media: &media, ..scene.view() }.validate().is_err());
    }
}

/// Final gathering reads light behind dispersive glass: a floor within an even room, whose walls have an albedo of 1/2 and
/// emit 1, has the radiance 2 of all surfaces, with a block of glass between.
pub fn gathered_light_stays_white<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let shell = builder.material(MaterialDesc::emissive("glow", [0.5; 3], [1.0; 3]));
    let (positions, triangles) = shapes::flip(shapes::icosphere(2, [0.0; 3], 1.0));
    builder.mesh("shell", positions, triangles, shell);
    let glass = builder.material(MaterialDesc::glass("glass", 1.5).with_dispersion(HEAVY));
    let (positions, triangles) = shapes::cuboid([-0.4; 3], [0.45; 3]);
    builder.mesh("block", positions, triangles, glass);
    let projection = Projection::Orthographic { half_height: 0.1 };
    builder.camera("down", CameraDesc::new([0.0, -0.5, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], projection));
    let scene = builder.build().unwrap();
    let settings = Settings {
        photons: 4_000,
        direct: Direct::Photons,
        indirect: Indirect::Gather,
        max_bounces: 256,
        ..Settings::default()
    };
    let mut renderer = renderer::<T>(&scene, &settings, 8);
    let mut before = [0.0; 3];
    let mut values: [Vec<f64>; 3] = Default::default();
    for pass in 0..12 {
        renderer.pass(pass, &mut ()).unwrap();
        let film = renderer.film().unwrap().beauty();
        for c in 0..3 {
            let sum: f64 = film.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() * f64::from(pass + 1) / 64.0;
            values[c].push(sum - before[c]);
            before[c] = sum;
        }
    }
    let [red, green, blue] = values.each_ref().map(|values| moments(values).0);
    // The channels agree with each other: by how much they differ in each pass.
    for (name, other) in [("green", &values[1]), ("blue", &values[2])] {
        let apart: Vec<f64> = other.iter().zip(&values[0]).map(|(a, b)| a - b).collect();
        assert_agrees(name, moments(&apart).0, 0.0, standard_error(&apart), 0.0);
    }
    let mean = (red + green + blue) / 3.0;
    assert!((mean / 2.0 - 1.0).abs() < 0.05, "{mean}");
}

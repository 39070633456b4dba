//! Media that scatter light: closed forms of single and multiple scattering, furnaces, and conservation.

use std::f64::consts::{FRAC_1_PI, PI};

use photon_core::phase::{Mie, Phase};
use photon_core::{
    Direct, Error, Film, Indirect, Layer, Medium, PassEnd, Pipeline, Render as _, SceneView, Settings, View,
};
use photon_scene::{
    AmbientMedium, CameraDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Surface, shapes,
};

use crate::harness::{TestBackend, direct_settings, keep, opened};
use crate::stats::{assert_agrees, moments, standard_error};

/// Coefficients per user length.
#[derive(Clone, Copy)]
pub(crate) struct Fog {
    scattering: [f64; 3],
    absorption: [f64; 3],
    phase: Phase,
}

impl Fog {
    /// Grey, of this extinction and albedo.
    pub(crate) fn new(extinction: f64, albedo: f64, anisotropy: f64) -> Self {
        let phase = Phase::HenyeyGreenstein(anisotropy as f32);
        Self { scattering: [extinction * albedo; 3], absorption: [extinction * (1.0 - albedo); 3], phase }
    }

    /// The table of media of a scene, with this one as entry `index`.
    pub(crate) fn at(self, scene: &Scene, index: usize) -> Vec<Medium> {
        let mut media = scene.view().media.to_vec();
        let length = scene.units().length_to_user(1.0);
        let normalised = |coefficients: [f64; 3]| coefficients.map(|c| (c * length) as f32);
        let (scattering, absorption) = (normalised(self.scattering), normalised(self.absorption));
        media[index] = Medium { scattering, absorption, ..media[index] }.with_phase(self.phase);
        media
    }
}

pub(crate) fn renderer<T: TestBackend>(
    scene: &Scene,
    media: &[Medium],
    settings: &Settings,
    size: u32,
) -> Pipeline<T::On> {
    let view = View { camera: scene.camera(None, size, size).unwrap(), width: size, height: size };
    let mut settings = settings.clone();
    settings.photons = settings.photons.div_ceil(T::ONE_OF);
    Pipeline::new(opened::<T>(), &SceneView { media, ..scene.view() }, view, settings).unwrap()
}

/// All cases; of a backend that traces fewer photons, and whose pictures are compared with those of the other, the last alone.
pub(crate) fn cases<T: TestBackend, C>(all: &[C]) -> &[C] {
    let first = if T::ONE_OF == 1 { 0 } else { all.len() - 1 };
    &all[first..]
}

/// Mean of the layers over the pixels, of one channel, in user units, of the passes in a film.
pub(crate) fn mean(film: &Film, layers: &[Layer], channel: usize) -> f64 {
    let of_pixel = |layer: &Layer| film.pixels.iter().map(|p| p.layers[*layer as usize][channel]).sum::<f64>();
    let sum: f64 = layers.iter().map(of_pixel).sum();
    sum / film.pixels.len() as f64 * film.units.radiance_to_user()
}

/// Of each pass, the mean over pixels for each channel.
pub(crate) fn per_pass<T: TestBackend>(
    scene: &Scene,
    media: &[Medium],
    settings: &Settings,
    (passes, size): (u32, u32),
    layers: &[Layer],
) -> [Vec<f64>; 3] {
    let mut renderer = renderer::<T>(scene, media, settings, size);
    let mut before = [0.0; 3];
    let mut found = [const { Vec::new() }; 3];
    for pass in 0..passes {
        renderer.pass(pass, &mut ()).unwrap();
        let film = renderer.film().unwrap();
        for channel in 0..3 {
            let sum = mean(&film, layers, channel);
            found[channel].push(sum - std::mem::replace(&mut before[channel], sum));
        }
    }
    keep::<T>(renderer.into_backend().unwrap());
    found
}

/// The mean over the passes is `truth`, within 4.5 standard errors of the mean and a relative bound for what does not vary.
pub(crate) fn assert_mean(what: &str, values: &[f64], truth: f64, relative: f64) {
    let (mean, _) = moments(values);
    let error = standard_error(values);
    assert!(error < 0.05 * truth, "{what}: too noisy, {mean} ± {error}");
    assert_agrees(what, mean, truth, error, relative * truth);
}

pub(crate) fn camera(builder: &mut SceneBuilder, position: [f64; 3], direction: [f64; 3], half_height: f64) {
    let up = if direction[1].abs() > 0.9 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
    let projection = Projection::Orthographic { half_height };
    builder.camera("ray", CameraDesc::new(position, direction, up, projection));
}

/// A point light of 100 W one metre beside a view that ends at a black wall.
fn airlight(length: f64) -> Scene {
    let mut builder = SceneBuilder::new();
    let black = builder.material(MaterialDesc::lambert("wall", [0.0; 3]));
    let x = length;
    builder.quad("wall", [[x, -0.3, 0.3], [x, 0.3, 0.3], [x, 0.3, -0.3], [x, -0.3, -0.3]], black);
    let intensity = [100.0 / (4.0 * PI); 3];
    builder.light("light", LightDesc::Point { position: [5.0, 1.0, 0.0], intensity });
    camera(&mut builder, [0.0; 3], [1.0, 0.0, 0.0], 1e-3);
    builder.build().unwrap()
}

/// P2: light of a point that is scattered once along a view: ∫ σ_s f Φ e^(−σ(t+d))/(4πd²) dt.
pub fn p2_airlight<T: TestBackend>() {
    let settings = Settings { shadow_rays: 8, ..direct_settings(Direct::Nee, 0.1) };
    let (hg, mie) = (Phase::HenyeyGreenstein, |micrometres: f64| Phase::Mie(Mie::droplets(micrometres)));
    for &(length, phase, expected) in cases::<T, _>(&[
        (10.0, hg(0.0), 0.045_260_6),
        (10.0, hg(0.5), 0.059_260_0),
        (10.0, hg(0.9), 0.045_498_5),
        (10.0, hg(-0.5), 0.044_625_4),
        (5.0, hg(0.0), 0.025_103_2),
        (10.0, Phase::Rayleigh, 0.047_908_3),
        (5.0, Phase::Rayleigh, 0.027_074_0),
        (10.0, mie(5.0), 0.040_029_2),
        (5.0, hg(0.9), 0.044_611_5),
        (5.0, mie(10.0), 0.036_645_6),
    ]) {
        let scene = airlight(length);
        let media = Fog { phase, ..Fog::new(0.1, 0.5, 0.0) }.at(&scene, 0);
        let [found, ..] = per_pass::<T>(&scene, &media, &settings, (24, 8), &Layer::ALL);
        assert_mean(&format!("airlight, {length} m, {phase:?}"), &found, expected, 2e-5);
    }
}

/// The comparison sees a phase function of the other sign.
pub fn p2_sees_the_direction_of_scattering<T: TestBackend>() {
    let settings = Settings { shadow_rays: 8, ..direct_settings(Direct::Nee, 0.1) };
    let scene = airlight(5.0);
    let media = Fog::new(0.1, 0.5, -0.5).at(&scene, 0);
    let [found, ..] = per_pass::<T>(&scene, &media, &settings, (8, 8), &Layer::ALL);
    assert!((moments(&found).0 / 0.052_607_2 - 1.0).abs() > 0.5, "{found:?}");
}

/// A point light of 1 W in endless fog, with the camera at a distance and an angle from it; a black speck behind, since a scene
/// needs a surface.
fn endless(distance: f64, degrees: f64) -> Scene {
    let mut builder = SceneBuilder::new();
    let black = builder.material(MaterialDesc::lambert("speck", [0.0; 3]));
    builder.quad("speck", [[-3.0, 0.0, 0.0], [-3.0, 1e-3, 0.0], [-3.0, 1e-3, 1e-3], [-3.0, 0.0, 1e-3]], black);
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let position = [distance * cosine, distance * sine, 0.0];
    builder.light("light", LightDesc::Point { position, intensity: [0.25 * FRAC_1_PI; 3] });
    camera(&mut builder, [0.0; 3], [1.0, 0.0, 0.0], 1e-3);
    builder.build().unwrap()
}

/// P14: all orders of scattering around a point light in endless fog; that of the first order by shadow rays.
pub fn p14_endless_fog<T: TestBackend>() {
    for &(albedo, distance, degrees, all, once) in cases::<T, _>(&[
        (0.9, 1.0, 180.0, 4.236_269e-3, 5.814_939e-4),
        (0.9, 2.0, 60.0, 2.997_893e-3, 2.495_940e-4),
        (0.5, 1.0, 90.0, 1.304_728e-3, 6.120_590e-4),
        (0.5, 2.0, 60.0, 3.877_344e-4, 1.386_634e-4),
        (0.9, 1.0, 90.0, 6.482_288e-3, 1.101_706e-3),
    ]) {
        let scene = endless(distance, degrees);
        let media = Fog::new(1.0, albedo, 0.0).at(&scene, 0);
        let settings = Settings { photons: 30_000, shadow_rays: 8, ..fixed_radius(0.1) };
        let what = format!("fog of albedo {albedo}, {distance} m, {degrees}°");
        let [direct, ..] = per_pass::<T>(&scene, &media, &settings, (16, 8), &[Layer::Direct]);
        assert_mean(&format!("{what}, once"), &direct, once, 2e-5);
        // Within the radius the light varies by the square of it: less than a hundredth of the curvature.
        let [whole, ..] = per_pass::<T>(&scene, &media, &settings, (16 * T::ONE_OF, 8), &Layer::ALL);
        assert_mean(&what, &whole, all, 3e-3);
    }
}

/// Settings with this radius in every pass.
pub(crate) fn fixed_radius(radius: f64) -> Settings {
    Settings { indirect: Indirect::Map, ..direct_settings(Direct::Nee, radius) }
}

/// P12: in a closed room of even walls, fog that absorbs nothing changes nothing.
pub fn p12_furnace<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let radiance = FRAC_1_PI;
    let walls = builder.material(MaterialDesc::emissive("walls", [0.5; 3], [radiance; 3]));
    let (positions, triangles) = shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3]));
    builder.mesh("room", positions, triangles, walls);
    let towards = [0.6, 0.0, 0.8];
    let projection = Projection::Perspective { vertical_fov: 1.0 };
    builder.camera("inside", CameraDesc::new([-0.3, 0.1, -0.2], towards, [0.0, 1.0, 0.0], projection));
    let scene = builder.build().unwrap();
    for &(extinction, g, indirect) in cases::<T, _>(&[
        (1e-4, 0.0, Indirect::Map),
        (0.7, 0.0, Indirect::Map),
        (3.0, -0.5, Indirect::Map),
        (0.7, 0.8, Indirect::Map),
        (3.0, -0.5, Indirect::Gather),
        (0.7, 0.8, Indirect::Gather),
    ]) {
        let media = Fog::new(extinction, 1.0, g).at(&scene, 0);
        let settings = Settings { photons: 20_000, shadow_rays: 4, max_bounces: 200, indirect, ..fixed_radius(0.05) };
        let [found, ..] = per_pass::<T>(&scene, &media, &settings, (12 * T::ONE_OF, 16), &Layer::ALL);
        // Estimates near the walls of the room lose light beyond them: surface areas correct those on walls; those around
        // segments lose less than the share of segments within a radius of a wall.
        assert_mean(&format!("furnace, σ = {extinction}, g = {g}, {indirect:?}"), &found, 2.0 * radiance, 1.5e-2);
    }
}

/// A floor that only a lit fog above it lights: with final gathering the same picture as without, bit by bit, since its rays meet
/// nothing. A wall beside it changes that.
pub fn light_of_fog_is_not_gathered_twice<T: TestBackend>() {
    let picture = |indirect, is_alone: bool| {
        let mut builder = SceneBuilder::new();
        let floor = builder.material(MaterialDesc::lambert("floor", [0.8; 3]));
        builder.quad("floor", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], floor);
        if !is_alone {
            builder.quad("wall", [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, -1.0]], floor);
        }
        builder.light("light", LightDesc::Point { position: [0.2, 0.6, 0.1], intensity: [1.0; 3] });
        builder.medium(AmbientMedium::new([0.5; 3], [0.1; 3]).with_bounds([-2.0, -1.0, -2.0], [2.0, 2.0, 2.0]));
        camera(&mut builder, [0.0, 0.4, 3.0], [0.0, 0.0, -1.0], 0.5);
        let scene = builder.build().unwrap();
        let settings = Settings { photons: 4000, indirect, ..fixed_radius(0.1) };
        let media = scene.view().media.to_vec();
        let mut renderer = renderer::<T>(&scene, &media, &settings, 16);
        renderer.pass(0, &mut ()).unwrap();
        let film = renderer.film().unwrap();
        film.pixels.iter().map(|pixel| pixel.layers[Layer::Indirect as usize].map(f64::to_bits)).collect::<Vec<_>>()
    };
    let [read, gathered] = [Indirect::Map, Indirect::Gather].map(|indirect| picture(indirect, true));
    assert!(read.iter().filter(|&&light| light != [0; 3]).count() > 100);
    assert_eq!(read, gathered);
    assert_ne!(picture(Indirect::Map, false), picture(Indirect::Gather, false));
}

/// A solid with a medium of its own.
fn body(ior: f64) -> MaterialDesc {
    MaterialDesc::new("body", Surface::Dielectric { ior, absorption: [1.0; 3], tint: [1.0; 3], roughness: 0.0 })
}

/// An even shell of radiance 1 around a solid of this refractive index, seen along x.
fn in_even_light(shape: shapes::Shape, ior: f64, shell: f64, half_height: f64) -> Scene {
    let mut builder = SceneBuilder::new();
    let light = builder.material(MaterialDesc::emissive("shell", [0.0; 3], [1.0; 3]));
    let (positions, triangles) = shapes::flip(shapes::icosphere(3, [0.0; 3], shell));
    builder.mesh("shell", positions, triangles, light);
    let solid = builder.material(body(ior));
    let (positions, triangles) = shape;
    builder.mesh("body", positions, triangles, solid);
    camera(&mut builder, [-0.8 * shell, 0.01, 0.02], [1.0, 0.0, 0.0], half_height);
    builder.build().unwrap()
}

/// P13: a body that absorbs nothing in even light looks like the light, matched or refracting.
pub fn p13_body_in_even_light<T: TestBackend>() {
    for &(ior, extinction, g) in cases::<T, _>(&[(1.0, 1.0, 0.0), (1.5, 1.0, 0.0), (1.5, 4.0, 0.7)]) {
        let scene = in_even_light(shapes::icosphere(3, [0.0; 3], 1.0), ior, 1.5, 1e-3);
        let media = Fog::new(extinction, 1.0, g).at(&scene, 1);
        let settings = Settings { photons: 60_000, max_bounces: 400, caustics: true, ..fixed_radius(0.1) };
        let [found, ..] = per_pass::<T>(&scene, &media, &settings, (16, 8), &Layer::ALL);
        // Chords of the mesh end up to a radius before the surface.
        assert_mean(&format!("ball, n = {ior}, σ = {extinction}, g = {g}"), &found, 1.0, 1e-2);
    }
}

/// P10: what slabs reflect and let through of even light, by the doubling method; of each channel by itself.
pub fn p10_slabs<T: TestBackend>() {
    let slab = shapes::cuboid([-0.5, -3.5, -3.5], [0.5, 3.5, 3.5]);
    let scene = in_even_light(slab, 1.0, 5.2, 1.2);
    let colours = Fog { scattering: [0.45, 1.6, 4.0], absorption: [0.05, 0.4, 4.0], ..Fog::new(0.0, 0.0, 0.0) };
    for &(what, fog, expected) in cases::<T, _>(&[
        ("thin", Fog::new(2.0, 0.9, 0.75), [0.758_352; 3]),
        ("thick", Fog::new(4.0, 0.99, 0.75), [0.284_315_3 + 0.646_509_2; 3]),
        ("coloured", colours, [0.934_42, 0.551_89, 0.116_05]),
    ]) {
        let media = fog.at(&scene, 1);
        let settings = Settings { photons: 100_000, max_bounces: 64, caustics: true, ..fixed_radius(0.12) };
        let found = per_pass::<T>(&scene, &media, &settings, (12, 12), &Layer::ALL);
        for (channel, (found, expected)) in found.iter().zip(expected).enumerate() {
            assert_mean(&format!("{what} slab, channel {channel}"), found, expected, 6e-3);
        }
    }
}

/// Parallel light that enters a body by a face shows its beam in the layer of caustics: α f E e^(−σz)(1 − e^(−σw)).
pub fn p3_shaft<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let solid = builder.material(body(1.0));
    let (positions, triangles) = shapes::cuboid([0.0, -4.0, -2.0], [1.0, 0.0, 2.0]);
    builder.mesh("body", positions, triangles, solid);
    builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
    camera(&mut builder, [-1.0, -2.0, 0.0], [1.0, 0.0, 0.0], 1e-3);
    let scene = builder.build().unwrap();
    let media = Fog::new(0.1, 0.5, 0.0).at(&scene, 1);
    let settings = Settings { photons: 40_000, caustics: true, ..fixed_radius(0.1) };
    let [found, ..] = per_pass::<T>(&scene, &media, &settings, (24, 4), &[Layer::Caustic]);
    let expected = 0.5 * 0.25 * FRAC_1_PI * (-0.2_f64).exp() * -(-0.1_f64).exp_m1();
    assert_mean("shaft", &found, expected, 2e-3);
}

/// Claims of error hold for light of photons in a medium that falls off along a shaft and ends at the side of a body: at least
/// 85 % of the pixels have an interval, and 93 % of these contain the truth. Intervals that were far too wide would also contain
/// 1.2 times the truth: at most 85 % may.
pub fn intervals_of_a_shaft<T: TestBackend>() {
    const SIDE: u32 = 16;
    let (seen, side, extinction) = (0.6, 2.0, 0.5_f64);
    let mut builder = SceneBuilder::new();
    let solid = builder.material(body(1.0));
    let (positions, triangles) = shapes::cuboid([0.0, -4.0, -side], [1.0, 0.0, side]);
    builder.mesh("body", positions, triangles, solid);
    builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
    let middle = [-1.0, -2.0, 1.5];
    camera(&mut builder, middle, [1.0, 0.0, 0.0], seen);
    let scene = builder.build().unwrap();
    let media = Fog::new(extinction, 0.5, 0.0).at(&scene, 1);
    // The picture's columns run towards +z.
    let pixel = 2.0 * seen / f64::from(SIDE);
    let truth = |index: usize| {
        let (row, column) = (index as u32 / SIDE, index as u32 % SIDE);
        let depth = -(middle[1] + seen) + pixel * (f64::from(row) + 0.5);
        let within = (side - (middle[2] - seen + pixel * f64::from(column))) / pixel;
        0.125 * FRAC_1_PI * (-extinction * depth).exp() * -(-extinction).exp_m1() * within.clamp(0.0, 1.0)
    };
    let (mut claimed, mut covered, mut wrong, mut lit) = (0, 0, 0, 0);
    for seed in 1..=3 {
        let once = Settings { indirect: photon_core::Indirect::None, ..fixed_radius(0.1) };
        let settings = Settings { errors: true, photons: 40_000, caustics: true, seed, ..once };
        let mut renderer = renderer::<T>(&scene, &media, &settings, SIDE);
        for pass in 0..16 {
            renderer.pass(pass, &mut ()).unwrap();
        }
        let intervals = renderer.film().unwrap().confidence_intervals().unwrap();
        for (index, interval) in intervals.iter().enumerate().filter(|(index, _)| truth(*index) > 0.0) {
            lit += 1;
            if interval.flags.is_empty() {
                let holds = |truth: f64| usize::from((interval.value - truth).abs() <= interval.half_width);
                claimed += 1;
                covered += holds(truth(index));
                wrong += holds(1.2 * truth(index));
            }
        }
    }
    let what = format!("{claimed} of {lit} claimed, {covered} covered, {wrong} with a wrong truth");
    eprintln!("{what}");
    assert!(claimed * 100 >= lit * 85 && covered * 100 >= claimed * 93 && wrong * 100 <= claimed * 85, "{what}");
}

/// Every path ends in exactly one way, in number and in flux of each channel, and collisions lose nothing but what is absorbed.
pub fn paths_are_accounted_for<T: TestBackend>() {
    let scene = endless(1.0, 90.0);
    let colours = Fog { scattering: [0.5, 1.0, 0.2], absorption: [0.1, 0.0, 0.8], ..Fog::new(0.0, 0.0, 0.4) };
    let media = colours.at(&scene, 0);
    let settings = Settings { photons: 20_000, ..fixed_radius(0.1) };
    let mut renderer = renderer::<T>(&scene, &media, &settings, 4);
    let PassEnd::Done(report) = renderer.pass(0, &mut ()).unwrap() else { panic!("the pass ended early") };
    let tally = report.tally;
    assert_eq!(tally.emitted, tally.absorbed + tally.escaped + tally.truncated + tally.dropped + tally.terminated);
    let ends =
        [tally.flux_absorbed, tally.flux_escaped, tally.flux_truncated, tally.flux_dropped, tally.flux_terminated];
    for channel in 0..3 {
        let sum: i128 = ends.iter().map(|flux| flux.units()[channel]).sum();
        assert_eq!(sum, tally.flux_emitted.units()[channel], "channel {channel}");
    }
    assert!(tally.absorbed > tally.emitted / 2 && tally.terminated > 0 && tally.dropped == 0, "{tally:?}");
}

/// A limit on memory counts the segments of camera paths that go on by a mirror: passes get smaller, their pictures are those of
/// passes of that size, and what is held stays below it.
pub fn memory_is_limited_with_a_mirror<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let mirror = builder.material(MaterialDesc::mirror("mirror", [0.9; 3]));
    let grey = builder.material(MaterialDesc::lambert("wall", [0.5; 3]));
    builder.quad("mirror", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], mirror);
    builder.quad("wall", [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, -1.0]], grey);
    builder.light("light", LightDesc::Point { position: [0.0, 0.5, 0.0], intensity: [1.0; 3] });
    let projection = Projection::Perspective { vertical_fov: 0.8 };
    builder.camera("down", CameraDesc::new([0.0, 0.5, 1.5], [0.0, -0.4, -1.0], [0.0, 1.0, 0.0], projection));
    let scene = builder.build().unwrap();
    let media = Fog::new(0.5, 0.9, 0.0).at(&scene, 0);
    let view = View { camera: scene.camera(None, 24, 24).unwrap(), width: 24, height: 24 };
    let start = |settings: Settings| {
        let mut made = Pipeline::new(T::make(2), &SceneView { media: &media, ..scene.view() }, view, settings)?;
        made.pass(0, &mut ())?;
        Ok(made)
    };
    let cap = 12 << 20;
    let asked = Settings { photons: 1_000_000, ..fixed_radius(0.1) };
    let mut capped = start(Settings { memory: Some(cap), ..asked.clone() }).unwrap();
    let facts = capped.facts();
    let held: u64 = facts.memory.iter().map(|(_, bytes)| bytes).sum();
    assert!(held <= cap && facts.photons < asked.photons, "{} paths, {held} bytes: {:?}", facts.photons, facts.memory);
    let mut free = start(Settings { photons: facts.photons, ..asked.clone() }).unwrap();
    assert_eq!(capped.film().unwrap().pixels, free.film().unwrap().pixels);
    // Queries, estimates and four segments of each pixel do not fit.
    let refused = start(Settings { memory: Some(1 << 20), ..asked }).err();
    assert!(matches!(refused, Some(Error::OverMemory { .. })), "{refused:?}");
}

/// The radius is found from at most 4096 pixels; that of a picture with more is about the same.
pub fn radius_of_more_pixels_than_tell_it<T: TestBackend>() {
    let scene = photon_scene::builtin("fog").unwrap().build().unwrap();
    let settings = Settings { photons: 2000, ..Settings::default() };
    let [few, more] = [64, 72].map(|size| {
        let radii = renderer::<T>(&scene, scene.view().media, &settings, size).radii();
        f64::from(*radii.last().unwrap())
    });
    assert!((more / few).ln().abs() < 0.1 && few > 0.0, "{few}, {more}");
}

/// What cannot be rendered with such media is refused, with the remedy.
pub fn what_media_do_not_go_with_is_refused<T: TestBackend>() {
    let scene = endless(1.0, 90.0);
    let refused = |scene: &Scene, fog: Fog, settings: &Settings| {
        let (media, view) = (fog.at(scene, 0), View { camera: scene.camera(None, 4, 4).unwrap(), width: 4, height: 4 });
        let made = Pipeline::new(T::make(1), &SceneView { media: &media, ..scene.view() }, view, settings.clone());
        made.err().map(|error| error.to_string()).unwrap_or_default()
    };
    let (thin, plain) = (Fog::new(1.0, 0.9, 0.0), fixed_radius(0.1));
    for (settings, expected) in [
        (Settings { direct: Direct::Photons, ..plain.clone() }, "--direct nee"),
        (Settings { transparent_background: true, ..plain.clone() }, "fog hides"),
        (
            Settings { estimator: photon_core::Estimator::Knn { k: 50, max_radius: None }, ..plain.clone() },
            "by a radius",
        ),
        (plain.clone(), ""),
    ] {
        let found = refused(&scene, thin, &settings);
        assert_eq!(found.is_empty(), expected.is_empty(), "{found}");
        assert!(found.contains(expected), "{found}");
    }
    let found = refused(&scene, Fog::new(1e6, 0.9, 0.0), &plain);
    assert!(found.contains("albedo [0.4"), "{found}");
    // Absorption alone may be as dense as it likes; then nothing in this scene shows light.
    assert!(refused(&scene, Fog::new(1e6, 0.0, 0.0), &plain).contains("no surface"));
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("floor", [0.5; 3]));
    builder.quad("floor", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], grey);
    builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
    camera(&mut builder, [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 0.5);
    let found = refused(&builder.build().unwrap(), thin, &plain);
    assert!(found.contains("from infinity"), "{found}");
}

//! S7, S10, S11, S17, S18, S30, S31, S33: extreme powers and counts.

use photon_core::{
    Backend, Batch, Direct, Error, Estimator, Indirect, MediaDeposits, Pass, PerMap, PhotonRay, Pipeline, Render,
    Requirements, Settings, Tally, TransportBackend, View, offset,
};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, shapes};

use super::scenes::{Put, mean, studio};
use super::sheet::Sheet;
use crate::harness::{InFull, TestBackend, film, look_at_point, per_pass, watts};
use crate::stats::{SIGMAS, moments, standard_error};
use crate::{determinism, numerics};

/// Runs the group.
pub fn all<T: TestBackend>(sheet: &mut Sheet) {
    brightness::<T>(sheet);
    unequal_lights::<T>(sheet);
    vanishing_light(sheet);
    many_paths::<T>(sheet);
    capped_memory::<T>(sheet);
    sheet.proved(
        "S7",
        "fewer photons than k: all of them over the whole radius",
        "0, 1, k−1",
        "rounding",
        numerics::s7_fewer_photons_than_k::<T>,
    );
    sheet.proved(
        "S10",
        "a million photons of a millionth, and of one, add up",
        "1e6 photons",
        "below 1e-6",
        numerics::s10_n1_many_small_numbers::<T>,
    );
    sheet.proved(
        "S29",
        "empty scenes are refused by name",
        "no light, no receiver, no pixel, no area",
        "typed errors",
        numerics::s29_nothing_to_render::<T>,
    );
    sheet.proved("S30", "one photon, one pixel", "1", "finite", numerics::s30_least_of_everything::<T>);
    sheet.proved(
        "S31",
        "a full photon buffer",
        "100 of 10⁴",
        "what is needed is said; grown, the same bits",
        determinism::s31_full_photon_buffers::<T>,
    );
}

/// S17 and S33: brightness changes the image only by a scale factor.
fn brightness<T: TestBackend>(sheet: &mut Sheet) {
    let settings = Settings { photons: 3000, max_bounces: 16, seed: 8, ..Settings::default() };
    let picture = |watts: f64| {
        let scene = studio(Put { watts, ..Put::default() }).build().unwrap();
        film::<T>(&scene, &settings, 1, 8)
    };
    let base = picture(1.0);
    let powers = sheet.choose(vec![100], vec![-100, 100], vec![-100, 100]);
    let bits = powers.into_iter().all(|power| picture(2.0_f64.powi(power)).pixels == base.pixels);
    let mut worst = 0.0_f64;
    let exponents: Vec<i32> = sheet.choose(vec![-30], vec![-30, 30], (-30..=30).step_by(6).collect());
    for &exponent in &exponents {
        let watts = 10.0_f64.powi(exponent);
        let seen = picture(watts);
        worst = worst.max((mean(&seen, None) / watts / mean(&base, None) - 1.0).abs());
    }
    let range = format!("1e-30 W … 1e30 W, {} powers; 2^±100", exponents.len());
    let found = format!("{worst:.1e}; {}", if bits { "all bits equal" } else { "bits differ" });
    sheet.holds("S17", "picture per watt, relative; powers of two bit by bit", range, found, worst < 1e-6 && bits);
}

/// A floor lit by a weak light alone; the other light, `ratio` times as strong, is enclosed in a box above the
/// floor.
fn shut_in(ratio: f64) -> Scene {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    builder.quad("floor", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], grey);
    let (positions, triangles) = shapes::cuboid([-0.2, 1.5, -0.2], [0.2, 1.9, 0.2]);
    builder.mesh("box", positions, triangles, grey);
    builder.light("strong", LightDesc::Point { position: [0.0, 1.7, 0.0], intensity: [ratio; 3] });
    builder.light("weak", LightDesc::Point { position: [0.0, 1.0, 0.0], intensity: [1.0; 3] });
    look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 1e-4);
    builder.build().unwrap()
}

/// S18: unbiased, with an error that is determined by the photons and rays and not by the ratio.
fn unequal_lights<T: TestBackend>(sheet: &mut Sheet) {
    let ratios: Vec<f64> = sheet.choose(vec![1e20], vec![1.0, 1e20], vec![1.0, 1e3, 1e6, 1e10, 1e15, 1e20, 1e30]);
    // The weak light's photons per direct map, and its share of shadow rays. E = 1 W/m², L = albedo/π.
    let truth = 0.5 / std::f64::consts::PI;
    let base = Settings { indirect: Indirect::None, caustics: false, seed: 2, ..Settings::default() };
    for ratio in ratios {
        let scene = shut_in(ratio);
        let passes = sheet.either(16, 64);
        let rays = per_pass::<T>(&scene, &Settings { shadow_rays: 64, photons: 1, ..base.clone() }, passes, 8);
        let estimator = Estimator::Radius { radius: Some(0.2) };
        let photons = sheet.either(30_000, 100_000);
        let by_map = Settings { direct: Direct::Photons, alpha: 1.0, estimator, photons, ..base.clone() };
        // As many passes as for rays: with 8, the standard error itself is too uncertain.
        let map = per_pass::<InFull<T>>(&scene, &by_map, passes, 4);
        let mut good = true;
        let mut found = Vec::new();
        // Curvature: the field is (1 + r²)^(−3/2) at distance r from the point below the light; averaged with the
        // Epanechnikov kernel, ⟨r²⟩ = h²/3 and ⟨r⁴⟩ = h⁴/6, with h = 0.2.
        let bent = 1.0 - 1.5 * 0.04 / 3.0 + 1.875 * 0.0016 / 6.0;
        // Shadow rays start this much nearer to the light, which is 1 m away.
        let nearer = scene.units().length_to_user(offset::STEP);
        let by_rays = truth / (1.0 - nearer).powi(2);
        for (name, values, expected) in [("shadow rays", rays, by_rays), ("photons", map, bent * truth)] {
            let (value, error) = (moments(&values).0, standard_error(&values));
            good &= (value - expected).abs() <= SIGMAS * error + 1e-6 * truth && error < 0.25 * truth;
            found.push(format!("{name} {:.5} ± {:.1e}", value / truth, error / truth));
        }
        let what = "dim light alone visible: mean over truth, relative standard error";
        sheet.holds("S18", what, format!("1 : {ratio:e} in power"), found.join("; "), good);
    }
}

/// A light too weak for f32 is dropped, with a warning.
fn vanishing_light(sheet: &mut Sheet) {
    let scene = shut_in(1e42);
    let told = scene.warnings().iter().any(|warning| warning.contains("weak"));
    let found = format!(
        "{} of 2 lights are left; {}",
        scene.view().lights.len(),
        if told { "named in a warning" } else { "silent" }
    );
    sheet.holds("S18", "a light too weak for 32 bits beside another", "1 : 1e42 in power", found, told);
}

/// S11: counts beyond 32 bits, with the memory of a single pass.
fn many_paths<T: TestBackend>(sheet: &mut Sheet) {
    let scene = numerics::turned_room(0.5, 1.0).build().unwrap();
    let batch = sheet.either(20_000_u32, 1_000_000);
    let passes = sheet.either(3, 100);
    let settings = Settings { max_bounces: 64, direct: Direct::None, indirect: Indirect::None, ..Settings::default() };
    let mut total = Tally::default();
    for seed in 0..passes {
        let tally = trace_without_maps::<T>(&scene, &Settings { seed, ..settings.clone() }, batch);
        total.merge(&tally);
    }
    let emitted = watts(&scene, &total, &total.flux_emitted) / scene.units().power - 1.0;
    let mean = total.surfaces as f64 / total.emitted as f64;
    let good = total.balances() && emitted.abs() < 1e-6 && total.emitted == u64::from(batch) * passes;
    let range = format!("{} paths, {} surfaces", total.emitted, total.surfaces);
    let found = format!("balance exact; emitted {emitted:+.1e}; {mean:.4} surfaces a path (2)");
    sheet.holds("S11", "counts and flux of many paths add up", range, found, good && (mean - 2.0).abs() < 0.05);
}

pub(crate) fn trace_without_maps<T: TestBackend>(scene: &Scene, settings: &Settings, count: u32) -> Tally {
    let mut on = T::make(2);
    let view = scene.view();
    let required = Requirements::of(&view, settings);
    let prepared = on.prepare(&view, &required).unwrap();
    let mut stages = on.stages(&required, settings).unwrap();
    let pass = Pass { seed: settings.seed, index: 0, random: settings.random, sample: 0, samples: 1 };
    let mut rays = on.alloc::<PhotonRay>("rays", u64::from(count)).unwrap();
    let batch = Batch { pass, paths: 0..count };
    stages.emitter.emit(&mut on, &prepared, &batch, &mut rays).unwrap();
    let deposits = PerMap::default();
    stages.tracer.trace(&mut on, &prepared, &batch, &rays, deposits, MediaDeposits::default()).unwrap();
    stages.tracer.take_tally(&mut on).unwrap()
}

/// A memory limit gives smaller passes and batches, whose images are those of passes of that size.
fn capped_memory<T: TestBackend>(sheet: &mut Sheet) {
    let scene = studio(Put::default()).build().unwrap();
    let view = View { camera: scene.camera(None, 12, 12).unwrap(), width: 12, height: 12 };
    let asked = Settings { photons: 2_000_000, max_bounces: 16, ..Settings::default() };
    let start = |settings: &Settings| Pipeline::new(T::make(2), &scene.view(), view, settings.clone());
    let cap = 12 << 20;
    let mut capped = start(&Settings { memory: Some(cap), ..asked.clone() }).unwrap();
    capped.pass(0, &mut ()).unwrap();
    let facts = capped.facts();
    let held: u64 = facts.memory.iter().map(|(_, bytes)| bytes).sum();
    let mut free = start(&Settings { photons: facts.photons, ..asked.clone() }).unwrap();
    free.pass(0, &mut ()).unwrap();
    let same = capped.film().unwrap().pixels == free.film().unwrap().pixels;
    let refused = match start(&Settings { memory: Some(100_000), ..asked }) {
        Err(Error::OverMemory { needed, allowed: 100_000 }) => needed > 100_000,
        _ => false,
    };
    let bits = if same { "the bits of passes of that size" } else { "other bits" };
    let found = format!("{} paths a pass, {:.1} MiB held, {bits}", facts.photons, held as f64 / f64::from(1 << 20));
    let good = same && refused && held <= cap && facts.photons < 2_000_000;
    sheet.holds(
        "cap",
        "a cap on memory is kept by smaller passes",
        "2e6 paths in 12 MiB; 100 kB is refused",
        found,
        good,
    );
}

//! S12 to S16, S21 to S23: indices, angles, albedos and absorptions at their ends.

use photon_core::fresnel::fresnel;
use photon_core::glam::Vec3;
use photon_core::{PhotonRay, Settings, math};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, Surface, shapes};

use super::scenes::{anywhere, follow, ray, turned};
use super::sheet::Sheet;
use crate::harness::{TestBackend, Uniform};
use crate::numerics::turned_room;
use crate::stats::SIGMAS;
use crate::{dielectrics, numerics};

/// The group.
pub fn all<T: TestBackend>(sheet: &mut Sheet) {
    formulas(sheet);
    slabs::<T>(sheet);
    absorption::<T>(sheet);
    grazing::<T>(sheet);
    nested::<T>(sheet);
    overlapping::<T>(sheet);
    nearly_white::<T>(sheet);
    refused(sheet);
    sheet.proved(
        "S12",
        "a solid of index 1 is invisible: the picture's bits are the same",
        "ior 1",
        "exact",
        dielectrics::t13_ior_one_is_invisible::<T>,
    );
    sheet.proved(
        "S14",
        "light trapped by total reflection ends at the cap",
        "ball of glass, light off its centre",
        "the share of the closed form",
        dielectrics::t7_trapped_light::<T>,
    );
    sheet.proved(
        "S15",
        "albedo 1: all flux at the cap",
        "40 bounces",
        "exact",
        numerics::s15_albedo_one_ends_at_the_cap::<T>,
    );
}

/// Reflectance of unpolarised light in f64; `eta` is taken as f32 holds it.
fn reflectance(cosine: f64, eta: f32) -> f64 {
    let eta = f64::from(eta);
    let discriminant = (eta - 1.0) * (eta + 1.0) + cosine * cosine;
    if discriminant <= 0.0 {
        return 1.0;
    }
    let root = discriminant.sqrt();
    let s = (cosine - root) / (cosine + root);
    let p = (eta * eta * cosine - root) / (eta * eta * cosine + root);
    0.5 * (s * s + p * p)
}

/// S12, S13, S22 in the functions themselves, beside f64.
fn formulas(sheet: &mut Sheet) {
    let mut worst = 0.0_f64;
    let mut sane = true;
    let indices = [1e-6_f32, 1e-3, 0.5, 0.999, 0.999_999_9, 1.0, 1.000_000_1, 1.001, 1.5, 1e3, 1e6];
    let cosines = [0.0_f32, 1e-38, 1e-20, 1e-9, 1.745_329e-6, 1e-4, 0.01, 0.1, 0.5, 0.9, 1.0];
    for eta in indices {
        for cosine in cosines {
            let found = fresnel(cosine, eta);
            sane &= (0.0..=1.0).contains(&found.reflectance) && (0.0..=1.0).contains(&found.cos_transmitted);
            if eta != 1.0 {
                worst = worst.max((f64::from(found.reflectance) - reflectance(f64::from(cosine), eta)).abs());
            }
        }
    }
    sheet.holds(
        "S12 S13",
        "Fresnel in f32 beside f64: largest difference; 0 ≤ R ≤ 1",
        "ior 1e-6…1e6, grazing to normal",
        format!("{worst:.1e}"),
        sane && worst < 2e-6,
    );

    let mut worst = 0.0_f64;
    for tau in [0.0_f32, 1e-30, 1e-7, 1e-3, 0.1, 1.0, 5.0, 20.0, 80.0] {
        let truth = (-f64::from(tau)).exp();
        worst = worst.max((f64::from(math::exp_neg(tau)) / truth - 1.0).abs());
    }
    let far = [87.4_f32, 100.0, 1e4, 1e30, f32::MAX, f32::INFINITY].map(math::exp_neg);
    let good = worst < 1e-6 && far.iter().all(|&t| (0.0..=1.2e-38).contains(&t));
    sheet.holds(
        "S21 S22",
        "exp(−τ) beside f64, relative; to 0 without NaN beyond",
        "τ = 0 … 80; 87 … ∞",
        format!("{worst:.1e}"),
        good,
    );
}

/// Flux that passes what stands on the plane y = 0 straight down, and that comes back, per ray.
fn down<T: TestBackend>(scene: &Scene, count: usize, bounces: u32) -> (f64, f64) {
    let mut uniform = Uniform::new(41);
    let mut rays: Vec<PhotonRay> = (0..count)
        .map(|_| {
            let at = [uniform.draw() - 0.5, 1.3, uniform.draw() - 0.5];
            ray(scene.units().point(at).into(), Vec3::NEG_Y)
        })
        .collect();
    let (_, tally) = follow::<T>(scene, &Settings { max_bounces: bounces, ..Settings::default() }, &mut rays);
    assert!(tally.balances() && tally.dropped == 0, "{tally:?}");
    let per_ray = |flux: &photon_core::FluxSum| flux.value()[0] / count as f64;
    // What the floor takes is what came through; solids take their share on the way.
    (tally.absorbed as f64 / count as f64, per_ray(&tally.flux_escaped))
}

fn solid(builder: &mut SceneBuilder, name: &str, ior: f64, sigma: f64, low: [f64; 3], high: [f64; 3]) {
    let surface = Surface::Dielectric { ior, absorption: [sigma; 3], tint: [1.0; 3], roughness: 0.0 };
    let material = builder.material(MaterialDesc::new(name, surface));
    let (positions, triangles) = shapes::cuboid(low, high);
    builder.mesh(name, positions, triangles, material);
}

/// A black floor under what `add` puts there, and a light that is only there to give power.
fn over_a_floor(add: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let mut builder = SceneBuilder::new();
    let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
    let y = -0.2;
    builder.quad("floor", [[-1.0, y, 1.0], [1.0, y, 1.0], [1.0, y, -1.0], [-1.0, y, -1.0]], black);
    add(&mut builder);
    builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
    builder.build().unwrap()
}

fn slab(ior: f64, sigma: f64) -> Scene {
    over_a_floor(|builder| solid(builder, "slab", ior, sigma, [-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]))
}

/// S13: a slab at normal incidence, all orders: `T = (1 − r)/(1 + r)`. What passes is binomial.
fn slabs<T: TestBackend>(sheet: &mut Sheet) {
    let count = sheet.either(20_000, 400_000);
    let all = vec![1e-3, 0.5, 1.0 - 1e-7, 1.0 + 1e-7, 1.001, 1.5, 1e3];
    for ior in sheet.choose(vec![1e-3, 1.0 + 1e-7], all.clone(), all) {
        let r = reflectance(1.0, ior as f32);
        let truth = (1.0 - r) / (1.0 + r);
        let (passed, _) = down::<T>(&slab(ior, 0.0), count, 20_000);
        let error = (truth * (1.0 - truth) / count as f64).sqrt();
        let range = format!("ior {ior}, {count} rays");
        let found = format!("{passed:.6} of {truth:.6}, z = {:.1}", (passed - truth) / error.max(1e-12));
        let good = (passed - truth).abs() <= SIGMAS * error + 1e-9;
        sheet.holds("S13", "transmittance of a slab, all orders", range, found, good);
    }
}

/// S22: absorption from none to all.
fn absorption<T: TestBackend>(sheet: &mut Sheet) {
    let count = 4000;
    let all = vec![(0.0, 1.0), (1e-30, 1.0), (1e-7, 1.0), (1e4, 0.0), (1e30, 0.0)];
    for (sigma, truth) in sheet.choose(vec![(1e30, 0.0)], all.clone(), all) {
        // An index so near 1 that nothing is reflected, and so far from it that it is there.
        let scene = over_a_floor(|builder| {
            solid(builder, "slab", 1.0 + 2e-7, sigma, [-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]);
        });
        let mut rays: Vec<PhotonRay> =
            (0..count).map(|i| ray(scene.units().point([f64::from(i) * 1e-4, 1.3, 0.1]).into(), Vec3::NEG_Y)).collect();
        let (_, tally) = follow::<T>(&scene, &Settings { max_bounces: 1000, ..Settings::default() }, &mut rays);
        // One surface fewer, and what arrives at the floor is what is cut off.
        let mut again = rays.clone();
        let (_, cut) = follow::<T>(&scene, &Settings { max_bounces: 2, ..Settings::default() }, &mut again);
        let passed = cut.flux_truncated.value()[0] / f64::from(count);
        let good = tally.balances() && tally.dropped == 0 && (passed - truth).abs() < 1e-6;
        let range = format!("{sigma:e} per metre over one metre");
        sheet.holds("S22", "flux through an absorbing slab", range, format!("{passed:.7}"), good);
    }
    let surface = Surface::Dielectric { ior: 1.5, absorption: [f64::INFINITY; 3], tint: [1.0; 3], roughness: 0.0 };
    let mut builder = SceneBuilder::new();
    builder.material(MaterialDesc::new("ink", surface));
    let named = builder.build().err().is_some_and(|error| error.to_string().contains("ink"));
    sheet.holds("S22", "infinite absorption is refused by name", "∞", "typed error", named);
}

/// S12: a ray that all but misses the surface. The plane lies in the middle of the scene, where f32
/// resolves the height of such a ray.
fn grazing<T: TestBackend>(sheet: &mut Sheet) {
    let count = sheet.either(50_000, 2_000_000);
    let mut builder = SceneBuilder::new();
    solid(&mut builder, "block", 1.5, 0.0, [-1.0, -2.0, -1.0], [1.0, 0.0, 1.0]);
    builder.light("light", LightDesc::Point { position: [0.0, 2.0, 0.0], intensity: [1.0; 3] });
    let scene = builder.build().unwrap();
    let all = vec![89.0_f64, 89.9, 89.99, 89.9999];
    for degrees in sheet.choose(vec![89.9999], all.clone(), all) {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let origin = Vec3::new(-0.1, (0.1 * cosine) as f32, 0.0);
        let direction = Vec3::new(sine as f32, -cosine as f32, 0.0);
        let mut rays = vec![ray(origin, direction); count];
        let (_, tally) = follow::<T>(&scene, &Settings { max_bounces: 2, ..Settings::default() }, &mut rays);
        // What is reflected meets nothing more; what is refracted meets the block once more.
        let entered = (1.0 - reflectance(cosine, 1.5)) * count as f64;
        let found = tally.truncated as f64;
        let good = (found - entered).abs() <= SIGMAS * (entered + 1.0).sqrt()
            && tally.escaped + tally.truncated == count as u64;
        let range = format!("{degrees}°, {count} rays");
        sheet.holds(
            "S12",
            "rays that enter glass at grazing incidence",
            range,
            format!("{found} of {entered:.1} expected"),
            good,
        );
    }
}

/// Solids within solids, each with its own index: a stack of slabs at normal incidence, all orders:
/// `T = 1/(1 + Σ r/(1−r))` over the boundaries.
fn nested<T: TestBackend>(sheet: &mut Sheet) {
    let count = sheet.either(20_000, 400_000);
    for indices in [vec![1.5, 1.33], vec![1.33, 1.5, 2.4], vec![1.5, 1.0], vec![1.1, 1.2, 1.3, 1.4]] {
        let scene = over_a_floor(|builder| {
            for (depth, &ior) in indices.iter().enumerate() {
                let inset = 0.1 * depth as f64;
                let name = format!("solid {depth}");
                solid(
                    builder,
                    &name,
                    ior,
                    0.0,
                    [inset - 1.0, inset, inset - 1.0],
                    [1.0 - inset, 1.0 - inset, 1.0 - inset],
                );
            }
        });
        let around = std::iter::once(1.0).chain(indices.iter().copied());
        let sum: f64 = around
            .zip(&indices)
            .map(|(outer, inner)| reflectance(1.0, (inner / outer) as f32))
            .map(|r| 2.0 * r / (1.0 - r))
            .sum();
        let truth = 1.0 / (1.0 + sum);
        let (passed, _) = down::<T>(&scene, count, 20_000);
        let error = (truth * (1.0 - truth) / count as f64).sqrt();
        let found = format!("{passed:.4} of {truth:.4}, z = {:.1}", (passed - truth) / error);
        let range = format!("indices {indices:?}, {count} rays");
        let good = (passed - truth).abs() <= SIGMAS * error + 1e-9;
        sheet.holds("nested", "transmittance of solids within solids", range, found, good);
    }
}

/// Two balls that share room: whatever that means, nothing is lost and nothing hangs.
fn overlapping<T: TestBackend>(sheet: &mut Sheet) {
    let mut builder = SceneBuilder::new();
    for (name, x, ior, sigma) in [("left", -0.3, 1.5, 0.5), ("right", 0.3, 2.4, 0.0), ("again", 0.3, 2.4, 1e3)] {
        let surface = Surface::Dielectric { ior, absorption: [sigma; 3], tint: [0.9; 3], roughness: 0.0 };
        let material = builder.material(MaterialDesc::new(name, surface));
        let (positions, triangles) = turned(shapes::icosphere(3, [x, 0.0, 0.0], 0.6));
        builder.mesh(name, positions, triangles, material);
    }
    builder.light("light", LightDesc::Point { position: [0.0; 3], intensity: [1.0; 3] });
    let scene = builder.build().unwrap();
    let mut uniform = Uniform::new(43);
    let count = sheet.either(5000, 200_000);
    let mut rays: Vec<_> = (0..count).map(|_| ray(Vec3::splat(0.01), anywhere(&mut uniform))).collect();
    let (_, tally) = follow::<T>(&scene, &Settings { max_bounces: 500, ..Settings::default() }, &mut rays);
    let found = format!(
        "balance {}; {} dropped, {} cut off",
        if tally.balances() { "exact" } else { "broken" },
        tally.dropped,
        tally.truncated
    );
    let what = "overlapping and coincident solids: energy balance";
    sheet.holds("overlap", what, format!("3 balls, {count} paths"), found, tally.balances() && tally.dropped == 0);
}

/// S15: one photon in 2²⁴ is absorbed per bounce.
fn nearly_white<T: TestBackend>(sheet: &mut Sheet) {
    let albedo = 1.0 - 2.0_f64.powi(-24);
    let scene = turned_room(albedo, 1.0).build().unwrap();
    let (paths, bounces) = (sheet.either(500, 20_000), 1000);
    let tally =
        super::power::trace_without_maps::<T>(&scene, &Settings { max_bounces: bounces, ..Settings::default() }, paths);
    let expected = f64::from(paths) * (1.0 - albedo.powi(bounces as i32));
    let found = tally.absorbed as f64;
    let good = (found - expected).abs() <= SIGMAS * (expected + 1.0).sqrt() && tally.balances() && tally.escaped == 0;
    let range = format!("albedo 1 − 2⁻²⁴, {} bounces", tally.surfaces);
    sheet.holds("S15", "photons absorbed", range, format!("{found} of {expected:.2} expected"), good);
}

/// S16, S13: what is no albedo and no index.
fn refused(sheet: &mut Sheet) {
    let bad = |desc: MaterialDesc| {
        let mut builder = SceneBuilder::new();
        builder.material(desc);
        builder.build().err().is_some_and(|error| error.to_string().contains("culprit"))
    };
    let albedos = [-1e-9, 1.0 + 1e-9, f64::NAN, f64::INFINITY];
    let good = albedos.iter().all(|&albedo| bad(MaterialDesc::lambert("culprit", [0.5, albedo, 0.5])));
    sheet.holds(
        "S16",
        "albedos outside of [0, 1] are refused by name",
        "−1e-9, 1 + 1e-9, NaN, ∞",
        "typed errors",
        good,
    );
    let indices = [0.0, -1.5, 1e-40, 1e39, f64::NAN, f64::INFINITY];
    let good =
        indices.iter().all(|&ior| bad(MaterialDesc::glass("culprit", ior)) && bad(MaterialDesc::thin("culprit", ior)));
    sheet.holds("S13", "invalid indices are refused by name", "0, −1.5, 1e-40, 1e39, NaN, ∞", "typed errors", good);
}

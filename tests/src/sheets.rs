//! The maximum plane distance: parallel sheets that face the same way, closer than the radius.

use std::f64::consts::PI;

use photon_core::{
    Area, Backend, Direct, ErrorMoments, Estimate, EstimateParams, Estimator, IndexKind, Indirect, Kernel, Photon,
    Query, Search, Settings, TransportBackend,
};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, shapes};

use crate::estimators::poisson;
use crate::harness::{TestBackend, look_at_point, per_pass, query_at};
use crate::stats::{agrees, assert_agrees, moments, standard_error};

/// Photon density on the observed sheet, and the density on the other sheet relative to it.
const DENSITY: f64 = 20_000.0;
const OTHER: f64 = 2.0;
/// Radius of the estimates, and distance between the sheets in radii.
const RADIUS: f64 = 0.02;
const APART: f64 = 0.4;
/// The maximum plane distance as a fraction of the radius; no sheet lies between this and √2 times it.
const SHARE: f32 = 0.25;

/// The photons of both sheets.
fn photons(seed: u64) -> Vec<Photon> {
    let mut photons = poisson(DENSITY, 2 * seed);
    let below = (-APART * RADIUS) as f32;
    let other = poisson(OTHER * DENSITY, 2 * seed + 1).into_iter();
    photons.extend(other.map(|photon| Photon { position: [photon.position[0], photon.position[1], below], ..photon }));
    photons
}

/// Estimates, without and with error moments.
fn ask<B: TransportBackend>(
    on: &mut B,
    photons: &[Photon],
    queries: &[Query],
    gather: &EstimateParams,
) -> (Vec<Estimate>, Vec<Estimate>, Vec<ErrorMoments>) {
    let mut stages = on.map_stages(IndexKind::Morton).unwrap();
    let there = on.upload("photons", photons).unwrap();
    let asked = on.upload("queries", queries).unwrap();
    let mut estimates = on.alloc("estimates", queries.len() as u64).unwrap();
    let mut error_moments = on.alloc("spreads", queries.len() as u64).unwrap();
    let map = stages.builder.build(on, there).unwrap();
    let (mut alone, mut together, mut records) = (Vec::new(), Vec::new(), Vec::new());
    stages.estimator.estimate(on, &map, &asked, gather, &mut estimates).unwrap();
    on.download(&estimates, &mut alone).unwrap();
    stages.estimator.estimate_with_moments(on, &map, &asked, gather, &mut estimates, &mut error_moments).unwrap();
    on.download(&estimates, &mut together).unwrap();
    on.download(&error_moments, &mut records).unwrap();
    (alone, together, records)
}

/// D5: with two sheets, the estimate without a plane distance is the density of one plus, with `t` the squared
/// distance between them over the squared radius, (1−t) or (1−t)² of the other's, depending on the kernel:
/// the integral of its weights over `u` from `t` to 1. With a maximum plane distance it is the density of the one
/// alone, also within the second radii, and the other's photons are reported as stray. 512 independent positions;
/// standard errors are estimated from the values.
pub fn d5_a_sheet_beside_does_not_shine_through<T: TestBackend>() {
    let mut on = T::make(2);
    let queries: Vec<_> = (0..256)
        .map(|i| query_at([(i % 16) as f32 * 0.06 - 0.45, (i / 16) as f32 * 0.06 - 0.45, 0.0], RADIUS as f32))
        .collect();
    let disc = PI * RADIUS * RADIUS;
    let rest = 1.0 - APART * APART;
    for (kernel, power) in [(Kernel::Constant, 1), (Kernel::Epanechnikov, 2)] {
        let ball = EstimateParams { kernel, min_normal_cosine: 0.7, ..EstimateParams::new(Search::Radius) };
        let [mut near, mut wide, mut narrow, mut stray, mut all] = [(); 5].map(|()| Vec::new());
        for seed in 0..2 {
            let photons = photons(700 + seed);
            let (alone, together, records) =
                ask(&mut on, &photons, &queries, &EstimateParams { max_plane_distance: SHARE, ..ball });
            for (a, b) in alone.iter().zip(&together) {
                // The same photons, summed in another order.
                let same = a.photons == b.photons && (a.flux[0] - b.flux[0]).abs() <= 1e-5 * a.flux[0];
                assert!(same, "{kernel:?}: {a:?} {b:?}");
            }
            near.extend(alone.iter().map(|e| e.irradiance(1)[0] / DENSITY));
            let over = |flux: f32, area: f64| f64::from(flux) / (area * DENSITY);
            wide.extend(records.iter().map(|s| over(s.wide[0], 2.0 * disc)));
            narrow.extend(records.iter().map(|s| over(s.narrow[0], 0.5 * disc)));
            stray.extend(records.iter().map(|s| over(s.stray, disc)));
            all.extend(ask(&mut on, &photons, &queries, &ball).0.iter().map(|e| e.irradiance(1)[0] / DENSITY));
        }
        let check = |what: &str, values: &[f64], truth: f64| {
            assert_agrees(&format!("{kernel:?}, {what}"), moments(values).0, truth, standard_error(values), 0.0);
        };
        check("near the plane", &near, 1.0);
        check("wide", &wide, 1.0);
        check("narrow", &narrow, 1.0);
        check("stray", &stray, OTHER * (2.0 - APART * APART));
        check("in the ball", &all, 1.0 + OTHER * rest.powi(power));
        assert!(!agrees(moments(&all).0, 1.0, standard_error(&all), 0.0), "{kernel:?}: bias is not significant");
    }
    // A search without a radius cannot have a plane distance relative to it.
    let nearest = EstimateParams {
        min_normal_cosine: 0.7,
        max_plane_distance: SHARE,
        ..EstimateParams::new(Search::KNearest { k: 9 })
    };
    let mut stages = on.map_stages(IndexKind::Morton).unwrap();
    let there = on.upload("photons", &photons(1)).unwrap();
    let map = stages.builder.build(&mut on, there).unwrap();
    let asked = on.upload("queries", &queries).unwrap();
    let mut estimates = on.alloc("estimates", 256).unwrap();
    assert!(stages.estimator.estimate(&mut on, &map, &asked, &nearest, &mut estimates).is_err());
}

/// Radius of the estimates in the images below, in user units.
const REACH: f64 = 0.25;

/// A sheet lit from straight above, with irradiance 1 and albedo 1/2, that ends at `x`; a lower sheet, `down` radii
/// below, continues beyond. Seen at the origin, or `below` it on the lower sheet, in shadow.
fn sheets(x: f64, down: f64, below: bool) -> Scene {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    let lower = -down * REACH;
    let mut tile = |name: &str, [x0, x1]: [f64; 2], z: f64| {
        builder.quad(name, [[x0, -1.0, z], [x1, -1.0, z], [x1, 1.0, z], [x0, 1.0, z]], grey);
    };
    tile("upper", [-1.0, x], 0.0);
    tile("lower", [-1.0, 1.0], lower);
    builder.light("sun", LightDesc::Directional { direction: [0.0, 0.0, -1.0], irradiance: [1.0; 3] });
    let (point, away) = if below { ([-0.3, 0.0, lower], 0.5 * down * REACH) } else { ([-2e-5, 0.0, 0.0], 2.0) };
    look_at_point(&mut builder, point, [0.0, 0.0, 1.0], away, 1e-5);
    builder.build().unwrap()
}

/// Radiance relative to that of the lit sheet, per pass; passes are independent.
fn shares<T: TestBackend>(scene: &Scene, max_plane_distance: Option<f32>, area: Area, errors: bool) -> Vec<f64> {
    shares_of::<T>(8, scene, max_plane_distance, area, errors)
}

/// The same, of so many passes.
fn shares_of<T: TestBackend>(
    passes: u32,
    scene: &Scene,
    max_plane_distance: Option<f32>,
    area: Area,
    errors: bool,
) -> Vec<f64> {
    let settings = Settings {
        photons: 8_000,
        estimator: Estimator::Radius { radius: Some(REACH) },
        max_plane_distance,
        area,
        errors,
        direct: Direct::Photons,
        indirect: Indirect::None,
        alpha: 1.0,
        seed: 23,
        ..Settings::default()
    };
    per_pass::<T>(scene, &settings, passes, 1).iter().map(|radiance| radiance * 2.0 * PI).collect()
}

/// D6: a surface in the shadow of a sheet is exactly black, and without a plane distance as bright as D5 says. At
/// an edge, half of the light is lost together with the step beyond, whose photons are too far from the plane;
/// dividing by the area on the surface, limited to the same distance, restores it to within the 0.4 % of `area`.
pub fn d6_a_sheet_in_the_shade_is_dark<T: TestBackend>() {
    let scene = sheets(1.0, APART, true);
    for errors in [false, true] {
        assert_eq!(shares::<T>(&scene, Some(SHARE), Area::Disc, errors), vec![0.0; 8]);
        assert_eq!(shares::<T>(&scene, None, Area::Surface, errors), vec![0.0; 8]);
        let lit = shares::<T>(&scene, None, Area::Disc, errors);
        assert_agrees("shade", moments(&lit).0, (1.0 - APART * APART).powi(2), standard_error(&lit), 0.0);
    }
    let step = sheets(0.0, 0.1, false);
    let mended = shares::<T>(&step, Some(0.05), Area::Surface, false);
    assert_agrees("step", moments(&mended).0, 1.0, standard_error(&mended), 4e-3);
    let lost = shares::<T>(&step, Some(0.05), Area::Disc, false);
    assert_agrees("end", moments(&lost).0, 0.5, standard_error(&lost), 1e-3);
}

/// D9: beside the edge of a board or a sheet above, half of the disc is in its shadow. That half is surface too, although probes
/// from above meet the board first. Within solids it is not: a box that stands there instead hides it, and what is left is as
/// bright as all of it.
pub fn d9_a_board_above_hides_no_area<T: TestBackend>() {
    let half = [-0.8, 0.0];
    for (what, [from, to], bottom, truth) in [
        ("board", half, 0.3, 0.5),
        ("sheet", half, APART, 0.5),
        ("box", half, -0.3, 1.0),
        // With floor on both sides.
        ("bar", [-0.6 * REACH, -0.3 * REACH], -0.3, 1.0),
    ] {
        let mut builder = SceneBuilder::new();
        let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
        builder.quad("floor", [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]], grey);
        let (low, high) = (bottom * REACH, APART * REACH);
        if low < high {
            let (positions, triangles) = shapes::cuboid([from, -0.8, low], [to, 0.8, high]);
            builder.mesh(what, positions, triangles, grey);
        } else {
            builder.quad(what, [[from, -0.8, high], [to, -0.8, high], [to, 0.8, high], [from, 0.8, high]], grey);
        }
        builder.light("sun", LightDesc::Directional { direction: [0.0, 0.0, -1.0], irradiance: [1.0; 3] });
        look_at_point(&mut builder, [1e-5, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0, 1e-6);
        // The floor below the bar, if it counts, is a small part of the disc.
        let passes = if what == "bar" { 256 } else { 8 };
        let found = shares_of::<T>(passes, &builder.build().unwrap(), Some(SHARE), Area::Surface, false);
        assert_agrees(what, moments(&found).0, truth, standard_error(&found), 4e-3);
    }
}

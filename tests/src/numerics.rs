//! S and N: extreme inputs and numerical accuracy.

use photon_core::random::{Domain, Sampler, lcg};
use photon_core::{
    Backend, Budget, EnvironmentMap, Error, Estimate, EstimateParams, IndexKind, Photon, Pipeline, RandomKind, Search,
    Settings, View, render,
};
use photon_scene::{LightDesc, MaterialDesc, SceneBuilder, SceneError, shapes};
use std::f64::consts::PI;

use crate::harness::{TestBackend, Uniform, estimate, film, photon_at, query_at, trace, unit};

fn gather(search: Search) -> EstimateParams {
    EstimateParams { min_normal_cosine: 0.7, ..EstimateParams::new(search) }
}

const INDICES: [IndexKind; 3] = [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton];

/// A closed room, rotated so that no wall is axis-aligned, with sides of `scale` metres.
pub(crate) fn turned_room(albedo: f64, scale: f64) -> SceneBuilder {
    turned(albedo, scale, shapes::cuboid([-1.0; 3], [1.0; 3]))
}

/// A drum, rotated likewise, with walls and ends of 512 slivers each.
pub(crate) fn turned_drum(albedo: f64, scale: f64) -> SceneBuilder {
    turned(albedo, scale, shapes::cylinder([0.0, -1.0, 0.0], 1.0, 2.0, 512))
}

/// A wedge of `degrees`, rotated likewise.
pub(crate) fn turned_wedge(degrees: f64, albedo: f64, scale: f64) -> SceneBuilder {
    let (s, c) = degrees.to_radians().sin_cos();
    let profile = [[-1.0, -0.5], [1.0, -0.5], [-1.0 + 2.0 * c, -0.5 + 2.0 * s]];
    let positions = profile.iter().flat_map(|[x, y]| [[*x, *y, -1.0], [*x, *y, 1.0]]).collect();
    let mut triangles = vec![[0, 2, 4], [1, 5, 3]];
    for i in 0..3_u32 {
        let (a, b) = (2 * i, 2 * ((i + 1) % 3));
        triangles.extend([[a, a + 1, b], [b, a + 1, b + 1]]);
    }
    turned(albedo, scale, (positions, triangles))
}

fn turned(albedo: f64, scale: f64, shape: shapes::Shape) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::lambert("wall", [albedo; 3]));
    let (mut positions, triangles) = shapes::flip(shapes::rotate_y(shape, 0.7));
    for p in &mut positions {
        // Also about x.
        let (s, c) = 0.4_f64.sin_cos();
        *p = [p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]].map(|x| x * scale);
    }
    let middle: [f64; 3] = std::array::from_fn(|axis| {
        0.05 * scale + positions.iter().map(|p| p[axis]).sum::<f64>() / positions.len() as f64
    });
    builder.mesh("room", positions, triangles, wall);
    builder.light("light", LightDesc::Point { position: middle, intensity: [scale * scale; 3] });
    builder
}

/// S1: no path leaves a closed room, whatever its size, in a million surface hits in total.
pub fn s1_no_leaks<T: TestBackend>() {
    let mut met = 0;
    for scale in [1e-18, 1e-6, 1.0, 1e6, 1e18] {
        let scene = turned_room(0.99, scale).build().unwrap();
        let (_, tally) = trace::<T>(2, &scene, &Settings { max_bounces: 2000, ..Settings::default() }, &[2500]);
        assert_eq!((tally.escaped, tally.dropped), (0, 0), "scale {scale:e}");
        met += tally.surfaces;
    }
    assert!(met > 1_000_000, "{met}");
}

/// S1 with slivers 200 times as long as wide: a ray that hit the triangle it had just left would end behind it.
/// With the distances of the watertight test alone, 7 of 10⁴ bounces did: about 20 of 30,000.
pub fn s1_no_leaks_through_slivers<T: TestBackend>() {
    let scene = turned_drum(0.99, 1.0).build().unwrap();
    let (_, tally) = trace::<T>(2, &scene, &Settings { max_bounces: 2000, ..Settings::default() }, &[320]);
    assert_eq!((tally.escaped, tally.dropped), (0, 0));
    assert!(tally.surfaces > 25_000, "{}", tally.surfaces);
}

/// S6: a hundred photons at one point, with a query there.
pub fn s6_coincident_photons<T: TestBackend>() {
    for kind in INDICES {
        let photons = vec![photon_at([0.1, 0.2, 0.0]); 100];
        for search in [Search::KNearest { k: 50 }, Search::Radius, Search::Paper { max: 50, threshold: 0, factor: 1.0 }]
        {
            let found = estimate::<T>(kind, &photons, &[query_at([0.1, 0.2, 0.0], 0.01)], &gather(search))[0];
            let value = found.irradiance(1)[0];
            assert!(value.is_finite() && value > 0.0, "{search:?}: {found:?}");
            assert_eq!(found.flags & Estimate::SINGULAR != 0, search != Search::Radius, "{search:?}");
        }
    }
}

/// S7: fewer photons than k: all of them count, over the whole radius.
pub fn s7_fewer_photons_than_k<T: TestBackend>() {
    for count in [0_usize, 1, 49] {
        let photons: Vec<Photon> = (0..count).map(|i| photon_at([i as f32 * 1e-3, 0.0, 0.0])).collect();
        let found =
            estimate::<T>(IndexKind::Median, &photons, &[query_at([0.0; 3], 0.1)], &gather(Search::KNearest { k: 50 }));
        let value = found[0].irradiance(1)[0];
        assert!((value - count as f64 / (PI * 0.01)).abs() < 1e-3 * value.max(1e-9), "{count}: {value}");
    }
}

/// S8: a million photons at one point; collinear ones; all on one axis.
pub fn s8_degenerate_maps<T: TestBackend>() {
    for kind in INDICES {
        let heap = vec![photon_at([0.25; 3]); 1_000_000];
        let found =
            estimate::<T>(kind, &heap, &[query_at([0.25; 3], 0.1), query_at([0.0; 3], 0.1)], &gather(Search::Radius));
        assert_eq!((found[0].photons, found[1].photons), (1_000_000, 0));
        let line: Vec<_> = (0..10_001).map(|i| photon_at([i as f32 / 10_000.0 - 0.5, 0.0, 0.0])).collect();
        let found = estimate::<T>(kind, &line, &[query_at([0.0; 3], 0.1)], &gather(Search::KNearest { k: 101 }));
        assert!((found[0].radius_squared.sqrt() - 0.005).abs() < 1e-6, "{found:?}");
    }
}

/// S9: non-finite input is refused with an error that names it.
pub fn s9_not_finite<T: TestBackend>() {
    for bad in [f32::NAN, f32::INFINITY] {
        for photon in [photon_at([0.0, bad, 0.0]), Photon { power: [bad; 3], ..photon_at([0.0; 3]) }] {
            let mut on = T::make(1);
            let photons = on.upload("photons", &[photon_at([0.0; 3]), photon]).unwrap();
            let mut stages = on.map_stages(IndexKind::Morton).unwrap();
            match stages.builder.build(&mut on, photons) {
                Err(Error::InvalidInput { what: "photon", index: 1, .. }) => {}
                Err(other) => panic!("{other}"),
                Ok(_) => panic!("accepted {photon:?}"),
            }
        }
        let mut builder = turned_room(0.5, 1.0);
        let wall = builder.material(MaterialDesc::lambert("other", [0.5; 3]));
        builder.mesh("bad", vec![[0.0; 3], [f64::from(bad), 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]], wall);
        let error = builder.build().unwrap_err().to_string();
        assert!(error.contains("bad"), "{error}");
    }
}

/// S10 and N1, N2: a million photons of power 1e-6, and a million of power 1, sum accurately.
pub fn s10_n1_many_small_numbers<T: TestBackend>() {
    for power in [1e-6_f32, 1.0] {
        let photons: Vec<_> = (0..1_000_000)
            .map(|i| Photon {
                power: [power; 3],
                ..photon_at([(i % 1000) as f32 * 1e-7, (i / 1000) as f32 * 1e-7, 0.0])
            })
            .collect();
        let found = estimate::<T>(IndexKind::Morton, &photons, &[query_at([0.0; 3], 0.1)], &gather(Search::Radius));
        assert!((f64::from(found[0].flux[0]) / (1e6 * f64::from(power)) - 1.0).abs() < 1e-6, "{found:?}");
    }
}

/// S15: with an albedo of 1 nothing is absorbed: every path ends at the bounce limit, with all its flux.
pub fn s15_albedo_one_ends_at_the_cap<T: TestBackend>() {
    let scene = turned_room(1.0, 1.0).build().unwrap();
    let (_, tally) = trace::<T>(2, &scene, &Settings { max_bounces: 40, ..Settings::default() }, &[2000]);
    assert_eq!((tally.truncated, tally.surfaces), (2000, 2000 * 40));
    assert_eq!(tally.flux_truncated, tally.flux_emitted);
}

/// S17 and S4: brightness and size change the image only by a scale factor.
pub fn s4_s17_scale_and_brightness<T: TestBackend>() {
    let picture = |scale: f64, bright: f64| {
        let mut builder = turned_room(0.5, scale);
        crate::harness::look_at_point(&mut builder, [0.0; 3], [0.0, 0.0, 1.0], 0.5 * scale, 0.2 * scale);
        let mut scaled = SceneBuilder::new();
        std::mem::swap(&mut scaled, &mut builder);
        let material = scaled.material(MaterialDesc::lambert("unused", [0.5; 3]));
        let _ = material;
        scaled.light("second", LightDesc::Point { position: [0.2 * scale, 0.0, 0.0], intensity: [bright; 3] });
        let scene = scaled.build().unwrap();
        let settings = Settings { photons: 4000, ..Settings::default() };
        film::<T>(&scene, &settings, 1, 8)
    };
    let base = picture(1.0, 1.0);
    // Powers of two: identical to the bit.
    let large = picture(2.0_f64.powi(60), 2.0_f64.powi(120));
    assert!(base.pixels == large.pixels);
    assert!((large.units.scale / base.units.scale / 2.0_f64.powi(60) - 1.0).abs() < 1e-12);
    let beauty = picture(1e-15, 1e-30).beauty();
    for (a, b) in base.beauty().iter().flatten().zip(beauty.iter().flatten()) {
        assert!((a - b).abs() <= 1e-2 * a.abs() + 1e-6, "{a} {b}");
    }
}

/// S19: the counter-based random numbers fill squares uniformly (χ² over 16 by 16 cells, 255 degrees of freedom,
/// standard deviation √510) and neighbours are independent (|r| < 4.5/√N); the LCG's first numbers of neighbouring
/// paths have the correlation of −0.5 that is predicted for them.
pub fn s19_random_numbers<T: TestBackend>() {
    let n = 65_536_u32;
    let draw = |kind, path: u32, block: u32| Sampler::new(kind, 11, 0, Domain::Photon, path).words(block);
    let counter = |path, block| draw(RandomKind::Counter, path, block);
    let cell = |word: u32| (word >> 28) as usize;
    type Pair<'a> = &'a dyn Fn(u32) -> (u32, u32);
    let pairs: [Pair<'_>; 4] = [
        &|i| (counter(i, 0)[0], counter(i, 0)[1]),
        &|i| (counter(i, 0)[3], counter(i, 1)[0]),
        &|i| (counter(i, 2)[0], counter(i + 1, 2)[0]),
        &|i| (counter(0, i)[2], counter(1, i)[2]),
    ];
    for pair in pairs {
        let mut cells = [0_u32; 256];
        for i in 0..n {
            let (a, b) = pair(i);
            cells[cell(a) * 16 + cell(b)] += 1;
        }
        let expected = f64::from(n) / 256.0;
        let chi: f64 = cells.iter().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
        assert!((chi - 255.0).abs() < 4.5 * 510.0_f64.sqrt(), "{chi}");
    }
    let correlation = |kind| {
        let value = |path| f64::from(unit(draw(kind, path, 0)[0])) - 0.5;
        let sum: f64 = (0..n).map(|i| value(i) * value(i + 1)).sum();
        sum / f64::from(n) * 12.0
    };
    let bound = 4.5 / f64::from(n).sqrt();
    assert!(correlation(RandomKind::Counter).abs() < bound);
    assert!((correlation(RandomKind::Lcg) + 0.5).abs() < 0.02);
    assert_eq!(lcg(0), 12_345);
}

/// S20: the ends of the unit interval.
pub fn s20_ends_of_the_unit_interval<T: TestBackend>() {
    assert_eq!(unit(0), 0.0);
    assert!(unit(u32::MAX) < 1.0 && unit(u32::MAX) > 0.999_999);
    for (u, v) in [(0.0, 0.0), (unit(u32::MAX), unit(u32::MAX))] {
        for direction in [
            photon_core::sampling::cosine_hemisphere(photon_core::glam::Vec3::NEG_Z, u, v),
            photon_core::sampling::uniform_sphere(u, v),
        ] {
            assert!((direction.length() - 1.0).abs() < 1e-6);
        }
    }
}

/// S27: every index finds the same number of photons as brute force, at each of many random positions.
pub fn s27_neighbour_sets_are_exact<T: TestBackend>() {
    let mut uniform = Uniform::new(5);
    let mut point = || [0; 3].map(|_| uniform.draw() as f32 - 0.5);
    let photons: Vec<_> = (0..3000).map(|_| photon_at(point())).collect();
    let queries: Vec<_> = (0..500).map(|_| query_at(point(), 0.2)).collect();
    for kind in INDICES {
        let nearest = estimate::<T>(kind, &photons, &queries, &gather(Search::KNearest { k: 20 }));
        let within = estimate::<T>(kind, &photons, &queries, &gather(Search::Radius));
        for ((query, nearest), within) in queries.iter().zip(nearest).zip(within) {
            let mut squares: Vec<f32> = photons
                .iter()
                .map(|photon| {
                    let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| photon.position[axis] - query.position[axis]);
                    x * x + y * y + z * z
                })
                .collect();
            squares.sort_unstable_by(f32::total_cmp);
            let radius: f32 = 0.2;
            let inside = squares.partition_point(|&square| square <= radius * radius);
            assert_eq!(within.photons as usize, inside);
            let expected = if inside >= 20 { squares[19] } else { radius * radius };
            assert_eq!(nearest.radius_squared, expected, "{kind:?}");
        }
    }
}

/// S29: a scene without lights or without receivers is refused with an error that names it; so are invalid
/// settings.
pub fn s29_nothing_to_render<T: TestBackend>() {
    let start = |builder: SceneBuilder, settings: Settings, size: u32| -> Result<(), Box<dyn std::error::Error>> {
        let scene = builder.build()?;
        let view = View { camera: scene.camera(None, size, size)?, width: size, height: size };
        let mut renderer = Pipeline::new(T::make(1), &scene.view(), view, settings)?;
        render(&mut renderer, Budget::passes(1), &mut ())?;
        Ok(())
    };
    let with = |albedo: f64, intensity: f64| {
        let mut builder = SceneBuilder::new();
        let wall = builder.material(MaterialDesc::lambert("wall", [albedo; 3]));
        builder.quad("wall", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], wall);
        builder.light("light", LightDesc::Point { position: [0.0, 1.0, 0.0], intensity: [intensity; 3] });
        crate::harness::look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.5);
        builder
    };
    let small = Settings { photons: 100, ..Settings::default() };
    start(with(0.5, 1.0), small.clone(), 4).unwrap();
    let dark = start(with(0.5, 0.0), small.clone(), 4).unwrap_err();
    assert!(matches!(dark.downcast_ref(), Some(Error::NoLight)), "{dark}");
    // Of a black environment map too, whatever its shape.
    for (width, texels) in [(1, 1), (8, 32)] {
        let mut builder = with(0.5, 0.0);
        builder.environment(EnvironmentMap::new(width, &vec![[0.0; 3]; texels], 0.0).unwrap());
        let dark = start(builder, small.clone(), 4).unwrap_err();
        assert!(matches!(dark.downcast_ref(), Some(Error::NoLight)), "{dark}");
    }
    let mut empty = SceneBuilder::new();
    empty.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
    crate::harness::look_at_point(&mut empty, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.5);
    let empty = start(empty, small.clone(), 4).unwrap_err();
    assert!(matches!(empty.downcast_ref(), Some(Error::NoTriangles)), "{empty}");
    let black = start(with(0.0, 1.0), small.clone(), 4).unwrap_err();
    assert!(matches!(black.downcast_ref(), Some(Error::NoReceiver)), "{black}");
    assert!(start(with(0.5, 1.0), Settings { photons: 0, ..small.clone() }, 4).is_err());
    assert!(start(with(0.5, 1.0), small.clone(), 0).is_err());
    let mut flat = with(0.5, 1.0);
    let area_light = flat.material(MaterialDesc::emissive("strip", [0.0; 3], [1.0; 3]));
    flat.mesh("strip", vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], vec![[0, 1, 2]], area_light);
    let error = flat.build().unwrap_err();
    assert!(matches!(error, SceneError::ZeroAreaLight { .. }), "{error}");
}

/// S30: one photon and one pixel.
pub fn s30_least_of_everything<T: TestBackend>() {
    let mut builder = turned_room(0.5, 1.0);
    crate::harness::look_at_point(&mut builder, [0.0; 3], [0.0, 0.0, 1.0], 0.1, 0.1);
    let scene = builder.build().unwrap();
    let film = film::<T>(&scene, &Settings { photons: 1, ..Settings::default() }, 1, 1);
    assert_eq!(film.pixels.len(), 1);
    assert!(film.beauty()[0].iter().all(|c| c.is_finite()));
}

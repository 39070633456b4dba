//! Glossy surfaces: GGX metals, and diffuse bases under GGX coats.

use std::f64::consts::{PI, TAU};

use photon_core::glam::DVec3;
use photon_core::{Direct, EnvironmentMap, Estimator, Filter, Indirect, Settings};
use photon_scene::{
    CameraDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, Surface, TextureDesc, TextureRef, TexturesDesc,
    VertexAttributes,
};

use crate::gloss_reference::Reference;
use crate::harness::{TestBackend, direct_settings, look_at_point, per_pass, trace};
use crate::stats::{assert_agrees, moments, standard_error};

fn settings(direct: Direct, indirect: Indirect) -> Settings {
    Settings { indirect, ..direct_settings(direct, 0.1) }
}

/// A plate of half side 1 at y = 0, seen in direction −`o` through a tiny square about the origin.
fn plate(material: MaterialDesc, o: DVec3) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let material = builder.material(material);
    let corners = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
    builder.quad("plate", corners, material);
    let projection = Projection::Orthographic { half_height: 1e-4 };
    builder.camera("oblique", CameraDesc::new((o * 0.5).to_array(), (-o).to_array(), [0.0, 0.0, 1.0], projection));
    builder
}

fn towards(cosine: f64, azimuth: f64) -> DVec3 {
    let sine = (1.0 - cosine * cosine).sqrt();
    DVec3::new(sine * azimuth.cos(), cosine, sine * azimuth.sin())
}

/// G4: in an even environment of radiance 1, white metal, white plastic and mixtures of both show 1 at any roughness, by
/// shadow rays and with the light on the base by photons. The tables allow 2.5e-3.
pub fn g4_white_furnace<T: TestBackend>() {
    let materials =
        [(0.035, 1.0, 0.9), (0.5, 1.0, 0.3), (1.0, 1.0, 0.8), (0.3, 0.0, 0.2), (1.0, 0.0, 0.95), (0.6, 0.5, 0.3)];
    for (roughness, metallic, cosine) in materials {
        let surface = Surface::Glossy { base_color: [1.0; 3], metallic, roughness, specular: 1.0, ior: 1.5 };
        let mut builder = plate(MaterialDesc::new("white", surface), towards(cosine, 0.4));
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        let scene = builder.build().unwrap();
        for direct in [Direct::Nee, Direct::Photons] {
            if direct == Direct::Photons && metallic == 1.0 {
                continue;
            }
            let values = per_pass::<T>(&scene, &settings(direct, Indirect::None), 16, 8);
            let what = format!("roughness {roughness}, metallic {metallic}, cosine {cosine}, {direct:?}");
            assert_agrees(&what, moments(&values).0, 1.0, standard_error(&values), 2.5e-3);
        }
    }
}

/// The highlight of a point light is the BSDF times the irradiance, without noise.
pub fn highlights_of_a_point_light<T: TestBackend>() {
    for (alpha, metallic, color, cosine, azimuth) in [
        (0.02, 1.0, 0.7, 0.8, PI),
        (0.25, 1.0, 0.9, 0.5, 2.9),
        (1.0, 1.0, 0.5, 0.9, 1.0),
        (0.1, 0.0, 0.6, 0.8, PI),
        (0.5, 0.3, 0.8, 0.6, 2.0),
    ] {
        let reference = Reference::new(alpha, metallic, color);
        let o = towards(0.8, 0.0);
        let i = towards(cosine, azimuth);
        let mut builder = plate(reference.material(), o);
        builder.light("point", LightDesc::Point { position: (i * 1.5).to_array(), intensity: [2.0; 3] });
        let scene = builder.build().unwrap();
        let values = per_pass::<T>(&scene, &settings(Direct::Nee, Indirect::None), 2, 2);
        let truth = reference.f(o, i) * cosine * 2.0 / (1.5 * 1.5);
        let what = format!("alpha {alpha}, metallic {metallic}, cosine {cosine}");
        // The tables add an absolute error to multiple scattering, which is all there is far from a narrow peak.
        assert_agrees(&what, values[0], truth, 0.0, 3e-3 * truth + 2e-5);
    }
}

/// Reflections of a square light of radiance 3, small and large: sampled lights and sampled reflections together, against a
/// quadrature over the light.
pub fn reflections_of_an_area_light<T: TestBackend>() {
    for (alpha, metallic, half) in
        [(0.01, 1.0, 0.05), (0.01, 1.0, 0.6), (0.2, 1.0, 0.05), (0.2, 1.0, 0.6), (1.0, 1.0, 0.6), (0.2, 0.0, 0.3)]
    {
        let reference = Reference::new(alpha, metallic, 0.8);
        let o = towards(0.7, 0.0);
        let mirrored = DVec3::new(-o.x, o.y, o.z);
        let centre = mirrored * 1.2;
        let (across, up) = (DVec3::Z * half, mirrored.cross(DVec3::Z) * half);
        let mut builder = plate(reference.material(), o);
        let light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [3.0; 3]).with_both_sides(true));
        let corner = |a: f64, b: f64| (centre + across * a + up * b).to_array();
        builder.quad("light", [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], light);
        let scene = builder.build().unwrap();
        let n = 400;
        let truth: f64 = (0..n * n)
            .map(|k| {
                let part = |k: i32| (f64::from(k) + 0.5) / f64::from(n) * 2.0 - 1.0;
                let gap = centre + across * part(k % n) + up * part(k / n);
                let i = gap.normalize_or_zero();
                let area = 4.0 * half * half / f64::from(n * n);
                reference.f(o, i) * i.y * 3.0 * i.dot(mirrored) / gap.length_squared() * area
            })
            .sum();
        let values = per_pass::<T>(&scene, &settings(Direct::Nee, Indirect::None), 32, 8);
        let what = format!("alpha {alpha}, metallic {metallic}, half side {half}");
        assert_agrees(&what, moments(&values).0, truth, standard_error(&values), 3e-3 * truth);
    }
}

/// A texture of the specular factor: each half of a plate looks as with the factor of its texel everywhere, by shadow rays
/// and by photons, whose power has the coat's factor.
pub fn textured_specular_factor<T: TestBackend>() {
    for (direct, metallic) in [(Direct::Nee, 0.0), (Direct::Nee, 0.5), (Direct::Photons, 0.0)] {
        let look = |x: f64, specular: Option<f64>| {
            let mut builder = SceneBuilder::new();
            let surface = Surface::Glossy {
                base_color: [0.3; 3],
                metallic,
                roughness: 0.4,
                specular: specular.unwrap_or(1.0),
                ior: 2.0,
            };
            let image =
                TextureDesc::srgb8("halves", 2, 1, &[[9, 9, 9, 51], [200, 9, 9, 204]]).filtered(Filter::Nearest);
            let mut textures = TexturesDesc::default();
            textures.specular = specular.is_none().then(|| TextureRef::new(builder.texture(image)));
            let material = builder.material(MaterialDesc::new("plate", surface).with_textures(textures));
            let positions = vec![[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
            let uvs = positions.iter().map(|p: &[f64; 3]| [0.5 * p[0] + 0.5, 0.5]).collect();
            let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
            builder.mesh_with("plate", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
            builder.light("point", LightDesc::Point { position: [x + 0.3, 0.8, 0.0], intensity: [1.0; 3] });
            look_at_point(&mut builder, [x, 0.0, 0.0], [0.0, 1.0, 0.0], 0.5, 1e-4);
            per_pass::<T>(&builder.build().unwrap(), &settings(direct, Indirect::None), 4, 2)
        };
        for (x, factor) in [(-0.5, 0.2), (0.5, 0.8)] {
            let (found, expected) = (look(x, None), look(x, Some(factor)));
            let mean = moments(&expected).0;
            for (found, expected) in found.into_iter().zip(expected) {
                assert_agrees(
                    &format!("{direct:?}, metallic {metallic}, factor {factor}"),
                    found,
                    expected,
                    0.0,
                    1e-5 * mean,
                );
            }
            let other = moments(&look(x, Some(1.0 - factor))).0;
            assert!((other / mean - 1.0).abs() > 0.01, "the factor shows: {mean} {other}");
        }
    }
}

/// Photons that a glossy plate reflects to a diffuse one: a point light above the glossy plate, hidden from the other by
/// a black screen. The irradiance there is a quadrature over the glossy plate.
pub fn caustics_of_a_glossy_plate<T: TestBackend>() {
    for (alpha, metallic) in [(0.3, 1.0), (1.0, 1.0)] {
        let reference = Reference::new(alpha, metallic, 0.8);
        let mut builder = SceneBuilder::new();
        let glossy = builder.material(reference.material());
        let white = builder.material(MaterialDesc::lambert("white", [1.0; 3]));
        let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
        builder.quad("plate", [[-0.5, 0.0, 0.5], [0.5, 0.0, 0.5], [0.5, 0.0, -0.5], [-0.5, 0.0, -0.5]], glossy);
        // Faces −x.
        builder.quad("wall", [[1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [1.0, 1.5, 1.0], [1.0, 1.5, -1.0]], white);
        builder.quad("screen", [[0.55, 0.9, -1.0], [0.55, 0.9, 1.0], [0.55, 2.0, 1.0], [0.55, 2.0, -1.0]], black);
        let light = DVec3::new(-0.4, 1.4, 0.0);
        builder.light("point", LightDesc::Point { position: light.to_array(), intensity: [1.0; 3] });
        let point = DVec3::new(1.0, 0.5, 0.0);
        look_at_point(&mut builder, point.to_array(), [-1.0, 0.0, 0.0], 0.2, 0.02);
        let scene = builder.build().unwrap();
        let n = 300;
        let truth: f64 = (0..n * n)
            .map(|k| {
                let part = |k: i32| (f64::from(k) + 0.5) / f64::from(n) - 0.5;
                let p = DVec3::new(part(k % n), 0.0, part(k / n));
                let (to_light, to_wall) = (light - p, point - p);
                let (i, o) = (to_light.normalize_or_zero(), to_wall.normalize_or_zero());
                let radiance = reference.f(o, i) * i.y / to_light.length_squared();
                radiance * o.y * o.x / to_wall.length_squared() / f64::from(n * n)
            })
            .sum::<f64>()
            / PI;
        let mut settings = settings(Direct::None, Indirect::None);
        settings.estimator = Estimator::Radius { radius: Some(0.04) };
        settings.photons = 60_000;
        let values = per_pass::<T>(&scene, &settings, 24, 4);
        // The estimate is the mean over a disc of radius .04, where the irradiance is nearly linear.
        let what = format!("alpha {alpha}, metallic {metallic}");
        assert_agrees(&what, moments(&values).0, truth, standard_error(&values), 5e-3 * truth);
    }
}

/// G5: in a closed room with an emitting floor of albedo ½ and radiance 1, and walls that absorb nothing, radiance is 2 in
/// all directions, so that each wall receives 2π watts per area, whatever is stored there.
pub fn g5_closed_room<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let floor = builder.material(MaterialDesc::emissive("floor", [0.5; 3], [1.0; 3]));
    let white = |roughness: f64, metallic: f64| {
        MaterialDesc::new(
            "white",
            Surface::Glossy { base_color: [1.0; 3], metallic, roughness, specular: 1.0, ior: 1.5 },
        )
    };
    let metal = builder.material(white(0.4, 1.0));
    let rough = builder.material(white(1.0, 1.0));
    let plastic = builder.material(white(0.3, 0.0));
    let mixed = builder.material(white(0.8, 0.5));
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|bit| bit as f64 - 0.5);
    // Counter-clockwise as seen from inside: floor, ceiling, then the walls at −x, +x, −z, +z.
    let sides = [
        ([0, 4, 5, 1], floor),
        ([2, 3, 7, 6], plastic),
        ([0, 2, 6, 4], metal),
        ([1, 5, 7, 3], mixed),
        ([0, 1, 3, 2], plastic),
        ([4, 6, 7, 5], rough),
    ];
    for (corners, material) in sides {
        builder.quad("side", corners.map(corner), material);
    }
    look_at_point(&mut builder, [-0.5, 0.1, 0.1], [1.0, 0.0, 0.0], 0.4, 0.05);
    let scene = builder.build().unwrap();
    let mut settings = settings(Direct::Photons, Indirect::Map);
    settings.max_bounces = 512;
    let groups = 24;
    let paths = 2000;
    let mut walls = vec![Vec::new(); 4];
    for seed in 0..groups {
        let (photons, tally) = trace::<T>(2, &scene, &photon_core::Settings { seed, ..settings.clone() }, &[paths]);
        let mut sums = [0.0; 4];
        for photon in photons.iter().flat_map(|(_, photons)| photons) {
            let normal = photon_core::octahedral::unpack(photon.normal);
            let wall = match normal.round().to_array() {
                [0.0, 1.0, 0.0] => 0,
                [0.0, -1.0, 0.0] => 1,
                [-1.0, 0.0, 0.0] => 2,
                [0.0, 0.0, 1.0] => 3,
                _ => continue,
            };
            sums[wall] += f64::from(photon.power[0]);
        }
        assert_eq!(tally.emitted, u64::from(paths));
        for (wall, sum) in walls.iter_mut().zip(sums) {
            wall.push(sum / f64::from(paths) * scene.units().power);
        }
    }
    for (name, values) in ["floor", "plastic ceiling", "mixed wall", "plastic wall"].iter().zip(&walls) {
        assert_agrees(name, moments(values).0, TAU, standard_error(values), 4e-3 * TAU);
    }
}

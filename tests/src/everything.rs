//! V16: a scene with all kinds of surfaces and lights gives the same bits in any size that is a power of two, on any number of
//! threads, and for requirements that include more than it needs.

use photon_core::{
    CausticPhotons, EnvironmentMap, Features, Film, MapKind, PerMap, Photon, Pipeline, Render, Requirements, Settings,
    View,
};
use photon_scene::{
    AlphaMode, CameraDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Surface, TextureDesc, TextureRef,
    TexturesDesc, VertexAttributes, shapes,
};

use crate::harness::{TestBackend, film, trace};

/// Texture coordinates across a square.
const UVS: [[f64; 2]; 4] = [[0.0, 1.0], [2.0, 1.0], [2.0, 0.0], [0.0, 0.0]];

fn images(builder: &mut SceneBuilder) -> [TextureRef; 4] {
    let texels = |of: fn(u32) -> [u8; 4]| (0..16).map(of).collect::<Vec<_>>();
    let colors = texels(|k| [(60 + 12 * k) as u8, 200, (250 - 14 * k) as u8, 255]);
    let bumps = texels(|k| [(100 + 3 * k) as u8, (150 - 3 * k) as u8, 240, 255]);
    let rough = texels(|k| [0, (60 + 12 * k) as u8, (k % 2 * 255) as u8, 255]);
    let holes = texels(|k| [200, 180, 90, (17 * k) as u8]);
    [
        TextureDesc::srgb8("colours", 4, 4, &colors),
        TextureDesc::linear8("bumps", 4, 4, &bumps),
        TextureDesc::linear8("roughness", 4, 4, &rough),
        TextureDesc::srgb8("holes", 4, 4, &holes),
    ]
    .map(|image| TextureRef::new(builder.texture(image)))
}

/// Textured gloss with a normal map, leaves with holes and without, balls with vertex normals, rough glass, a textured light,
/// an environment, and 25 point lights, more than are chosen without a tree. Lengths are `size` times as large and radiances
/// the same.
fn scene(size: f64) -> Scene {
    let mut builder = SceneBuilder::new();
    let [colors, bumps, rough, holes] = images(&mut builder);
    let uvs = || VertexAttributes::default().with_uvs(vec![UVS.to_vec()]);
    let quad = |builder: &mut SceneBuilder, corners: [[f64; 3]; 4], material: MaterialDesc| {
        let material = builder.material(material);
        let positions = corners.iter().map(|p| p.map(|x| x * size)).collect();
        builder.mesh_with("quad", positions, vec![[0, 1, 2], [0, 2, 3]], uvs(), material);
    };
    let all = TexturesDesc::default().with_base_color(colors).with_normal(bumps).with_metallic_roughness(rough);
    let floor = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
    quad(&mut builder, floor, MaterialDesc::plastic("floor", [0.9; 3], 1.0).with_textures(all));
    let wall = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 1.4, -1.0], [-1.0, 1.4, -1.0]];
    let painted = TexturesDesc::default().with_base_color(colors);
    quad(&mut builder, wall, MaterialDesc::lambert("wall", [0.8; 3]).with_textures(painted));
    let covered = TexturesDesc::default().with_base_color(holes).with_alpha(holes);
    for (y, mode) in [(0.5, AlphaMode::Blend), (0.6, AlphaMode::Mask { cutoff: 0.5 })] {
        let leaf = [[-0.6, y, 0.5], [0.1, y, 0.5], [0.1, y, -0.4], [-0.6, y, -0.4]];
        let paint = MaterialDesc::lambert("leaf", [0.9; 3]).with_textures(covered.clone()).with_alpha(mode, 1.0);
        quad(&mut builder, leaf, paint);
    }
    let shining = TexturesDesc::default().with_emission(colors);
    let lamp = [[0.2, 1.3, -0.3], [0.7, 1.3, -0.3], [0.7, 1.3, 0.3], [0.2, 1.3, 0.3]];
    quad(&mut builder, lamp, MaterialDesc::emissive("lamp", [0.0; 3], [3.0, 2.5, 2.0]).with_textures(shining));
    let glass = Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [0.9, 1.0, 0.9], roughness: 0.4 };
    for (centre, radius, material) in [
        ([0.5, 0.3, 0.3], 0.25, MaterialDesc::metal("metal", [0.9, 0.7, 0.4], 0.5)),
        ([0.45, 0.3, -0.4], 0.25, MaterialDesc::new("frosted", glass)),
        ([-0.4, 0.22, 0.3], 0.2, MaterialDesc::glass("glass", 1.5)),
    ] {
        let (positions, triangles) = shapes::icosphere(2, centre, radius);
        let normals = positions.iter().map(|p| [0, 1, 2].map(|axis| p[axis] - centre[axis])).collect();
        let positions = positions.iter().map(|p| p.map(|x| x * size)).collect();
        let material = builder.material(material);
        builder.mesh_with("ball", positions, triangles, VertexAttributes::default().with_normals(normals), material);
    }
    for k in 0..25 {
        let position = [f64::from(k % 5) * 0.3 - 0.6, 1.1, f64::from(k / 5) * 0.3 - 0.6].map(|x| x * size);
        let intensity = [0.01 * f64::from(1 + k % 4) * size * size; 3];
        builder.light("bulb", LightDesc::Point { position, intensity });
    }
    let sky: Vec<[f32; 3]> = (0..32).map(|k| [0.1 + 0.02 * k as f32, 0.3, 0.6 - 0.015 * k as f32]).collect();
    builder.environment(EnvironmentMap::new(8, &sky, 0.25).unwrap());
    let projection = Projection::Perspective { vertical_fov: 0.9 };
    let position = [0.1, 1.0, 2.4].map(|x| x * size);
    builder.camera("front", CameraDesc::new(position, [-0.05, -0.25, -1.0], [0.0, 1.0, 0.0], projection));
    builder.build().unwrap()
}

fn settings() -> Settings {
    let caustic_photons = CausticPhotons::Aimed(1500);
    Settings { photons: 3000, caustic_photons, caustic_roughness: Some(0.6), seed: 6, ..Settings::default() }
}

fn found<T: TestBackend>(scene: &Scene) -> (PerMap<Vec<Photon>>, Film) {
    (trace::<T>(2, scene, &settings(), &[3000]).0, film::<T>(scene, &settings(), 2, 16))
}

/// Sizes of 2^±60 and 2^99: the photons and the picture are the same bit by bit. 10^±30 rounds positions otherwise, so that
/// photons may meet another triangle: the mean of the picture is the same.
pub fn v16_sizes<T: TestBackend>() {
    let (photons, picture) = found::<T>(&scene(1.0));
    assert!(MapKind::ALL.into_iter().all(|kind| photons[kind].len() > 20));
    for size in [2.0_f64.powi(-60), 2.0_f64.powi(60), 2.0_f64.powi(99)] {
        let (others, other) = found::<T>(&scene(size));
        assert!(MapKind::ALL.into_iter().all(|kind| photons[kind] == others[kind]), "{size:e}");
        assert!(picture.pixels == other.pixels, "{size:e}");
    }
    // Of numbers that are no powers of two, some bits differ.
    let mean = |film: &Film| film.beauty().iter().flatten().map(|&c| f64::from(c)).sum::<f64>();
    for size in [1e-30, 1e30] {
        let other = film::<T>(&scene(size), &settings(), 2, 16);
        assert!(picture.pixels != other.pixels, "{size:e}");
        let apart = mean(&other) / mean(&picture) - 1.0;
        assert!(apart.abs() < 2e-3, "{size:e}: {apart}");
    }
}

/// One, two and seven threads, and all features.
pub fn v16_threads_and_requirements<T: TestBackend>() {
    let scene = scene(1.0);
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let derived = Requirements::of(&scene.view(), &settings());
    let needed = [
        Features::TEXTURES,
        Features::ALPHA,
        Features::SHADING_NORMALS,
        Features::ENVIRONMENT,
        Features::LIGHT_TREE,
        Features::GLOSSY,
        Features::ROUGH_GLASS,
    ];
    assert!(needed.into_iter().all(|feature| derived.features.contains(feature)), "{:?}", derived.features);
    let picture = |threads: usize, required: Requirements| {
        let mut renderer =
            Pipeline::with_requirements(T::make(threads), &scene.view(), view, settings(), required).unwrap();
        for pass in 0..2 {
            renderer.pass(pass, &mut ()).unwrap();
        }
        renderer.film().unwrap().pixels
    };
    let photons = |threads: usize| trace::<T>(threads, &scene, &settings(), &[3000]);
    let (pixels, traced) = (picture(1, derived), photons(1));
    assert!(pixels == picture(1, Requirements::everything(&settings())));
    for threads in [2, 7] {
        assert!(pixels == picture(threads, derived), "{threads}");
        assert!(traced == photons(threads), "{threads}");
    }
}

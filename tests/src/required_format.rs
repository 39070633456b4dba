//! Photon formats of maps: the required format, and the same image as with full photons.

use photon_core::{
    Backend, Budget, CausticPhotons, Direct, Error, ErrorPixel, EstimateParams, Estimator, FilmPixel, IndexKind,
    Indirect, Kernel, MapKind, Paper, Photon, PhotonFormat, Pipeline, Render, Requirements, Search, Settings,
    TransportBackend, View, render,
};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, Surface, shapes};

use crate::harness::{TestBackend, look_at_point, query_at};

/// Capacity of a map in photons; the paths can hit this many surfaces and more.
const CAPACITY: u64 = 7_500;

/// A grey room with a ball of absorbing glass and a mirror ball, lit by an area light and a point light; the
/// property named by `which` is coloured.
fn room(which: Option<&str>) -> Scene {
    let of = |name: &str, value: f64| if which == Some(name) { [value, value, 0.5 * value] } else { [value; 3] };
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::lambert("wall", of("wall", 0.6)));
    let (positions, triangles) = shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3]));
    builder.mesh("room", positions, triangles, wall);
    let glass =
        Surface::Dielectric { ior: 1.5, absorption: of("absorption", 0.5), tint: of("tint", 1.0), roughness: 0.0 };
    let glass = builder.material(MaterialDesc::new("glass", glass));
    let mirror = builder.material(MaterialDesc::mirror("mirror", of("mirror", 0.9)));
    for (x, material) in [(-0.5, glass), (0.5, mirror)] {
        let (positions, triangles) = shapes::icosphere(1, [x, -0.6, 0.0], 0.3);
        builder.mesh("ball", positions, triangles, material);
    }
    let area_light = builder.material(MaterialDesc::emissive("light", [0.0; 3], of("light", 1.0)));
    let (y, h) = (0.9, 0.3);
    builder.quad("light", [[-h, y, -h], [h, y, -h], [h, y, h], [-h, y, h]], area_light);
    builder.light("bulb", LightDesc::Point { position: [0.1, 0.3, 0.2], intensity: of("bulb", 0.1) });
    // A material that no surface uses does not count.
    builder.material(MaterialDesc::lambert("unused", [0.1, 0.2, 0.3]));
    look_at_point(&mut builder, [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], 0.05, 0.8);
    builder.build().unwrap()
}

fn settings() -> Settings {
    Settings {
        photons: 1500,
        photon_capacity: Some(CAPACITY),
        max_bounces: 6,
        direct: Direct::Photons,
        caustic_photons: CausticPhotons::Aimed(500),
        estimator: Estimator::Radius { radius: Some(0.2) },
        gather_rays: 2,
        ..Settings::default()
    }
}

/// Renders an image; returns its pixels, error statistics and memory report, and the backend.
fn picture<B: TransportBackend>(
    on: B,
    scene: &Scene,
    settings: &Settings,
    photon_format: PhotonFormat,
) -> Result<(Picture, B), Error> {
    let view = View { camera: scene.camera(None, 12, 12).unwrap(), width: 12, height: 12 };
    let mut required = Requirements::of(&scene.view(), settings);
    required.photon_format = photon_format;
    let mut renderer = Pipeline::with_requirements(on, &scene.view(), view, settings.clone(), required)?;
    render(&mut renderer, Budget::passes(2), &mut ())?;
    let facts = renderer.facts();
    assert_eq!(facts.required.photon_format, photon_format);
    let film = renderer.film()?;
    Ok(((film.pixels, film.errors, facts.memory), renderer.into_backend()?))
}

type Picture = (Vec<FilmPixel>, Option<Vec<ErrorPixel>>, Vec<(String, u64)>);

/// Every coloured property is detected, whatever it is.
pub fn m1_grey_is_what_treats_channels_alike<T: TestBackend>() {
    let photon_format = |which| Requirements::of(&room(which).view(), &settings()).photon_format;
    assert_eq!(photon_format(None), PhotonFormat::Mono);
    for which in ["wall", "absorption", "tint", "mirror", "light", "bulb"] {
        assert_eq!(photon_format(Some(which)), PhotonFormat::NoDirection, "{which}");
    }
    let paper = Settings { estimator: Estimator::Paper(Paper::default()), ..settings() };
    assert_eq!(Requirements::of(&room(None).view(), &paper).photon_format, PhotonFormat::Full);
}

/// For every way in which maps are built and read, with mono and RGB powers in turn: the same bits as with full
/// photons, in exactly the stated number of bytes.
pub fn m2_less_is_the_same_picture<T: TestBackend>() {
    let radius = settings();
    let knn = Estimator::Knn { k: 12, max_radius: Some(0.4) };
    let gather = Indirect::Gather;
    // Caustic maps filled by ordinary paths, beside those filled by aimed paths.
    let shared = Settings { caustic_photons: CausticPhotons::Shared, ..settings() };
    let ways = [
        radius.clone(),
        Settings { index: IndexKind::Median, estimator: knn, kernel: Kernel::Constant, ..shared.clone() },
        Settings {
            index: IndexKind::Vvh,
            errors: true,
            estimator: Estimator::Radius { radius: None },
            ..shared.clone()
        },
        Settings { indirect: gather, ..settings() },
        Settings { indirect: gather, irradiance_every: Some(4), ..shared },
    ];
    // A new backend per image would compile its kernels again.
    let mut on = T::make(2);
    for (number, way) in ways.iter().enumerate() {
        let (scene, least) = if number % 2 == 0 {
            (room(None), PhotonFormat::Mono)
        } else {
            (room(Some("wall")), PhotonFormat::NoDirection)
        };
        assert_eq!(Requirements::of(&scene.view(), way).photon_format, least);
        let (whole, back) = picture(on, &scene, way, PhotonFormat::Full).unwrap();
        let (short, back) = picture(back, &scene, way, least).unwrap();
        on = back;
        assert!(short.0 == whole.0 && short.1 == whole.1, "way {number}");
        for map in MapKind::ALL.map(MapKind::name) {
            let bytes = |of: &Picture, label: &str| {
                let line = of.2.iter().find(|(known, _)| known == label);
                line.map(|(_, bytes)| *bytes).unwrap()
            };
            let stored = format!("photons: {map}");
            assert_eq!(bytes(&short, &stored), CAPACITY * least.bytes(), "way {number}, {map}");
            assert_eq!(bytes(&whole, &stored), CAPACITY * 32);
            // Also for the map's search structures.
            let arranged = format!("map of {stored}");
            assert!(bytes(&short, &arranged) < bytes(&whole, &arranged), "way {number}, {map}");
        }
    }
}

/// A format with less than what is read is refused, wherever it is requested.
pub fn m3_too_little_is_refused<T: TestBackend>() {
    let refused = |error: &Error| matches!(error, Error::InvalidSetting { .. });
    let coloured = room(Some("wall"));
    assert!(picture(T::make(2), &coloured, &settings(), PhotonFormat::Mono).is_err_and(|error| refused(&error)));
    let paper = Settings { estimator: Estimator::Paper(Paper::default()), ..settings() };
    assert!(picture(T::make(2), &room(None), &paper, PhotonFormat::NoDirection).is_err_and(|error| refused(&error)));

    let mut on = T::make(1);
    for photon_format in [PhotonFormat::Mono, PhotonFormat::NoDirection] {
        let photons = on.alloc_photons("photons", 10, photon_format).unwrap();
        let mut whole = Vec::<Photon>::new();
        assert!(on.download(&photons, &mut whole).is_err_and(|error| refused(&error)), "{photon_format:?}");
        let mut stages = on.map_stages(IndexKind::Morton).unwrap();
        let map = stages.builder.build(&mut on, photons).unwrap();
        let queries = on.upload("queries", &[query_at([0.0; 3], 1.0)]).unwrap();
        let mut estimates = on.alloc("estimates", 1).unwrap();
        let mut ask = |search| {
            let gather = EstimateParams { min_normal_cosine: 0.5, ..EstimateParams::new(search) };
            stages.estimator.estimate(&mut on, &map, &queries, &gather, &mut estimates)
        };
        assert!(ask(Search::Radius).is_ok(), "{photon_format:?}");
        let paper = Search::Paper { max: 4, threshold: 1, factor: 1.0 };
        assert!(ask(paper).is_err_and(|error| refused(&error)), "{photon_format:?}");
    }
}

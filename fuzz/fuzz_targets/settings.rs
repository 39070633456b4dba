//! Any settings: rejected with the name of the setting, or a picture of finite numbers.
#![no_main]

use photon_core::{
    Area, Bandwidth, CausticPhotons, Direct, Estimator, IndexKind, Indirect, Kernel, Paper, RandomKind, Scheduling,
    Settings,
};

/// Takes numbers off the front of the input; zeros when it is exhausted.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut out = [0; N];
        let count = N.min(self.0.len());
        out[..count].copy_from_slice(&self.0[..count]);
        self.0 = &self.0[count..];
        out
    }

    fn byte(&mut self) -> u8 {
        self.take::<1>()[0]
    }

    fn any(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    fn narrow(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    fn perhaps<T>(&mut self, of: impl FnOnce(&mut Self) -> T) -> Option<T> {
        (self.byte() & 1 == 1).then(|| of(self))
    }
}

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let mut from = Bytes(data);
    let scene = from.byte();
    let estimator = match from.byte() % 3 {
        0 => Estimator::Radius { radius: from.perhaps(Bytes::any) },
        1 => Estimator::Knn { k: u32::from_le_bytes(from.take()), max_radius: from.perhaps(Bytes::any) },
        _ => Estimator::Paper(Paper {
            max: u32::from_le_bytes(from.take()),
            radius: from.perhaps(Bytes::any),
            threshold: u32::from_le_bytes(from.take()),
            factor: from.narrow(),
            clamp: true,
        }),
    };
    let kernel = [Kernel::Constant, Kernel::Epanechnikov][usize::from(from.byte() % 2)];
    let settings = Settings {
        // Small numbers, so that requested work is not mistaken for a hang.
        photons: u32::from(from.byte()),
        camera_samples: u32::from(from.byte() % 4),
        shadow_rays: u32::from(from.byte() % 8),
        gather_rays: u32::from(from.byte() % 8),
        max_bounces: u32::from(from.byte()),
        estimator,
        kernel,
        index: [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton][usize::from(from.byte() % 3)],
        direct: [Direct::Nee, Direct::Photons, Direct::None][usize::from(from.byte() % 3)],
        indirect: [Indirect::Map, Indirect::Gather, Indirect::None][usize::from(from.byte() % 3)],
        random: [RandomKind::Counter, RandomKind::Lcg][usize::from(from.byte() % 2)],
        scheduling: [Scheduling::Static, Scheduling::Dynamic][usize::from(from.byte() % 2)],
        caustics: from.byte() & 1 == 1,
        errors: from.byte() & 1 == 1,
        alpha: from.any(),
        min_normal_cosine: from.narrow(),
        photon_capacity: from.perhaps(|from| u64::from_le_bytes(from.take())),
        memory: from.perhaps(|from| u64::from_le_bytes(from.take())),
        seed: u64::from_le_bytes(from.take()),
        radius_factor: from.any(),
        area: [Area::Disc, Area::Surface][usize::from(from.byte() % 2)],
        bandwidth: [Bandwidth::Shared, Bandwidth::PerPixel][usize::from(from.byte() % 2)],
        caustic_photons: match from.byte() % 8 {
            0 => CausticPhotons::Auto,
            1 => CausticPhotons::Aimed(u32::from(from.byte())),
            _ => CausticPhotons::Shared,
        },
        max_plane_distance: (from.byte() % 4 == 0).then(|| from.narrow()),
        caustic_roughness: from.perhaps(Bytes::narrow),
        ..Settings::default()
    };
    static SCENES: std::sync::OnceLock<Vec<photon_scene::Scene>> = std::sync::OnceLock::new();
    let scenes = SCENES.get_or_init(|| {
        // With few triangles: trees are built for every input.
        let mut glass = photon_scene::builtin("cornell").expect("listed");
        if let Some(material) = glass.materials_mut().first_mut() {
            material.surface =
                photon_scene::Surface::Dielectric { ior: 1.5, absorption: [0.1; 3], tint: [0.9; 3], roughness: 0.0 };
        }
        let build = |scene: photon_scene::SceneBuilder| scene.build().expect("sound");
        ["cornell", "plates"]
            .map(|name| photon_scene::builtin(name).expect("listed"))
            .into_iter()
            .chain([glass])
            .map(build)
            .collect()
    });
    photon_fuzz::render(&scenes[usize::from(scene % 3)], settings, 2);
});

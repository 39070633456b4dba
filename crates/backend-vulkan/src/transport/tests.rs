//! Kernels are specialized to the features of the scene, and a render's memory is released after it.

use photon_core::{
    Backend, Bandwidth, Batch, Deposits, Direct, Display, EstimateParams, EyeBuffers, Features, FilmBackend, IndexKind,
    Indirect, MapKind, Maps, MediaDeposits, Pass, PerMap, Photon, PhotonRay, Pipeline, QUERIES_PER_PIXEL, Query,
    RandomKind, Render, Requirements, Search, Settings, TransportBackend, View,
};
use photon_scene::{Scene, builtin};

use crate::Vulkan;
use crate::scene::WITH_TABLES;

/// Runs all stages once and returns the kernels that are specialized to scene features, with these.
fn built_for(scene: &Scene, settings: &Settings, required: &Requirements) -> Vec<(&'static str, Features)> {
    let mut on = Vulkan::for_tests().unwrap();
    let view = View { camera: scene.camera(None, 8, 8).unwrap(), width: 8, height: 8 };
    let pass = Pass { seed: 1, index: 0, random: RandomKind::Counter, sample: 0, samples: 1 };
    let prepared = on.prepare(&scene.view(), required).unwrap();
    let mut stages = on.stages(required, settings).unwrap();
    let mut rays = on.alloc::<PhotonRay>("rays", 500).unwrap();
    let mut photons = on.alloc::<Photon>("photons", 1 << 16).unwrap();
    let batch = Batch { pass, paths: 0..500 };
    stages.emitter.emit(&mut on, &prepared, &batch, &mut rays).unwrap();
    let deposits = Deposits::<'_, Vulkan>::only(MapKind::Global, &mut photons);
    stages.tracer.trace(&mut on, &prepared, &batch, &rays, deposits, MediaDeposits::default()).unwrap();
    let mut film = on.film(scene.units(), 8, 8).unwrap();
    let mut queries = on.alloc::<Query>("queries", u64::from(64 * QUERIES_PER_PIXEL)).unwrap();
    stages
        .eye
        .trace_eye(&mut on, &prepared, &view, pass, &mut film, EyeBuffers { queries: &mut queries, segments: None })
        .unwrap();
    stages.direct.as_mut().unwrap().light(&mut on, &prepared, pass, &queries, 1, &mut film).unwrap();
    let map = stages.map.builder.build(&mut on, photons).unwrap();
    let gather = EstimateParams { radius_scale: 0.1, min_normal_cosine: 0.5, ..EstimateParams::new(Search::Radius) };
    let photons = PerMap::only(MapKind::Global, (&map, gather));
    let maps = Maps { photons, irradiance: None, paths: PerMap::splat(500) };
    stages.gather.as_mut().unwrap().gather(&mut on, &prepared, &maps, pass, &queries, 1, &mut film).unwrap();
    let names = ["stages_emit", "stages_trace", "stages_eye", "stages_direct", "stages_final_gather"];
    let mut found = Vec::new();
    for (name, constants) in on.requested() {
        let first = constants.iter().find(|(id, _)| *id == 0).map_or(0, |&(_, value)| value);
        if names.contains(&name) {
            assert_eq!(Features::from_bits_truncate(first).bits(), first, "{name}");
            found.push((name, Features::from_bits_truncate(first)));
        } else {
            assert_eq!(first, 0, "{name} is specialized to the scene's features");
        }
    }
    assert_eq!(found.len(), names.len(), "{found:?}");
    found
}

#[test]
fn kernels_are_built_for_what_the_scene_requires() {
    if Vulkan::for_tests().is_none() {
        return;
    }
    let settings = Settings { direct: Direct::Nee, indirect: Indirect::Gather, ..Settings::default() };
    let mut seen = Vec::new();
    for name in ["cornell", "ring", "cornell-glass"] {
        let scene = builtin(name).unwrap().build().unwrap();
        let mut required = Requirements::of(&scene.view(), &settings);
        required.maps[MapKind::Global] = true;
        for (kernel, features) in built_for(&scene, &settings, &required) {
            assert_eq!(features, required.features, "{name}: {kernel}");
        }
        seen.push(required.features);
    }
    // The scenes differ, so that identical kernels for all of them would be detected.
    assert!(!seen[0].intersects(Features::SPECULAR) && seen[0] != seen[1] && seen[1] != seen[2]);
    let scene = builtin("cornell").unwrap().build().unwrap();
    let everything = Requirements::everything(&settings);
    // Tables that the scene lacks are not read, whatever is required.
    let expected = everything.features.without(WITH_TABLES).without(Features::THIN_LENS);
    for (kernel, features) in built_for(&scene, &settings, &everything) {
        assert_eq!(features, expected, "{kernel}");
    }
}

/// Buffers that a pipeline holds for longer than a pass: irradiance points, radii of pixels.
#[test]
fn a_backend_that_is_given_back_holds_no_buffer_of_the_render() {
    let scene = builtin("cornell").unwrap().build().unwrap();
    let view = View { camera: scene.camera(None, 8, 8).unwrap(), width: 8, height: 8 };
    let settings = Settings { photons: 2000, gather_rays: 1, ..Settings::default() };
    let gathered = Settings { indirect: Indirect::Gather, irradiance_every: Some(8), ..settings.clone() };
    let own_radii = Settings { errors: true, bandwidth: Bandwidth::PerPixel, ..settings };
    for settings in [gathered, own_radii] {
        let Some(on) = Vulkan::for_tests() else { return };
        let mut pipeline = Pipeline::new(on, &scene.view(), view, settings).unwrap();
        for pass in 0..9 {
            pipeline.pass(pass, &mut ()).unwrap();
        }
        let on = pipeline.into_backend().unwrap();
        let left = on.device.graveyard.lock().unwrap().len();
        assert_eq!(left, 0);
    }
}

/// All kernels of a render are announced before the scene is prepared, whatever its settings: nothing is compiled on demand.
#[test]
fn passes_request_no_kernel_that_was_not_announced() {
    let own_radii = Settings { errors: true, bandwidth: Bandwidth::PerPixel, ..Settings::default() };
    let gathered = Settings { indirect: Indirect::Gather, gather_rays: 1, ..Settings::default() };
    let errors = Settings { errors: true, index: IndexKind::Vvh, ..gathered.clone() };
    let points = Settings { irradiance_every: Some(8), index: IndexKind::Median, direct: Direct::Photons, ..gathered };
    let fog = own_radii.clone();
    for (name, settings, passes) in
        [("gloss", own_radii, 9), ("cornell-glass", errors, 1), ("cornell", points, 1), ("glass-fog", fog, 1)]
    {
        let Some(on) = Vulkan::for_tests() else { return };
        let scene = builtin(name).unwrap().build().unwrap();
        let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
        let mut pipeline = Pipeline::new(on, &scene.view(), view, Settings { photons: 3000, ..settings }).unwrap();
        for pass in 0..passes {
            pipeline.pass(pass, &mut ()).unwrap();
        }
        let late = pipeline.backend().late_kernels();
        assert!(late.is_empty(), "{name}: {late:?}");
        // A kernel that only previews need is not announced.
        pipeline.display(&Display::default()).unwrap();
        assert!(pipeline.backend().late_kernels().iter().map(|(name, _)| *name).eq(["film_display"]), "{name}");
    }
}

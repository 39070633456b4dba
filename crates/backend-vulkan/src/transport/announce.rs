//! Requests the kernels of a pass, so that all cores compile them while the scene is prepared.
//!
//! Stages say which kernels they need by the functions that also dispatch them.

use photon_core::{
    AnnouncedMap, Announcement, Area, Bandwidth, EstimateParams, Features, Indirect, Kernel, Layer, MapKind, MapPlace,
    MediaFeatures, PerMap, PhotonFormat, QUERIES_PER_PIXEL, Result, Search,
};

use crate::film;
use crate::index;
use crate::map::estimate;
use crate::scene::SceneKind;
use crate::stages::eye::{self, EyePaths};
use crate::stages::trace::PhotonPaths;
use crate::stages::{area, direct, emit, final_gather, irradiance, medium_direct};
use crate::vulkan::Vulkan;

/// Requests all kernels of these passes, those that take longest first.
pub(super) fn announce(on: &mut Vulkan, passes: &Announcement<'_>) -> Result<()> {
    let scene = SceneKind::of(passes.scene, passes.required);
    camera(on, &scene, passes);
    photons(on, &scene, passes);
    estimates(on, &scene, passes);
    let settings = passes.settings;
    let points = settings.irradiance_every.filter(|_| passes.required.final_gather).map(|_| PhotonFormat::Full);
    for format in passes.maps.iter().map(|map| map.photon_format).chain(points) {
        index::announce(on, settings.index, format)?;
    }
    films(on, &scene, passes);
    on.all_announced();
    Ok(())
}

fn photons(on: &mut Vulkan, scene: &SceneKind, passes: &Announcement<'_>) {
    let settings = passes.settings;
    for is_aimed in [false, true] {
        // As in `Pipeline::send_batch`: a map is filled by one kind of paths.
        let filled = |map: &&AnnouncedMap| (passes.is_aimed && map.kind.is_aimed()) == is_aimed;
        let formats = |place: MapPlace| {
            let mut formats = PerMap::<Option<PhotonFormat>>::default();
            for map in passes.maps.iter().filter(filled).filter(|map| map.place == place) {
                formats[map.kind] = Some(map.photon_format);
            }
            formats
        };
        let [plain, reflected, mut in_media, from_media] = MapPlace::ALL.map(formats);
        in_media[MapKind::Direct] = from_media[MapKind::Global];
        let any = |formats: PerMap<Option<PhotonFormat>>| formats.values().any(Option::is_some);
        if ![plain, reflected, in_media].into_iter().any(any) {
            continue;
        }
        let paths = if is_aimed { PhotonPaths::aimed(settings) } else { PhotonPaths::new(settings) };
        paths.announce(on, scene, settings.random, [plain, in_media]);
        if any(reflected) {
            let paths = PhotonPaths::for_reflections(settings, passes.required);
            paths.announce(on, scene, settings.random, [reflected, PerMap::default()]);
        }
        emit::kernel(on, scene, settings.random, is_aimed);
    }
}

fn camera(on: &mut Vulkan, scene: &SceneKind, passes: &Announcement<'_>) {
    EyePaths::new(passes.settings, passes.required).announce(on, scene, &passes.view);
    if passes.maps.iter().any(|map| map.place == MapPlace::Reflection) {
        EyePaths::for_reflections(passes.settings, passes.required).announce(on, scene, &passes.view);
    }
    if passes.required.shadow_rays {
        direct::kernel(on, scene);
    }
    if passes.required.media.contains(MediaFeatures::SCATTERING) {
        medium_direct::kernel(on, scene);
    }
}

fn estimates(on: &mut Vulkan, scene: &SceneKind, passes: &Announcement<'_>) {
    let settings = passes.settings;
    let surface = settings.area == Area::Surface;
    let queries = queries(passes);
    for map in &passes.maps {
        if map.place == MapPlace::Medium {
            estimate::beam::announce(on, map.gather.kernel, scene, settings.errors);
            // The pilot pass keeps no error statistics.
            if passes.has_pilot {
                estimate::beam::announce(on, map.gather.kernel, scene, false);
            }
            continue;
        }
        if passes.has_pilot {
            estimate::announce_neighbours(on, map.photon_format, settings.min_normal_cosine);
            if map.is_shown && map.place.is_on_visible_surfaces() {
                footprints(on, passes, map.photon_format);
            }
        }
        if map.is_shown {
            estimate::announce(on, &map.gather, map.photon_format, queries, settings.errors);
            if surface {
                area::kernel(on, scene, &map.gather, settings.errors);
            }
        }
    }
    if !passes.required.final_gather {
        return;
    }
    let rays = final_gather::most_rays(on, queries, settings.gather_rays);
    final_gather::ray_kernel(on, scene);
    final_gather::sum_kernel(on, settings.errors, false);
    for map in passes.maps.iter().filter(|map| map.place == MapPlace::Surface) {
        let Some(every) = settings.irradiance_every else {
            estimate::announce(on, &map.gather, map.photon_format, rays, settings.errors);
            continue;
        };
        // As in `Pipeline::irradiance`, whose points are about as many as photons.
        let points = u64::from(settings.photons / every.max(1));
        let gather = EstimateParams { kernel: Kernel::Constant, ..map.gather };
        estimate::announce(on, &gather, map.photon_format, points, false);
        estimate::announce(on, &gather, map.photon_format, rays, false);
        if surface {
            area::kernel(on, scene, &gather, false);
        }
        irradiance::kernels(on);
        final_gather::sum_kernel(on, settings.errors, true);
        estimate::announce(on, &EstimateParams::new(Search::NearestPhoton), PhotonFormat::Full, rays, settings.errors);
    }
}

/// Upper bound on the queries of a pass.
fn queries(passes: &Announcement<'_>) -> u64 {
    let pixels = u64::from(passes.view.width) * u64::from(passes.view.height);
    if passes.required.features.splits_camera_paths() { pixels * u64::from(QUERIES_PER_PIXEL) } else { pixels }
}

/// The pilot pass compares radii with the footprints of pixels: as in `Pipeline::least_radius`.
fn footprints(on: &mut Vulkan, passes: &Announcement<'_>, format: PhotonFormat) {
    let settings = passes.settings;
    let gather = EstimateParams {
        min_normal_cosine: settings.min_normal_cosine,
        max_plane_distance: settings.plane_distance(),
        ..EstimateParams::new(Search::Radius)
    };
    // Pixels are joined, and their queries may be sorted or not.
    let few = queries(passes).min(u64::from(QUERIES_PER_PIXEL));
    estimate::announce(on, &gather, format, few, false);
    if passes.required.features.intersects(Features::SPECULAR) {
        estimate::announce(on, &gather, format, queries(passes).min(65_536), false);
    }
}

fn films(on: &mut Vulkan, scene: &SceneKind, passes: &Announcement<'_>) {
    let settings = passes.settings;
    let gathers = passes.required.final_gather && settings.indirect == Indirect::Gather;
    let mut layers: Vec<Layer> = Vec::new();
    let mut add = |layer, is_filled: bool| {
        if is_filled && !layers.contains(&layer) {
            layers.push(layer);
        }
    };
    add(Layer::Emission, eye::finds_light(scene, &passes.view));
    let scatters = passes.required.media.contains(MediaFeatures::SCATTERING);
    add(Layer::Direct, passes.required.shadow_rays || scatters);
    add(Layer::Indirect, gathers);
    let mut shown = PerMap::<bool>::default();
    for map in passes.maps.iter().filter(|map| map.is_shown) {
        add(map.kind.layer(), true);
        shown[map.kind] = true;
    }
    let averages = settings.camera_samples > 1;
    film::announce(on, &layers, shown.any(), passes.required.shadow_rays || scatters || gathers, averages);
    if settings.errors {
        film::errors::announce(on, shown, gathers);
    }
    if settings.bandwidth == Bandwidth::PerPixel {
        eye::radii_kernel(on);
        film::bandwidth::announce(on, &layers, shown);
    }
}

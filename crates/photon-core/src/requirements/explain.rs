//! Explains the [`crate::Requirements`] of a scene: what is needed, what is left out, and why.

use crate::pipeline::irradiance::with_points;
use crate::projection::{NoProjection, ProjectionMap};
use crate::radius::radii;
use crate::requirements::features::Features;
use crate::requirements::gloss_caustics::{has_gloss_caustics, roughest_caustic};
use crate::requirements::map_kind::MapKind;
use crate::requirements::photon_format::PhotonFormat;
use crate::requirements::{Requirements, has_receiver, light_features, material_features};
use crate::scene::SceneView;
use crate::scene::light::Light;
use crate::scene::media::MediaFeatures;
use crate::settings::{Area, Direct, Estimator, Indirect, Settings};

/// A feature, map or stage that a renderer can model, allocate or build.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Need {
    /// Its name.
    pub what: &'static str,
    /// Whether it is needed.
    pub needed: bool,
    /// Why, or why not.
    pub why: String,
}

/// What glossy surfaces cost, and how to do without.
const GLOSSY: &str = "camera paths follow their reflection, and sample a light at each; kind = \"lambert\", or specular = 0 \
                      without metal, in an override file makes them diffuse";

/// What clearcoats cost, and how to do without.
const CLEARCOAT: &str = "a second reflection at each of its surfaces; clearcoat = 0 in an override file removes it";

/// What anisotropy costs, and how to do without.
const ANISOTROPY: &str = "a frame of tangents at each of its surfaces; anisotropy = 0 in an override file removes it";

/// What diffuse transmission costs, and how to do without.
const DIFFUSE_TRANSMISSION: &str = "a second query at each of its surfaces, for the light on the other side; \
                                    diffuse_transmission = 0 in an override file removes it";

/// What sheen costs, and how to do without.
const SHEEN: &str = "a second reflection at each of its surfaces, which camera paths follow; sheen = 0 in an override file \
                     removes it";

/// What partial transmission costs, and how to do without.
const PARTIAL_TRANSMISSION: &str = "each path meets glass or the opaque material, chosen at random, which adds noise; \
                                    transmission = 0 in an override file makes them opaque";

/// What rough glass costs, and how to do without.
const ROUGH_GLASS: &str = "camera paths sample a light at each of its surfaces, on one of the two sides; roughness = 0 in an \
                           override file makes it smooth";

/// The needs of a scene: lobes and lights first, in the order of [`Features`], then maps, then stages.
#[must_use]
pub fn explain(scene: &SceneView<'_>, settings: &Settings) -> Vec<Need> {
    let required = Requirements::of(scene, settings);
    let mut needs: Vec<Need> = Features::ALL
        .names()
        .zip(Features::ALL)
        // The lens belongs to the view, which is not known here.
        .filter(|&(_, feature)| feature != Features::THIN_LENS)
        .map(|(what, feature)| {
            let triangles = scene
                .primitives
                .iter()
                .filter(|primitive| {
                    scene.materials_of(primitive).any(|material| material_features(material, scene).contains(feature))
                })
                .count();
            let lights = scene.lights.iter().filter(|light| light_features(light).contains(feature)).count();
            let why = match (triangles, lights) {
                _ if feature == Features::PORTALS => match (required.features.contains(feature), scene.portals.len()) {
                    (false, 0) => "none is declared".to_owned(),
                    (false, _) => "no light is infinitely far away".to_owned(),
                    (true, count) => format!(
                        "{}; photons of infinitely distant lights start through them more often",
                        counted(count, "triangle")
                    ),
                },
                _ if feature == Features::LIGHT_TREE => counted(scene.lights.len(), "light"),
                (0, 0) => "nothing in the scene has it".to_owned(),
                (0, lights) => counted(lights, "light"),
                (triangles, _) if feature == Features::GLOSSY => {
                    format!("{}; {GLOSSY}", counted(triangles, "triangle"))
                }
                (triangles, _) if feature == Features::CLEARCOAT => {
                    format!("{}; {CLEARCOAT}", counted(triangles, "triangle"))
                }
                (triangles, _) if feature == Features::ANISOTROPY => {
                    format!("{}; {ANISOTROPY}", counted(triangles, "triangle"))
                }
                (triangles, _) if feature == Features::DIFFUSE_TRANSMISSION => {
                    format!("{}; {DIFFUSE_TRANSMISSION}", counted(triangles, "triangle"))
                }
                (triangles, _) if feature == Features::SHEEN => {
                    format!("{}; {SHEEN}", counted(triangles, "triangle"))
                }
                (triangles, _) if feature == Features::PARTIAL_TRANSMISSION => {
                    format!("{}; {PARTIAL_TRANSMISSION}", counted(triangles, "triangle"))
                }
                (triangles, _) if feature == Features::ROUGH_GLASS => {
                    format!("{}; {ROUGH_GLASS}", counted(triangles, "triangle"))
                }
                (triangles, _) => counted(triangles, "triangle"),
            };
            Need { what, needed: required.features.contains(feature), why }
        })
        .collect();
    let mut say = |what, needed, why: &str| needs.push(Need { what, needed, why: why.to_owned() });

    let gather = settings.indirect == Indirect::Gather;
    for (kind, &filled) in required.maps.iter() {
        let (what, why) = map(kind, settings, &required);
        say(what, filled, why);
        if kind.is_aimed() {
            let (aimed, why) = aiming(scene, settings, &required);
            say("aimed photons", aimed, &why);
        }
    }
    let (without_extent, roughest) = (has_gloss_caustics(scene), roughest_caustic(scene));
    let is_rough = settings.caustic_roughness.is_some_and(|least| least <= roughest);
    let perfect = without_extent || is_rough;
    say(
        "caustics in glossy reflections",
        required.gloss_caustics,
        match (required.gloss_caustics, perfect, matches!(settings.estimator, Estimator::Paper(_))) {
            (true, ..) if !without_extent => {
                "light may reach rough reflections by way of perfect mirrors or smooth glass: photons for them have a map of \
                 32 bytes each, and camera paths are traced once more"
            }
            (true, ..) => {
                "point, spot or directional lights may reach glossy surfaces by way of perfect mirrors or smooth glass: photons for their \
                 reflection have a map of 32 bytes each, and camera paths are traced once more"
            }
            (false, false, _) => {
                "no point, spot or directional light, or no glossy surface, or no perfect mirror and no smooth glass"
            }
            (false, true, true) => "the paper's estimator has no BSDF: they are left out",
            (false, true, false) => "caustics are left out, or no light reaches mirrors, glass or glossy surfaces",
        },
    );
    let least = settings.caustic_roughness.unwrap_or_default();
    let why = match (required.gloss_caustics_of_all_lights, settings.caustic_roughness, roughest) {
        (true, ..) => {
            format!("where the roughness is at least {least}, photons find it, and camera paths leave it out")
        }
        (_, _, roughest) if roughest < 0.0 => {
            "no area light and no environment, or no glossy surface, or no perfect mirror and no smooth glass"
                .to_owned()
        }
        (_, None, _) => "camera paths find it, by chance; --caustic-roughness has it from photons".to_owned(),
        (_, Some(_), _) if !is_rough => format!("every glossy surface has a roughness below {least}"),
        _ => "caustics in glossy reflections are left out".to_owned(),
    };
    say("those of area lights and environments", required.gloss_caustics_of_all_lights, &why);
    let scatters = required.media.contains(MediaFeatures::SCATTERING);
    say(
        "media that scatter light",
        scatters,
        if scatters {
            "each photon in them takes 32 bytes, camera paths are traced once more, and shadow rays start along them too"
        } else {
            "no medium has a scattering coefficient"
        },
    );
    let any_map = required.maps.any();
    say(
        "photons",
        any_map,
        if any_map { "the maps above are filled with them" } else { "no map is read, so that none are emitted" },
    );
    let paper = matches!(settings.estimator, Estimator::Paper(_));
    say(
        "colours of photons",
        any_map && required.photon_format != PhotonFormat::Mono,
        match (any_map, paper, required.photon_format) {
            (false, ..) => "there are none",
            (_, true, _) => "the paper's estimator needs full photons of 32 bytes",
            (_, _, PhotonFormat::Mono) => "lights and surfaces are grey: one power per photon is stored, in 20 bytes",
            _ => "a light or a surface is not grey: 12 of the bytes of each photon",
        },
    );
    say(
        "directions of photons",
        any_map && required.photon_format == PhotonFormat::Full,
        match (any_map, paper, required.photon_format == PhotonFormat::Full) {
            (false, ..) => "there are none",
            (true, true, _) => "the paper's estimator reads them",
            (true, false, true) => "shading normals: photons count by their angle to them",
            (true, false, false) => "only the paper's estimator and shading normals need them",
        },
    );
    let pilot = any_map && radii::need_pilot(settings);
    say(
        "pilot pass",
        pilot,
        match (any_map, pilot) {
            (_, true) => "radii are derived from the density of its photons",
            (false, _) => "no map is searched",
            (true, false) => "the settings give the radius",
        },
    );
    say(
        "shadow rays",
        required.shadow_rays,
        match settings.direct {
            Direct::Nee => "they compute direct light",
            Direct::Photons => "direct light is read from a map",
            Direct::None => "direct light is left out",
        },
    );
    say(
        "further camera samples",
        settings.camera_samples > 1,
        &match settings.camera_samples {
            1 => "a pass has one camera path per pixel".to_owned(),
            samples => format!("a pass has {samples} camera paths per pixel; photons are read for the first alone"),
        },
    );
    let has_normals = !scene.shading.normals.is_empty();
    say(
        "shadow terminator offset",
        required.terminator_offset,
        match (required.terminator_offset, has_normals, settings.terminator_offset) {
            (true, ..) => {
                "vertex normals: shadow rays start outside the mesh, so that coarse meshes are shaded smoothly; light by \
                 photons is not affected"
            }
            (false, false, _) => "no triangle has vertex normals",
            (false, true, true) => "there are no shadow rays",
            (false, true, false) => "the settings turn it off",
        },
    );
    say(
        "final gathering",
        required.final_gather,
        match settings.indirect {
            Indirect::Gather => "indirect light is gathered",
            Indirect::Map => "indirect light is read straight from a map",
            Indirect::None => "indirect light is left out",
        },
    );
    let every = with_points(scene, settings.clone()).irradiance_every;
    say(
        "irradiance at photons",
        gather && every.is_some(),
        match (gather, every) {
            (true, Some(_)) => "final-gather rays use the nearest, if it is near",
            (true, None) => "final-gather rays estimate from the maps",
            (false, _) => "no final-gather rays",
        },
    );
    let probed = any_map && settings.area == Area::Surface;
    say(
        "area probes",
        probed,
        match (any_map, probed) {
            (_, true) => "estimates are divided by the part of their disc that lies on the surface",
            (false, _) => "no map is read",
            (true, false) => "estimates are divided by the area of their disc",
        },
    );
    let splits = required.features.splits_camera_paths();
    say(
        "split camera paths",
        splits,
        if splits {
            "glass reflects and transmits, glossy surfaces reflect and scatter: up to four queries a pixel"
        } else {
            "no glass and no glossy surfaces: one query a pixel"
        },
    );
    let choice = scene.lights.len() > 1;
    let single = scene.lights.first().is_some_and(|light| light.kind != Light::TRIANGLE);
    say(
        "choice among lights",
        choice,
        match (choice, single) {
            (true, _) => "there are several",
            (false, true) => "there is one",
            (false, false) => "there is one emissive triangle, or none",
        },
    );
    if !has_receiver(scene) {
        let of_receivers = needs.iter_mut().filter(|need| !need.needed && OF_RECEIVERS.contains(&need.what));
        of_receivers.for_each(|need| need.why = NO_RECEIVER.to_owned());
    }
    needs
}

/// What only surfaces need that store photons or reflect the light of shadow rays.
const OF_RECEIVERS: [&str; 5] =
    ["map of direct photons", "map of caustic photons", "map of scattered photons", "shadow rays", "final gathering"];

const NO_RECEIVER: &str = "every surface is a mirror, smooth glass or black: camera paths find the light";

/// Name of a map, and why it is filled or not.
fn map(kind: MapKind, settings: &Settings, required: &Requirements) -> (&'static str, &'static str) {
    let gather = settings.indirect == Indirect::Gather;
    match kind {
        MapKind::Direct => (
            "map of direct photons",
            match (settings.direct, gather) {
                (Direct::Photons, _) => "direct light is read from it",
                (_, true) => "final gathering reads it at the hits of its rays",
                (Direct::Nee, _) => "shadow rays compute what it would store",
                (Direct::None, _) => "direct light is left out",
            },
        ),
        MapKind::Caustic => (
            "map of caustic photons",
            match (required.maps[kind], required.features.intersects(Features::SPECULAR)) {
                (true, _) => "mirrors, glass or glossy surfaces are in reach of a light",
                (false, _) if !settings.caustics && !gather => "caustics are left out",
                (false, false) => "nothing reflects or refracts",
                (false, true) => "no light reaches a surface that reflects or refracts",
            },
        ),
        MapKind::Global => (
            "map of scattered photons",
            match settings.indirect {
                Indirect::Map => "indirect light is read from it",
                Indirect::Gather => "final gathering reads it at the hits of its rays",
                Indirect::None => "indirect light is left out",
            },
        ),
    }
}

/// Whether paths are aimed at mirrors and glass, and why.
fn aiming(scene: &SceneView<'_>, settings: &Settings, required: &Requirements) -> (bool, String) {
    if !required.maps[MapKind::Caustic] {
        return (false, "there is no map of caustic photons".to_owned());
    }
    let chosen =
        if required.aimed { ProjectionMap::chosen(scene, settings, required) } else { Err(NoProjection::Shared) };
    let (projection, paths) = match chosen {
        Ok(chosen) => chosen,
        Err(why) => {
            let why = match why {
                NoProjection::Shared => "the settings fill it with the paths that fill the other maps".to_owned(),
                NoProjection::Unlit => "no light could shine on mirrors, glass or glossy surfaces".to_owned(),
                NoProjection::NotWorth => {
                    let [most, rough] = [ProjectionMap::WORTH, ProjectionMap::WORTH_ROUGH].map(|share| 100.0 * share);
                    format!(
                        "more than {most} % of the light could meet mirrors, glass or glossy surfaces, or more than {rough} % \
                         and most of it rough ones: aiming would gain little"
                    )
                }
                NoProjection::Environment => "the environment has too much of the light: aiming would gain little; a \
                                              given number of caustic photons is aimed nevertheless"
                    .to_owned(),
            };
            return (false, why);
        }
    };
    let share = 100.0 * projection.share();
    let lights = counted(scene.lights.len(), "light");
    let why = format!(
        "{paths} paths a pass sample the {share:.1} % of the light that could meet mirrors, glass or glossy surfaces, from \
         {} of {lights}",
        projection.targets().len(),
    );
    (true, why)
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::material::{Material, Primitive};
    use crate::scene::units::Units;

    #[test]
    fn reasons_agree_with_the_requirements() {
        let positions = [[-0.5, 0.0, -0.5], [0.5, 0.0, -0.5], [0.0, 0.0, 0.5]];
        let materials = [Material { albedo: [0.5; 3], ..Material::default() }];
        let lights = [Light { kind: Light::POINT, power: [1.0; 3], primitive: u32::MAX, ..Light::default() }];
        let scene = SceneView {
            positions: &positions,
            triangles: &[[0, 1, 2]],
            primitives: &[Primitive { normal: [0.0, 1.0, 0.0], material: 0 }],
            materials: &materials,
            media: &[crate::scene::medium::Medium::VACUUM],
            lights: &lights,
            light_cdf: &[0],
            radius: 1.0,
            units: Units::default(),
            ..SceneView::default()
        };
        for direct in [Direct::Nee, Direct::Photons, Direct::None] {
            for indirect in [Indirect::Map, Indirect::Gather, Indirect::None] {
                let settings = Settings { direct, indirect, ..Settings::default() };
                let required = Requirements::of(&scene, &settings);
                let needs = explain(&scene, &settings);
                let needed = |what| needs.iter().find(|need| need.what == what).unwrap().needed;
                assert_eq!(needed("map of direct photons"), required.maps[MapKind::Direct]);
                assert_eq!(needed("map of scattered photons"), required.maps[MapKind::Global]);
                assert_eq!(needed("final gathering"), required.final_gather);
                assert!(needed("diffuse") && needed("point-lights") && !needed("mirror"));
                assert!(needs.iter().all(|need| !need.why.is_empty()));
                assert_eq!(needed("photons"), direct == Direct::Photons || indirect != Indirect::None);
            }
        }
    }
}

//! Converts the metallic-roughness model and its extensions to the supported surfaces.

use gltf::json::Root;
use gltf::json::material::Material;

use super::fault::{Fault, name_or_number};
use super::parameters::{self, Parameters};
use super::texture::Textures;
use super::{scatter, specular_glossiness};
use crate::builder::SceneBuilder;
use crate::describe::{AlphaMode, Dispersion, MaterialDesc, Surface};
use crate::extras::{self, Agrees, CHANGED, MaterialExtras};
use crate::parameter::{PARAMETERS, Parameter};
use crate::report::LoadReport;
use crate::shading::simplest;

/// Below this fraction a surface is not reported as a metal: means of textures are rarely exactly 0.
const SOME_METAL: f64 = 0.01;
/// The darkest attenuation colour, since black would need infinite absorption: a millionth of the light
/// remains after the attenuation distance.
const DARKEST: f64 = 1e-6;

/// Extensions of materials that are supported, or reported by separate code, beside those of layers.
const KNOWN: &[&str] =
    &["KHR_materials_unlit", specular_glossiness::NAME, parameters::DISPERSION, scatter::NAMES[0], scatter::NAMES[1]];

/// Converts one material; what is lost is reported.
pub(super) fn describe(
    root: &Root,
    index: usize,
    textures: &Textures<'_>,
    builder: &mut SceneBuilder,
    report: &mut LoadReport,
) -> Result<MaterialDesc, Fault> {
    let material = &root.materials[index];
    let name = name_or_number("material", index, material.name.as_deref());
    let subject = format!("material '{name}'");
    let mut lines = LoadReport::default();
    let mut parameters = parameters::read(root, index, textures, &subject, builder, &mut lines)?;
    let mut surface = surface(&mut parameters, &subject, &mut lines);
    let (transmission, absorption) = glass_part(&mut parameters, &surface, &subject, &mut lines);
    let is_solid = absorption.is_some() || matches!(surface, Surface::Dielectric { .. });
    close_solid(&mut parameters, is_solid, &subject, &mut lines);
    let (scattering, mean_cosine) =
        parameters.scatter.map_or(([0.0; 3], 0.0), |scatter| scatter.split(&mut surface, &subject, &mut lines));
    check_layers(&parameters, &surface, &subject, &mut lines);
    if parameters.dispersion > 0.0 && !is_solid {
        let text = "its KHR_materials_dispersion, since only solids of glass disperse light here; give it a transmissionFactor and a \
                    thicknessFactor above 0";
        lines.left_out(&subject, text);
    }
    report_rest(material, &subject, &mut lines);
    let desc = MaterialDesc {
        emission: parameters.emission,
        emits_both_sides: material.double_sided,
        alpha: parameters.alpha,
        alpha_mode: parameters.alpha_mode,
        transmission,
        transmission_absorption: absorption,
        dispersion: (parameters.dispersion > 0.0 && is_solid).then(|| Dispersion::Abbe(20.0 / parameters.dispersion)),
        scattering,
        phase: mean_cosine.into(),
        textures: parameters.textures,
        name,
        surface,
        ..parameters.layers
    };
    match extras::read::<MaterialExtras>(material.extras.as_deref().map(|raw| raw.get())) {
        Ok(None) => {}
        Ok(Some(extras)) => {
            let exact = extras.desc(desc.name.clone(), desc.textures);
            // These are in single precision everywhere.
            let exact = exact.map(|exact| exact.with_alpha(desc.alpha_mode, desc.alpha));
            if let Some(exact) = exact.filter(|exact| desc.agrees(exact)) {
                // The lines are about what glTF cannot express, and the extras can.
                return Ok(exact);
            }
            lines.note(&subject, CHANGED);
        }
        Err(why) => lines.note(&subject, why),
    }
    report.extend(lines);
    Ok(desc)
}

/// The nearest supported surface.
fn surface(of: &mut Parameters, subject: &str, report: &mut LoadReport) -> Surface {
    if of.is_unlit {
        report.approximated(
            subject,
            "is unlit; it is rendered as a diffuse surface of its base colour; give it emission in an override file if it \
             should glow",
        );
        return Surface::Lambert { albedo: of.base };
    }
    // Means of textures are rarely exactly 0.
    let is_metal = of.metallic > 0.0 && (of.textures.metallic_roughness.is_none() || of.mean_metallic > SOME_METAL);
    if of.transmission >= 1.0 && of.textures.transmission.is_none() && !is_metal {
        if of.metallic > 0.0 && of.mean_metallic > 0.0 {
            let percent = 100.0 * of.mean_metallic;
            report.note(subject, format!("is glass, although its texture makes {percent:.2} % of it metal"));
        }
        return glass(of, subject, report);
    }
    glossy(of, subject, report)
}

/// Share of glass and its absorption of a surface that is partly glass; takes them out of those that are not.
fn glass_part(
    of: &mut Parameters,
    surface: &Surface,
    subject: &str,
    report: &mut LoadReport,
) -> (f64, Option<[f64; 3]>) {
    let is_metal = of.metallic >= 1.0 && of.textures.metallic_roughness.is_none();
    // Of an index of 0, the coat reflects all light.
    let is_partly = of.transmission > 0.0 && !is_metal && of.ior != 0.0 && !of.is_unlit;
    if !is_partly || !matches!(surface, Surface::Glossy { .. }) {
        of.textures.transmission = None;
        return (0.0, None);
    }
    report_specular(of, subject, report);
    let layers = [
        (of.layers.clearcoat > 0.0, "clearcoat"),
        (of.layers.sheen_color != [0.0; 3], "sheen"),
        (of.layers.anisotropy > 0.0, "anisotropy"),
    ];
    for (_, name) in layers.into_iter().filter(|(has, _)| *has) {
        report.approximated(subject, format!("its {name} is left out for the share that is glass"));
    }
    let absorption = volume(of, subject, report);
    (of.transmission, absorption)
}

/// The metallic-roughness model itself.
fn glossy(of: &Parameters, subject: &str, report: &mut LoadReport) -> Surface {
    if of.specular > 1.0 {
        report.approximated(subject, format!("its specular factor {:.3} is replaced by 1", of.specular));
    }
    let is_varied = of.textures.metallic_roughness.is_some() || of.layers.anisotropy > 0.0;
    let is_metal = of.metallic >= 1.0 && !is_varied;
    let surface = Surface::Glossy {
        base_color: of.base,
        metallic: of.metallic,
        roughness: of.roughness,
        specular: of.specular.min(1.0),
        ior: of.ior,
    };
    // Glass has the refractive index and roughness of a glossy surface.
    let is_partly_glass = of.transmission > 0.0 && of.ior != 0.0 && !is_metal;
    if is_partly_glass { surface } else { simplest(surface) }
}

/// A transmissive material: a solid if it has a volume, otherwise a thin sheet.
fn glass(of: &mut Parameters, subject: &str, report: &mut LoadReport) -> Surface {
    if of.ior == 0.0 {
        report
            .approximated(subject, "has the refractive index 0, which reflects all light; it is rendered as a mirror");
        of.textures.base_color = None;
        return Surface::Mirror { reflectance: [1.0; 3] };
    }
    report_specular(of, subject, report);
    match volume(of, subject, report) {
        None => Surface::Thin { ior: of.ior, tint: of.base, roughness: of.roughness },
        Some(absorption) => Surface::Dielectric { ior: of.ior, absorption, tint: of.base, roughness: of.roughness },
    }
}

fn report_specular(of: &Parameters, subject: &str, report: &mut LoadReport) {
    if of.specular != 1.0
        || of.layers.specular_color != [1.0; 3]
        || of.textures.specular.is_some()
        || of.textures.specular_color.is_some()
    {
        report.left_out(subject, "the specular factor of its glass, which reflects by its refractive index");
    }
}

/// Absorption inside; `None` without a volume.
fn volume(of: &Parameters, subject: &str, report: &mut LoadReport) -> Option<[f64; 3]> {
    if !of.is_solid {
        if of.attenuation_distance.is_finite() {
            report.left_out(
                subject,
                "its attenuation, since without thickness it is a sheet; give it a thicknessFactor above 0",
            );
        }
        return None;
    }
    Some(absorption(of, subject, report))
}

/// Beer–Lambert: the transmittance of a distance d is exp(−σ d), so that σ = −ln(colour) / d
/// (`KHR_materials_volume`).
fn absorption(of: &Parameters, subject: &str, report: &mut LoadReport) -> [f64; 3] {
    let distance = of.attenuation_distance;
    if distance <= 0.0 {
        report.left_out(
            subject,
            format!("its attenuation distance of {distance}, which must be above 0; nothing is absorbed"),
        );
        return [0.0; 3];
    }
    if distance.is_finite() && of.attenuation_color.iter().any(|&color| color < DARKEST) {
        let text = format!("absorbs everything within {distance}; a millionth is left instead");
        report.approximated(subject, text);
    }
    // The clamp also keeps −ln(1) from becoming −0.
    of.attenuation_color.map(|color| (-libm::log(color.max(DARKEST)) / distance).max(0.0))
}

/// A solid is opaque: its boundary must be closed.
fn close_solid(of: &mut Parameters, is_solid: bool, subject: &str, report: &mut LoadReport) {
    if !is_solid || of.alpha_mode == AlphaMode::Opaque {
        return;
    }
    if of.alpha < 1.0 || of.textures.alpha.is_some() {
        report.left_out(subject, "its alpha: the boundary of a solid must be closed");
    }
    (of.alpha, of.alpha_mode, of.textures.alpha) = (1.0, AlphaMode::Opaque, None);
}

/// Reports the layers that the surface does not have.
fn check_layers(of: &Parameters, surface: &Surface, subject: &str, report: &mut LoadReport) {
    if matches!(surface, Surface::Dielectric { .. } | Surface::Thin { .. }) {
        // The specular factor of glass has a line of its own.
        let leads = |parameter: &&Parameter| {
            parameter.key != "specular_color" && parameter.layer.is_some_and(|layer| layer.leader == parameter.key)
        };
        for layer in PARAMETERS.iter().filter(leads).filter(|layer| layer.is_present(&of.layers)) {
            let name = layer.key.replace('_', " ");
            report.left_out(subject, format!("its {name}, which glass does not have here"));
        }
    } else if of.is_solid && of.layers.diffuse_transmission > 0.0 {
        report.approximated(subject, "transmits light diffusely as a sheet: its volume does not scatter or absorb");
    }
}

/// Reports properties that have no counterpart.
fn report_rest(material: &Material, subject: &str, report: &mut LoadReport) {
    // Occlusion maps approximate the light transport that is computed here.
    if material.occlusion_texture.is_some() {
        report.note(subject, "its occlusion map is not needed");
    }
    let others = material.extensions.iter().flat_map(|extensions| extensions.others.keys());
    let is_layer = |name: &str| {
        PARAMETERS.iter().any(|of| of.layer.and_then(|layer| layer.gltf).is_some_and(|gltf| gltf.0 == name))
    };
    for name in others.filter(|name| !KNOWN.contains(&name.as_str()) && !is_layer(name)) {
        report.left_out(subject, format!("its {name}, which is not modelled; the surface is rendered without it"));
    }
}

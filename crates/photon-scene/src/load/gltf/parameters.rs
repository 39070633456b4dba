//! The parameters of a material: its factors, times the means of its textures.

use gltf::json::extensions::material as extension;
use gltf::json::material::AlphaMode;
use gltf::json::texture::Info;
use gltf::json::validation::Checked;
use gltf::json::{Root, Value};

use super::fault::{AGAIN, Fault, label};
use super::texture::{Mean, Textures};
use crate::report::LoadReport;

/// The parameters that determine how a material is rendered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameters {
    /// Base colour, linear RGB.
    pub(super) base: [f64; 3],
    /// Fraction of the surface that is opaque (alpha), in `[0, 1]`.
    pub(super) coverage: f64,
    pub(super) metallic: f64,
    pub(super) roughness: f64,
    pub(super) transmission: f64,
    /// 0 means a surface that reflects all light (`KHR_materials_ior`).
    pub(super) ior: f64,
    /// Scale and colour of the specular reflection of a non-metal.
    pub(super) specular: [f64; 3],
    /// Whether it bounds a volume rather than being a thin sheet.
    pub(super) is_solid: bool,
    /// Transmittance of `attenuation_distance`.
    pub(super) attenuation_color: [f64; 3],
    /// User length; infinite without absorption.
    pub(super) attenuation_distance: f64,
    /// Radiance.
    pub(super) emission: [f64; 3],
    pub(super) is_unlit: bool,
}

/// Reads the material; the losses of its textures are reported under `subject`.
pub(super) fn read(
    root: &Root,
    index: usize,
    textures: &Textures<'_>,
    subject: &str,
    report: &mut LoadReport,
) -> Result<Parameters, Fault> {
    let material = &root.materials[index];
    let part = label("material", index, material.name.as_deref());
    let mut means = Means { textures, part: &part, subject, report };

    let used = |info: &Info| info.index.value();
    let none = extension::Material::default();
    let extensions = material.extensions.as_ref().unwrap_or(&none);
    let pbr = &material.pbr_metallic_roughness;
    let mut factor = pbr.base_color_factor.0.map(f64::from);
    let mut metallic = f64::from(pbr.metallic_factor.0);
    let mut roughness = f64::from(pbr.roughness_factor.0);
    let mut base_texture = pbr.base_color_texture.as_ref().map(used);
    if let Some(old) = extensions.others.get("KHR_materials_pbrSpecularGlossiness") {
        // Only the diffuse part of this deprecated extension has a counterpart.
        factor = numbers(old, "diffuseFactor").unwrap_or([1.0; 4]);
        let index = old.get("diffuseTexture").and_then(|info| info.get("index")?.as_u64());
        base_texture = index.map(|index| index as usize);
        (metallic, roughness) = (0.0, 1.0);
        means.report.approximated(
            subject,
            "its specular-glossiness model is rendered as its diffuse colour; export it as \
             metallic-roughness",
        );
    }
    let base = means.get(base_texture, "base colour", |mean| triple(mean.color))?;
    let texture = pbr.metallic_roughness_texture.as_ref().map(used);
    let shown = |mean: &Mean| format!("metal {:.3}, roughness {:.3}", mean.plain[2], mean.plain[1]);
    if let Some(mean) = means.get(texture, "metal and roughness", shown)? {
        roughness *= mean.plain[1];
        metallic *= mean.plain[2];
    }
    let transmission = match &extensions.transmission {
        None => 0.0,
        Some(transmission) => {
            let texture = transmission.transmission_texture.as_ref().map(used);
            let shown = |mean: &Mean| format!("transmission {:.3}", mean.plain[0]);
            let mean = means.get(texture, "transmission", shown)?;
            f64::from(transmission.transmission_factor.0) * mean.map_or(1.0, |mean| mean.plain[0])
        }
    };
    let strength = extensions.emissive_strength.as_ref().map_or(1.0, |e| f64::from(e.emissive_strength.0));
    let emissive = material.emissive_factor.0.map(|factor| f64::from(factor) * strength);
    let is_dark = emissive == [0.0; 3];
    let texture = material.emissive_texture.as_ref().map(used).filter(|_| !is_dark);
    let glow = means.get(texture, "emission", |mean| triple(mean.color))?;

    let alpha = factor[3] * base.map_or(1.0, |mean| mean.alpha);
    let is_masked = matches!(material.alpha_mode, Checked::Valid(AlphaMode::Mask));
    if is_masked && base.is_some_and(|mean| mean.alpha < 1.0) {
        means.report.left_out(subject, "its alpha mask; it is rendered as opaque");
    }
    let volume = extensions.volume.as_ref();
    let specular = extensions.others.get("KHR_materials_specular");
    let scale = specular.and_then(|s| numbers(s, "specularFactor")).map_or(1.0, |[scale]| scale);
    let color = specular.and_then(|s| numbers(s, "specularColorFactor")).unwrap_or([1.0; 3]);
    Ok(Parameters {
        base: times([factor[0], factor[1], factor[2]], base.map(|mean| mean.color)),
        coverage: match material.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => 1.0,
            Checked::Valid(AlphaMode::Blend) => alpha,
            Checked::Valid(AlphaMode::Mask) => {
                let cutoff = material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
                // A textured surface is always partly visible.
                if base.is_some() || alpha >= f64::from(cutoff) { 1.0 } else { 0.0 }
            }
            Checked::Invalid => return Err(Fault::new(part, "has an unknown alphaMode", AGAIN)),
        },
        metallic,
        roughness,
        transmission,
        ior: extensions.ior.as_ref().map_or(1.5, |ior| f64::from(ior.ior.0)),
        specular: color.map(|color| color * scale),
        is_solid: volume.is_some_and(|volume| volume.thickness_factor.0 > 0.0),
        attenuation_color: volume.map_or([1.0; 3], |v| v.attenuation_color.0.map(f64::from)),
        attenuation_distance: volume.map_or(f64::INFINITY, |v| f64::from(v.attenuation_distance.0)),
        emission: times(emissive, glow.map(|mean| mean.color)),
        is_unlit: extensions.others.contains_key("KHR_materials_unlit"),
    })
}

/// The textures of one material.
struct Means<'a, 'b> {
    textures: &'a Textures<'b>,
    part: &'a str,
    subject: &'a str,
    report: &'a mut LoadReport,
}

impl Means<'_, '_> {
    /// The mean of a texture, if there is one and it can be read; `shown` formats it for the report.
    fn get(
        &mut self,
        texture: Option<usize>,
        role: &str,
        shown: impl Fn(&Mean) -> String,
    ) -> Result<Option<Mean>, Fault> {
        let Some(texture) = texture else {
            return Ok(None);
        };
        let name = self.textures.name(texture);
        match self.textures.mean(texture, self.part)? {
            Ok(mean) if mean.is_uniform => Ok(Some(mean)),
            Ok(mean) => {
                let text = format!("{name} ({role}) is replaced by its mean: {}", shown(&mean));
                self.report.approximated(self.subject, text);
                Ok(Some(mean))
            }
            Err(why) => {
                let text = format!("{name} ({role}): {why}; only its factor is used");
                self.report.left_out(self.subject, text);
                Ok(None)
            }
        }
    }
}

fn triple([r, g, b]: [f64; 3]) -> String {
    format!("colour ({r:.3}, {g:.3}, {b:.3})")
}

fn times(factor: [f64; 3], mean: Option<[f64; 3]>) -> [f64; 3] {
    let mean = mean.unwrap_or([1.0; 3]);
    std::array::from_fn(|channel| factor[channel] * mean[channel])
}

/// A number, or an array of `N` numbers, from an extension that the parser leaves as JSON.
fn numbers<const N: usize>(extension: &Value, field: &str) -> Option<[f64; N]> {
    let value = extension.get(field)?;
    let numbers: Vec<f64> = match value {
        Value::Array(items) => items.iter().map(Value::as_f64).collect::<Option<_>>()?,
        single => vec![single.as_f64()?],
    };
    numbers.try_into().ok()
}

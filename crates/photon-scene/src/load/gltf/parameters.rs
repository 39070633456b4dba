//! The parameters of a material: its factors, its textures, and the means of those that the scene has no place for.

use gltf::json::extensions::material as extension;
use gltf::json::material::AlphaMode as Mode;
use gltf::json::validation::Checked;
use gltf::json::{Root, Value as Json};
use photon_core::TexelFormat;

use super::factors;
use super::fault::{AGAIN, Fault, label};
use super::mean::Mean;
use super::scatter::Scatter;
use super::slot::Slot;
use super::specular_glossiness::{self, Converted, SpecularGlossiness};
use super::texture::Textures;
use crate::builder::SceneBuilder;
use crate::describe::{AlphaMode, MaterialDesc};
use crate::parameter::{
    BASE_COLOR, Channel, EMISSION, Encoding, Kind, Layer, METALLIC_ROUGHNESS, NORMAL, PARAMETERS, SPECULAR,
    TRANSMISSION, TextureParameter, Value,
};
use crate::report::LoadReport;
use crate::texture::{TextureRef, TexturesDesc};

/// The parameters that determine how a material is rendered.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    /// Factor of the base colour, linear RGB.
    pub(super) base: [f64; 3],
    /// Factor on alpha, in `[0, 1]`.
    pub(super) alpha: f64,
    pub(super) alpha_mode: AlphaMode,
    /// Factors; and that of metal times the mean of its texture.
    pub(super) metallic: f64,
    pub(super) roughness: f64,
    pub(super) mean_metallic: f64,
    /// Share of what is not metal that is glass.
    pub(super) transmission: f64,
    /// 0 means a surface that reflects all light (`KHR_materials_ior`).
    pub(super) ior: f64,
    /// Factor on the specular reflection of a non-metal.
    pub(super) specular: f64,
    /// A glossy material with the layers.
    pub(super) layers: MaterialDesc,
    /// 20 divided by the Abbe number of its glass; 0 without dispersion.
    pub(super) dispersion: f64,
    pub(super) scatter: Option<Scatter>,
    /// Whether it bounds a volume rather than being a thin sheet.
    pub(super) is_solid: bool,
    /// Transmittance of `attenuation_distance`.
    pub(super) attenuation_color: [f64; 3],
    /// User length; infinite without absorption.
    pub(super) attenuation_distance: f64,
    /// Radiance.
    pub(super) emission: [f64; 3],
    pub(super) is_unlit: bool,
    pub(super) textures: TexturesDesc,
}

impl Parameters {
    /// What is left of an unlit material: its base colour and its alpha, which `KHR_materials_unlit` shows alone.
    fn without_shading(self) -> Self {
        let TexturesDesc { base_color, alpha, .. } = self.textures;
        Self {
            layers: bare(),
            transmission: 0.0,
            scatter: None,
            emission: [0.0; 3],
            textures: TexturesDesc { base_color, alpha, ..TexturesDesc::default() },
            ..self
        }
    }
}

/// Reads the material; the losses of its textures are reported under `subject`.
pub(super) fn read(
    root: &Root,
    index: usize,
    textures: &Textures<'_>,
    subject: &str,
    builder: &mut SceneBuilder,
    report: &mut LoadReport,
) -> Result<Parameters, Fault> {
    let material = &root.materials[index];
    let part = label("material", index, material.name.as_deref());
    let mut means = Images { textures, part: &part, subject, builder, report };

    let none = extension::Material::default();
    let extensions = material.extensions.as_ref().unwrap_or(&none);
    factors::check(extensions, &part)?;
    let pbr = &material.pbr_metallic_roughness;
    let mut factor = pbr.base_color_factor.0.map(f64::from);
    let mut metallic = f64::from(pbr.metallic_factor.0);
    let mut roughness = f64::from(pbr.roughness_factor.0);
    let mut base_texture = pbr.base_color_texture.as_ref().map(Slot::of);
    let old = extensions.others.get(specular_glossiness::NAME).map(SpecularGlossiness::read);
    if let Some(old) = &old {
        (factor, base_texture) = (old.diffuse, old.diffuse_texture);
        (metallic, roughness) = (0.0, 1.0);
    }
    let base = means.image(base_texture, &BASE_COLOR)?;
    let texture = pbr.metallic_roughness_texture.as_ref().map(Slot::of).filter(|_| old.is_none());
    let gloss = means.image(texture, &METALLIC_ROUGHNESS)?;
    let (mean_metallic, mean_roughness) =
        gloss.map_or((metallic, roughness), |gloss| (metallic * gloss.mean.plain[2], roughness * gloss.mean.plain[1]));
    let metallic_roughness = gloss.and_then(|gloss| gloss.used);
    if metallic_roughness.is_none() {
        (metallic, roughness) = (mean_metallic, mean_roughness);
    }
    let mut glass = None;
    let transmission = match &extensions.transmission {
        None => 0.0,
        Some(transmission) => {
            let factor = f64::from(transmission.transmission_factor.0);
            let texture = transmission.transmission_texture.as_ref().map(Slot::of).filter(|_| factor > 0.0);
            glass = means.image(texture, &TRANSMISSION)?;
            factor * glass.filter(|glass| glass.used.is_none()).map_or(1.0, |glass| glass.mean.plain[0])
        }
    };
    let strength = extensions.emissive_strength.as_ref().map_or(1.0, |e| f64::from(e.emissive_strength.0));
    let emissive = material.emissive_factor.0.map(|factor| f64::from(factor) * strength);
    let is_dark = emissive == [0.0; 3];
    let texture = material.emissive_texture.as_ref().map(Slot::of).filter(|_| !is_dark);
    let glow = means.image(texture, &EMISSION)?;
    let normal_map = material.normal_texture.as_ref();
    let bumps = means.image(normal_map.map(Slot::of_normal), &NORMAL)?;
    let normal = bumps.and_then(|bumps| bumps.used);
    if normal.is_some() && normal_map.is_some_and(|info| Slot::of_normal(info).is_turned) {
        means.report.note(subject, "its normal map is turned; tangents of the file are taken to be turned with it");
    }

    let base_mean = base.map(|base| base.mean);
    let alpha_mode = match material.alpha_mode {
        Checked::Valid(Mode::Opaque) => AlphaMode::Opaque,
        Checked::Valid(Mode::Blend) => AlphaMode::Blend,
        Checked::Valid(Mode::Mask) => {
            AlphaMode::Mask { cutoff: material.alpha_cutoff.map_or(0.5, |cutoff| f64::from(cutoff.0)) }
        }
        Checked::Invalid => return Err(Fault::new(part, "has an unknown alphaMode", AGAIN)),
    };
    let is_opaque = alpha_mode == AlphaMode::Opaque;
    let even = base.filter(|base| base.used.is_none()).map_or(1.0, |base| base.mean.alpha);
    let mut color = [factor[0], factor[1], factor[2]];
    let mut ior = extensions.ior.as_ref().map_or(1.5, |ior| f64::from(ior.ior.0));
    let mut color_texture = base.and_then(|base| base.used);
    if color_texture.is_none() {
        color = times(color, base_mean.map(|mean| mean.color));
    }
    let mut old_color = None;
    let mut old_textures = [None; 2];
    if let Some(old) = &old {
        if let (Some(survey), Some(slot)) = (&textures.survey, old.texture) {
            survey.record_made(textures.image_of(slot.texture, &part)?.ok());
        }
        let texture = means.image(old.texture, &SPECULAR_GLOSSINESS)?;
        let varied = texture.and_then(|texture| texture.used);
        let mean = texture.filter(|_| varied.is_none()).map(|texture| texture.mean);
        let is_black = color == [0.0; 3];
        roughness = 1.0 - old.glossiness() * mean.as_ref().map_or(1.0, |mean| mean.alpha);
        match old.convert(mean.as_ref(), (varied.is_some(), is_black), subject, means.report) {
            Converted::Metal(reflectance) => (color, color_texture, metallic) = (reflectance, None, 1.0),
            Converted::Coat(index) => ior = index,
            Converted::Colored(specular) => (ior, old_color) = (0.0, Some(specular)),
        }
        if let (Some(used), Some(slot)) = (varied, old.texture) {
            let rough = means.roughness_of_glossiness(slot, old.glossiness())?;
            if rough.is_some() {
                roughness = 1.0;
            }
            old_textures = [Some(used), rough];
        }
    }
    let [old_specular, old_roughness] = old_textures;
    let volume = extensions.volume.as_ref();
    let specular = extensions.others.get("KHR_materials_specular");
    let slot = |name: &str| specular.and_then(|specular| Slot::of_json(specular.get(name)?));
    let coat = means.image(slot("specularTexture"), &SPECULAR)?;
    let scale = specular.and_then(|s| numbers(s, "specularFactor")).map_or(1.0, |[scale]| scale);
    let scale = scale * coat.filter(|coat| coat.used.is_none()).map_or(1.0, |coat| coat.mean.alpha);
    let (mut layers, layer_textures) = read_layers(extensions, &mut means)?;
    if let Some(color) = old_color {
        layers.specular_color = color;
    }
    let clear = extensions.others.get("KHR_materials_clearcoat").filter(|_| layers.clearcoat > 0.0);
    let coat_map = clear.and_then(|clear| Slot::of_json(clear.get("clearcoatNormalTexture")?));
    let coat_normal = means.image(coat_map, &NORMAL)?.and_then(|map| map.used);
    let coat_scale = clear.and_then(|clear| numbers(clear.get("clearcoatNormalTexture")?, "scale"));
    let turned = |slot: Option<Slot>| slot.is_some_and(|slot| slot.is_turned);
    if turned(coat_map) {
        means
            .report
            .note(subject, "the normal map of its clearcoat is turned; tangents of the file are taken to be too");
    }
    let brushed = extensions.others.get("KHR_materials_anisotropy").filter(|_| layer_textures.anisotropy.is_some());
    if turned(brushed.and_then(|brushed| Slot::of_json(brushed.get("anisotropyTexture")?))) {
        means.report.note(subject, "its anisotropy texture is turned; directions are turned with the tangents alone");
    }
    let prism = extensions.others.get(DISPERSION);
    let parameters = Parameters {
        layers,
        dispersion: prism.and_then(|prism| numbers(prism, "dispersion")).map_or(0.0, |[strength]| strength),
        scatter: Scatter::read(|name| extensions.others.get(name)),
        base: color,
        alpha: if is_opaque { 1.0 } else { factor[3] * even },
        alpha_mode,
        metallic,
        roughness,
        mean_metallic,
        transmission,
        ior,
        specular: scale,
        is_solid: volume.is_some_and(|volume| volume.thickness_factor.0 > 0.0),
        attenuation_color: volume.map_or([1.0; 3], |v| v.attenuation_color.0.map(f64::from)),
        attenuation_distance: volume.map_or(f64::INFINITY, |v| f64::from(v.attenuation_distance.0)),
        emission: times(emissive, glow.and_then(|glow| glow.color())),
        is_unlit: extensions.others.contains_key("KHR_materials_unlit"),
        textures: TexturesDesc {
            base_color: color_texture,
            emission: glow.and_then(|glow| glow.used),
            normal,
            normal_scale: normal_map.map_or(1.0, |info| f64::from(info.scale)),
            metallic_roughness: metallic_roughness.or(old_roughness),
            alpha: base.filter(|base| !is_opaque && base.mean.alpha < 1.0).and_then(|base| base.used),
            specular: coat.and_then(|coat| coat.used),
            specular_color: old_specular.or(layer_textures.specular_color),
            clearcoat_normal: coat_normal,
            clearcoat_normal_scale: coat_scale.filter(|_| coat_normal.is_some()).map_or(1.0, |[scale]| scale),
            transmission: glass.and_then(|glass| glass.used),
            ..layer_textures
        },
    };
    Ok(if parameters.is_unlit { parameters.without_shading() } else { parameters })
}

/// A glossy material without layers.
fn bare() -> MaterialDesc {
    MaterialDesc::new("", Kind::Glossy.surface())
}

/// The layers of a material, and their textures; without its leading factor a layer is not read.
fn read_layers(
    extensions: &extension::Material,
    means: &mut Images<'_, '_>,
) -> Result<(MaterialDesc, TexturesDesc), Fault> {
    let (mut layers, mut textures) = (bare(), TexturesDesc::default());
    for parameter in PARAMETERS {
        let Some(Layer { default, gltf: Some((name, factor)), leader, .. }) = parameter.layer else { continue };
        let Some(extension) = extensions.others.get(name) else { continue };
        if parameter.key != leader && !parameter.is_present(&layers) {
            continue;
        }
        let given = match default {
            Value::Number(_) => numbers(extension, factor).map(|[number]| Value::Number(number)),
            Value::Color(_) => numbers(extension, factor).map(Value::Color),
        };
        let mut value = given.unwrap_or(default);
        let is_multiplied = !parameter.is_angle && value.numbers().iter().any(|&number| number != 0.0);
        if let Some(texture) = parameter.texture().filter(|_| is_multiplied) {
            let slot = texture.gltf.last().and_then(|name| Slot::of_json(extension.get(name)?));
            let found = means.image(slot, texture)?;
            *texture.of_mut(&mut textures) = found.and_then(|found| found.used);
            if let Some(found) = found.filter(|found| found.used.is_none()) {
                value = found.factor(value, texture.channel);
            }
        }
        parameter.set(&mut layers, value);
    }
    Ok((layers, textures))
}

/// Extension of materials.
pub(super) const DISPERSION: &str = "KHR_materials_dispersion";

/// UV sets with higher numbers are treated as damage.
const MAX_UV_SETS: u32 = 64;

/// A texture of a material.
#[derive(Clone, Copy, Debug)]
struct Used {
    mean: Mean,
    /// Its use in the scene; `None` if it is the same as a factor.
    used: Option<TextureRef>,
}

impl Used {
    /// The colour of a texture that is a factor, not a texture of the scene.
    fn color(&self) -> Option<[f64; 3]> {
        self.used.is_none().then_some(self.mean.color)
    }

    /// The product of a value and the mean.
    fn factor(&self, value: Value, channel: Channel) -> Value {
        let mean = match channel {
            Channel::Red => self.mean.plain[0],
            Channel::Green => self.mean.plain[1],
            Channel::Alpha => self.mean.alpha,
            Channel::Color | Channel::Pair | Channel::Vector => 1.0,
        };
        match value {
            Value::Number(number) => Value::Number(number * mean),
            Value::Color(color) => Value::Color(times(color, Some(self.mean.color))),
        }
    }
}

/// The old extension of specular colour and glossiness, in one image.
const SPECULAR_GLOSSINESS: TextureParameter = SPECULAR.labelled("specular colour and glossiness");

/// The textures of one material.
struct Images<'a, 'b> {
    textures: &'a Textures<'b>,
    part: &'a str,
    subject: &'a str,
    builder: &'a mut SceneBuilder,
    report: &'a mut LoadReport,
}

impl Images<'_, '_> {
    /// Adds a texture to the scene, if there is one and it can be read.
    fn image(&mut self, slot: Option<Slot>, role: &TextureParameter) -> Result<Option<Used>, Fault> {
        let Some(slot) = slot else { return Ok(None) };
        if slot.uv_set >= MAX_UV_SETS {
            let why = format!("its UV set is TEXCOORD_{}, and at most {MAX_UV_SETS} are read", slot.uv_set);
            return Ok(self.lose(slot.texture, role.label, &why));
        }
        let bytes = if role.encoding == Encoding::Linear { TexelFormat::Linear8 } else { TexelFormat::Srgb8 };
        let mean = match self.textures.mean_and_image(slot.texture, bytes, self.part)? {
            Ok(mean) => mean,
            Err(why) => return Ok(self.lose(slot.texture, role.label, &why)),
        };
        if mean.is_uniform && role.channel != Channel::Vector {
            return Ok(Some(Used { mean, used: None }));
        }
        match self.textures.add(slot.texture, bytes, self.part, self.builder)? {
            Ok(texture) => {
                for loss in self.textures.losses(slot.texture) {
                    let name = self.textures.name(slot.texture);
                    self.report.note(self.subject, format!("{name} ({}): {loss}", role.label));
                }
                Ok(Some(Used { mean, used: Some(slot.used(texture)) }))
            }
            Err(why) => Ok(self.lose(slot.texture, role.label, &why)),
        }
    }

    /// The texture of roughness for one of glossiness times `factor`.
    fn roughness_of_glossiness(&mut self, slot: Slot, factor: f64) -> Result<Option<TextureRef>, Fault> {
        let made = (factor, specular_glossiness::roughness_image);
        match self.textures.add_made(slot.texture, self.part, made, self.builder)? {
            Ok(texture) => Ok(Some(slot.used(texture))),
            Err(why) => {
                self.lose::<TextureRef>(slot.texture, "glossiness", &why);
                Ok(None)
            }
        }
    }

    /// Reports a texture that cannot be used.
    fn lose<T>(&mut self, texture: usize, role: &str, why: &str) -> Option<T> {
        let name = self.textures.name(texture);
        self.report.left_out(self.subject, format!("{name} ({role}): {why}; only its factor is used"));
        None
    }
}

fn times(factor: [f64; 3], mean: Option<[f64; 3]>) -> [f64; 3] {
    let mean = mean.unwrap_or([1.0; 3]);
    std::array::from_fn(|channel| factor[channel] * mean[channel])
}

/// A number, or an array of `N` numbers, from an extension that the parser leaves as JSON.
pub(super) fn numbers<const N: usize>(extension: &Json, field: &str) -> Option<[f64; N]> {
    let value = extension.get(field)?;
    let numbers: Vec<f64> = match value {
        Json::Array(items) => items.iter().map(Json::as_f64).collect::<Option<_>>()?,
        single => vec![single.as_f64()?],
    };
    numbers.try_into().ok()
}

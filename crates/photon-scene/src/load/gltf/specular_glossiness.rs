//! `KHR_materials_pbrSpecularGlossiness`, an archived extension, in terms of the metallic-roughness model.
//!
//! It has a diffuse colour, a specular colour, which is the reflectance F0 at normal incidence with F90 = 1, and a
//! glossiness g. The roughness is 1 − g, since both models have the width (1 − g)² = roughness². The rest is a base of the
//! diffuse colour, without metal, whose specular reflectance is the specular colour: its refractive index is 0, which
//! reflects everything, times a specular colour (`KHR_materials_specular`). Two cases are simpler and the same: a metal
//! where nothing is diffuse, and a coat of a refractive index where the specular colour is grey and dim.
//!
//! The texture of both becomes two: its colours are the specular colour, and 1 − g is the green channel of a new texture.

use gltf::json::Value;

use super::mean::Mean;
use super::parameters::numbers;
use super::slot::Slot;
use crate::load::image::Image;
use crate::report::LoadReport;
use crate::shading::index_of;

pub(super) const NAME: &str = "KHR_materials_pbrSpecularGlossiness";

/// Reflectances of dielectrics are below this (diamond 0.17).
const BRIGHTEST_COAT: f64 = 0.25;

/// The extension of a material.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpecularGlossiness {
    /// Colour and alpha.
    pub(super) diffuse: [f64; 4],
    specular: [f64; 3],
    glossiness: f64,
    pub(super) diffuse_texture: Option<Slot>,
    /// Specular colour and, in alpha, glossiness.
    pub(super) texture: Option<Slot>,
}

/// The material that stands for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Converted {
    /// A metal of this reflectance.
    Metal([f64; 3]),
    /// A coat of this refractive index over the diffuse colour.
    Coat(f64),
    /// A coat of refractive index 0 and this specular colour, times that of the texture.
    Colored([f64; 3]),
}

impl SpecularGlossiness {
    pub(super) fn read(extension: &Value) -> Self {
        let slot = |name: &str| extension.get(name).and_then(Slot::of_json);
        Self {
            diffuse: numbers(extension, "diffuseFactor").unwrap_or([1.0; 4]),
            specular: numbers(extension, "specularFactor").unwrap_or([1.0; 3]),
            glossiness: numbers(extension, "glossinessFactor").map_or(1.0, |[glossiness]| glossiness),
            diffuse_texture: slot("diffuseTexture"),
            texture: slot("specularGlossinessTexture"),
        }
    }

    /// The factor of the glossiness.
    pub(super) fn glossiness(&self) -> f64 {
        self.glossiness
    }

    /// What the surface becomes. `mean` is that of [`Self::texture`] if it is used as a factor; `is_varied`: it is a texture of
    /// the scene; `is_black`: nothing is diffuse.
    pub(super) fn convert(
        &self,
        mean: Option<&Mean>,
        (is_varied, is_black): (bool, bool),
        subject: &str,
        report: &mut LoadReport,
    ) -> Converted {
        let specular: [f64; 3] =
            std::array::from_fn(|channel| self.specular[channel] * mean.map_or(1.0, |mean| mean.color[channel]));
        let mean = specular.iter().sum::<f64>() / 3.0;
        let is_grey = specular.iter().all(|part| (part - mean).abs() <= 1e-6);
        if is_black && !is_varied {
            report.note(subject, "its specular-glossiness model is taken as a metal of its specular colour");
            return Converted::Metal(specular);
        }
        if is_grey && !is_varied && mean <= BRIGHTEST_COAT {
            let ior = index_of(mean.max(0.0));
            let text = format!("its specular-glossiness model is taken as a coat of refractive index {ior:.3}");
            report.note(subject, text);
            return Converted::Coat(ior);
        }
        report.note(subject, "its specular-glossiness model is taken as a coat of its specular colour");
        Converted::Colored(specular)
    }
}

/// The image of roughness, in green, of an image of glossiness, in alpha, times `factor`; there is no metal in its blue.
pub(super) fn roughness_image(image: &Image, factor: f64) -> Vec<u32> {
    let count = image.width as usize * image.height as usize;
    let alpha = |at: usize| match image.is_float {
        true => f64::from(f32::from_bits(image.texels[4 * at + 3])),
        false => f64::from(image.texels[at].to_le_bytes()[3]) / 255.0,
    };
    let rough = |at: usize| ((1.0 - factor * alpha(at)).clamp(0.0, 1.0) * 255.0).round() as u8;
    (0..count).map(|at| u32::from_le_bytes([0, rough(at), 0, 255])).collect()
}

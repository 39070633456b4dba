//! `KHR_materials_pbrSpecularGlossiness`, an archived extension, in terms of the metallic-roughness model.
//!
//! It has a diffuse colour, a specular colour, which is the reflectance F0 at normal incidence with F90 = 1, and a
//! glossiness g. The roughness is 1 − g, since both models have the width (1 − g)² = roughness². The rest becomes one of:
//! - a metal of the specular colour, if that is brighter than the diffuse colour and than [`BRIGHTEST_COAT`]: F0 and F90
//!   are exact, the diffuse part is lost;
//! - otherwise, a base of the diffuse colour under a coat whose refractive index gives the mean of the specular colour
//!   for F0: exact if that is grey.
//!
//! The specular and glossiness texture is replaced by its mean.

use gltf::json::Value;

use super::mean::Mean;
use super::parameters::numbers;
use super::slot::Slot;
use crate::report::LoadReport;
use crate::shading::index_of;

pub(super) const NAME: &str = "KHR_materials_pbrSpecularGlossiness";

/// Reflectances of dielectrics are below this (diamond 0.17), those of metals above (titanium 0.5).
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

    /// The roughness, and what the surface becomes; `mean` is that of [`Self::texture`], `diffuse` the mean diffuse
    /// colour.
    pub(super) fn convert(
        &self,
        mean: Option<&Mean>,
        diffuse: [f64; 3],
        subject: &str,
        report: &mut LoadReport,
    ) -> (f64, Converted) {
        let specular: [f64; 3] =
            std::array::from_fn(|channel| self.specular[channel] * mean.map_or(1.0, |mean| mean.color[channel]));
        let roughness = 1.0 - self.glossiness * mean.map_or(1.0, |mean| mean.alpha);
        let grey = |color: [f64; 3]| color.iter().sum::<f64>() / 3.0;
        let average = grey(specular);
        if average > BRIGHTEST_COAT && average > grey(diffuse) {
            report.note(subject, "its specular-glossiness model is taken as a metal of its specular colour");
            if diffuse != [0.0; 3] {
                let text =
                    format!("its diffuse colour, {diffuse:.3?} on average, beside the specular colour of a metal");
                report.left_out(subject, text);
            }
            return (roughness, Converted::Metal(specular));
        }
        let ior = index_of(average.clamp(0.0, 1.0));
        let text = format!("its specular-glossiness model is taken as a coat of refractive index {ior:.3}");
        report.note(subject, text);
        if specular.iter().any(|part| (part - average).abs() > 1e-6) {
            let text = format!("its specular colour {specular:.3?} is replaced by its mean {average:.3}");
            report.approximated(subject, text);
        }
        (roughness, Converted::Coat(ior))
    }
}

//! Opaque materials of MTL: the statements `Pr` and `Pm` of the physically based extension, or `Ks` and `Ns`.

use super::Entry;
use super::translate::{HINT, Translation};
use crate::describe::Surface;
use crate::texture::TexturesDesc;

/// Refractive index of a coat without a usable `Ni`.
const COAT: f64 = 1.5;
/// Roughness without `Pr`, `map_Pr` and `Ns`.
const MIDDLE: f64 = 0.5;

impl Translation<'_> {
    /// Whether the material has a statement of the physically based extension that is read.
    pub(super) fn is_physically_based(&self) -> bool {
        let Entry { roughness, metallic, roughness_map, metallic_map, .. } = self.material;
        roughness.is_some() || metallic.is_some() || roughness_map.is_some() || metallic_map.is_some()
    }

    /// `Pr` and `Pm` times their textures; the coat of what is no metal has the index `Ni`.
    pub(super) fn physically_based(&mut self, textures: &TexturesDesc) -> Surface {
        let material = self.material;
        let of_map = |has_map: bool| has_map.then_some(1.0);
        let metallic = material.metallic.or(of_map(material.metallic_map.is_some())).unwrap_or(0.0);
        let given = material.roughness.or(of_map(material.roughness_map.is_some()));
        let roughness = given.or(material.shininess.map(roughness_of)).unwrap_or_else(|| {
            self.approximated(format!("has no roughness Pr; {MIDDLE} is taken; {HINT}"));
            MIDDLE
        });
        Surface::Glossy { base_color: self.albedo(textures), metallic, roughness, specular: 1.0, ior: self.coat() }
    }

    /// A highlight by `Ks` and `Ns`: a metal if nothing is diffuse, otherwise a coat whose reflection is multiplied by the
    /// mean of `Ks`.
    pub(super) fn highlight(&mut self, specular: [f64; 3], textures: &TexturesDesc) -> Surface {
        let material = self.material;
        let roughness = roughness_of(material.shininess.unwrap_or(0.0));
        let is_metal = material.diffuse == Some([0.0; 3]) && textures.base_color.is_none();
        let kind = if is_metal { "metal" } else { "coat" };
        self.report.note(self.subject(), format!(
            "its highlight (Ks {specular:?}, Ns {}) is taken as a {kind} of roughness {roughness:.3}; kind = \"lambert\" \
             in an override file leaves it out",
            material.shininess.unwrap_or(0.0)
        ));
        if is_metal {
            return Surface::Glossy {
                base_color: specular.map(at_most_one),
                metallic: 1.0,
                roughness,
                specular: 1.0,
                ior: COAT,
            };
        }
        let weight = at_most_one(specular.iter().sum::<f64>() / 3.0);
        let base_color = self.albedo(textures);
        Surface::Glossy { base_color, metallic: 0.0, roughness, specular: weight, ior: self.coat() }
    }

    /// `Kd`, or what stands for it.
    pub(super) fn albedo(&mut self, textures: &TexturesDesc) -> [f64; 3] {
        let diffuse = self.material.diffuse;
        if textures.base_color.is_some() && diffuse == Some([0.0; 3]) {
            self.report.note(self.subject(), "its Kd of 0 makes its texture black; give an albedo in an override file");
        }
        diffuse.or(textures.base_color.map(|_| [1.0; 3])).unwrap_or_else(|| {
            self.approximated(format!("has no Kd and is made a diffuse grey of 0.5; {HINT}"));
            [0.5; 3]
        })
    }

    /// `Ni`, unless it is the 1 of programs that do not use it.
    fn coat(&self) -> f64 {
        self.material.ior.filter(|&ior| ior > 1.0).unwrap_or(COAT)
    }
}

/// NaN stays, and is an error.
fn at_most_one(value: f64) -> f64 {
    if value > 1.0 { 1.0 } else { value }
}

/// The roughness √α of a Blinn–Phong exponent: α = √(2/(Ns + 2)), for which both distributions have the same curvature at
/// their peak (Walter et al. 2007, section 5.2).
fn roughness_of(shininess: f64) -> f64 {
    libm::sqrt(libm::sqrt(2.0 / (shininess.max(0.0) + 2.0)))
}

//! Converts an MTL material to the renderer's model.

use super::Entry;
use super::images::{Images, has_alpha};
use super::map::Map;
use crate::builder::SceneBuilder;
use crate::describe::{AlphaMode, MaterialDesc, Surface};
use crate::report::LoadReport;
use crate::texture::{TextureRef, TexturesDesc};
use photon_core::TexelFormat;

/// The conversion of one material.
pub(super) struct Translation<'a> {
    pub(super) material: &'a Entry,
    pub(super) images: &'a mut Images,
    pub(super) builder: &'a mut SceneBuilder,
    pub(super) report: &'a mut LoadReport,
}

pub(super) const HINT: &str = "give it in an override file";

impl Translation<'_> {
    pub(super) fn subject(&self) -> String {
        format!("material '{}'", self.material.name)
    }

    pub(super) fn approximated(&mut self, text: impl Into<String>) {
        self.report.approximated(self.subject(), text);
    }

    fn left_out(&mut self, text: impl Into<String>) {
        self.report.left_out(self.subject(), text);
    }

    pub(super) fn describe(mut self) -> MaterialDesc {
        let textures = self.textures();
        let surface = self.surface(&textures);
        let mut desc = MaterialDesc::new(&self.material.name, surface);
        desc.textures = textures;
        self.set_alpha(&mut desc);
        // A texture of emission without a factor is the emission.
        let factor = if textures.emission.is_some() { [1.0; 3] } else { [0.0; 3] };
        desc.emission = self.material.emissive.unwrap_or(factor);
        if !matches!(desc.surface, Surface::Lambert { .. } | Surface::Glossy { .. }) {
            if desc.textures.base_color.take().is_some() {
                self.left_out("its map_Kd: it is not diffuse");
            }
            if self.is_physically_based() && self.material.metallic.is_some() {
                self.left_out("its metal (Pm): it transmits");
            }
        }
        if desc.is_emissive() {
            let text = format!(
                "emits {:?}, taken as radiance in W/(m²·sr), from its front; an override file can make it \
                 emits_both_sides",
                desc.emission
            );
            self.report.note(self.subject(), text);
        } else if let Some(ambient) = self.material.ambient.filter(|color| color.iter().any(|&part| part > 1.0)) {
            self.left_out(format!(
                "its Ka of {ambient:?}: ambient light is not physical, but some files put emission there; if this one \
                 does, give emission in an override file"
            ));
        }
        let base = desc.textures.base_color.filter(|_| desc.textures.alpha.is_none());
        if base.is_some_and(|used| has_alpha(self.builder, used)) {
            self.left_out("the alpha of its map_Kd; name the image by map_d too, if it is meant");
        }
        self.leftovers();
        desc
    }

    /// The textures that can be read.
    fn textures(&mut self) -> TexturesDesc {
        let Entry { diffuse_map, emissive_map, normal_map, .. } = self.material;
        TexturesDesc {
            base_color: self.texture("map_Kd", diffuse_map.as_ref(), TexelFormat::Srgb8),
            emission: self.texture("map_Ke", emissive_map.as_ref(), TexelFormat::Srgb8),
            normal: self.texture("norm", normal_map.as_ref(), TexelFormat::Linear8),
            normal_scale: normal_map.as_ref().map_or(1.0, |map| map.strength),
            metallic_roughness: self.metallic_roughness(),
            alpha: self.alpha_texture(),
            ..TexturesDesc::default()
        }
    }

    /// The texture of `map_Pr` and `map_Pm`.
    fn metallic_roughness(&mut self) -> Option<TextureRef> {
        let (subject, Entry { folder, roughness_map, metallic_map, .. }) = (self.subject(), self.material);
        let maps = [roughness_map.as_ref(), metallic_map.as_ref()];
        self.images.add_metallic_roughness(folder, maps, &subject, self.builder, self.report)
    }

    /// The texture of `map_d`.
    fn alpha_texture(&mut self) -> Option<TextureRef> {
        let (subject, Entry { folder, dissolve_map, .. }) = (self.subject(), self.material);
        self.images.add_alpha(folder, dissolve_map.as_ref()?, &subject, self.builder, self.report)
    }

    /// `d`, `Tr` and `map_d`: alpha coverage, except for solids.
    fn set_alpha(&mut self, desc: &mut MaterialDesc) {
        let material = self.material;
        if material.is_tr_one {
            let text = "its Tr is 1, which would make it invisible; since some programs write that for opaque \
                        materials, it is opaque";
            self.report.note(self.subject(), text);
        }
        let dissolve = if material.is_tr_one { 1.0 } else { material.dissolve.unwrap_or(1.0) };
        if dissolve >= 1.0 && desc.textures.alpha.is_none() {
            return;
        }
        if matches!(desc.surface, Surface::Dielectric { .. }) {
            // For glass, d says how clear it is in programs without refraction.
            if desc.textures.alpha.take().is_some() {
                self.left_out("its map_d: the boundary of a solid must be closed");
            }
            return;
        }
        if dissolve < 1.0 {
            let text = format!(
                "is there for a share of {dissolve} of the light (d); kind = \"thin\" in an override file makes it a \
                 clear pane"
            );
            self.report.note(self.subject(), text);
        }
        (desc.alpha, desc.alpha_mode) = (dissolve, AlphaMode::Blend);
    }

    fn texture(&mut self, keyword: &str, map: Option<&Map>, bytes: TexelFormat) -> Option<TextureRef> {
        let (subject, folder) = (self.subject(), &self.material.folder);
        self.images.add(folder, (keyword, map?), bytes, &subject, self.builder, self.report)
    }

    fn surface(&mut self, textures: &TexturesDesc) -> Surface {
        let material = self.material;
        let illumination = material.illumination.unwrap_or(2);
        let diffuse = material.diffuse;
        let specular = material.specular.unwrap_or_default();
        let reflects = specular != [0.0; 3];
        let tint = material.filter.unwrap_or([1.0; 3]);
        let is_glass = matches!(illumination, 4 | 6 | 7 | 9);
        if is_glass && !self.is_transparent() {
            self.approximated(format!(
                "is taken as opaque, since it has a Kd, and d, Tf and Ni do not say that it is glass (illum \
                 {illumination}); kind = \"glass\" in an override file makes it glass"
            ));
        }
        if !is_glass && self.material.filters() {
            self.left_out(format!("its filter Tf {tint:?}: its illumination model {illumination} is not one of glass"));
        }
        if is_glass && self.is_transparent() {
            let ior = self.ior();
            self.approximated(format!(
                "is taken as solid glass of refractive index {ior} (illum {illumination}), whose triangles must \
                 enclose it"
            ));
            let of_map = self.material.roughness_map.is_some().then_some(1.0);
            let roughness = self.material.roughness.or(of_map).unwrap_or(0.0);
            Surface::Dielectric { ior, absorption: [0.0; 3], tint, roughness }
        } else if self.is_physically_based() {
            self.physically_based(textures)
        } else if matches!(illumination, 3 | 5) && reflects {
            if let Some(color) = diffuse.filter(|&color| color != [0.0; 3]) {
                self.left_out(format!("its diffuse part Kd {color:?} beside the mirror (illum {illumination})"));
            }
            Surface::Mirror { reflectance: specular }
        } else if illumination >= 2 && reflects {
            // Models 0 and 1 have no highlight, whatever Ks is.
            self.highlight(specular, textures)
        } else {
            Surface::Lambert { albedo: self.albedo(textures) }
        }
    }

    /// Whether light passes a material with the illumination model of glass. Many programs write that for opaque materials
    /// too: those have a colour, and neither bend nor filter light.
    fn is_transparent(&self) -> bool {
        let Entry { diffuse, diffuse_map, ior, dissolve, is_tr_one, .. } = self.material;
        let has_color = diffuse_map.is_some() || diffuse.is_some_and(|color| color != [0.0; 3]);
        let bends = match ior {
            Some(ior) => *ior != 1.0,
            None => !is_tr_one && dissolve.is_some_and(|dissolve| dissolve < 1.0),
        };
        !has_color || self.material.filters() || bends
    }

    fn ior(&mut self) -> f64 {
        let Some(ior) = self.material.ior else {
            self.approximated(format!("has no refractive index Ni; 1.5 is taken; {HINT}"));
            return 1.5;
        };
        if ior == 1.0 {
            self.report.note(self.subject(), "its refractive index Ni is 1, so that it bends no light");
        }
        ior
    }

    fn leftovers(&mut self) {
        let Entry { textures, others, flaws, .. } = self.material;
        for (kind, text) in flaws {
            self.report.push(*kind, self.subject(), text.clone());
        }
        if !textures.is_empty() {
            let list = textures.join(", ");
            // Heights have no unit in MTL.
            let is_bump = textures.iter().any(|texture| texture.to_lowercase().contains("bump "));
            let hint = if is_bump { "; make a normal map of the heights, and name it by `norm`" } else { "" };
            self.left_out(format!("its textures ({list}), which are not modelled{hint}"));
        }
        if !others.is_empty() {
            self.left_out(format!("its statements {}, which are not modelled", others.join(", ")));
        }
    }
}

//! Glossy surfaces on camera paths.
//!
//! A path leaves a query for the base there, samples a light for the reflection, and continues by it. Light that it then
//! finds itself, and light that was sampled, are weighted by the balance heuristic (Veach 1997, section 9.2.2).

use photon_core::glam::Vec3;
use photon_core::random::{BLOCK_LIGHTS, BLOCK_SURFACES, Sampler, unit_f32};
use photon_core::{
    FilmPixel, Glossy, Layer, Layers, Lobe, Material, MediumStack, Query, Reflected, ReflectionLobe,
    SurfaceInteraction, anisotropy, glossy, octahedral, offset,
};

use super::eye::{Eye, Path};
use crate::film::deposit;
use crate::stages::light_sample;
use crate::stages::light_sampler::LightSampler;

/// A reflection at a glossy surface, or a scattering at rough glass, from where lights are sampled too.
#[derive(Clone, Copy, Default)]
pub(crate) struct Reflection {
    /// Density per solid angle of the direction; 0 without such a surface, and negative if something specular lies between.
    pub(crate) pdf: f32,
    position: Vec3,
    /// Geometric normal on the side to which the path goes on.
    normal: Vec3,
    /// Whether photons show light that arrives there by way of something specular: [`photon_core::gloss_caustics`].
    shows_all: bool,
}

/// A glossy surface where a camera path arrives.
pub(crate) struct GlossyPoint<'a> {
    /// With the origin of shadow rays for its own, and the shading normal for the geometric one where that is offset:
    /// [`photon_core::shadow_terminator`].
    pub(crate) surface: &'a SurfaceInteraction,
    /// Shading normal.
    pub(crate) normal: Vec3,
    /// The media in front of it.
    pub(crate) media: MediumStack,
    pub(crate) glossy: &'a Glossy,
    /// Whether photons show caustics of all lights in its reflection.
    pub(crate) shows_all: bool,
}

/// The query that a path leaves at a glossy surface.
pub(crate) struct Leaves {
    /// Probability that the path goes on by the reflection instead, where it does not do both.
    first: f32,
    /// Throughput of the query, without `scale`, if it is certain.
    throughput: Vec3,
    scale: f32,
    /// [`Query::media`] and [`Query::coat`].
    words: [u32; 2],
    /// Of the light that the base transmits: the probability of a query on the other side, where the path leaves one for
    /// either side, and its throughput.
    transmitted: (f32, Vec3),
    /// Of the reflection of a clearcoat, left instead with its probability.
    clearcoat: Option<(f32, Vec3, [u32; 2])>,
    /// Of a sheen, left instead with its probability, if not that of the clearcoat.
    sheen: Option<(f32, Vec3, [u32; 2])>,
    /// From [`anisotropy::pack`], in scenes with anisotropy.
    anisotropy: Option<u32>,
}

impl Leaves {
    /// For the base. `seen` is the factor from radiance that leaves the surface to its contribution at the camera.
    pub(crate) fn base(at: &GlossyPoint<'_>, seen: Vec3) -> Self {
        let GlossyPoint { glossy, media, .. } = at;
        Self {
            first: glossy.specular_probability(),
            throughput: glossy.diffuse() * seen,
            scale: std::f32::consts::FRAC_1_PI,
            words: [media.bits(), glossy.coat().bits()],
            transmitted: (glossy.transmission_probability(), glossy.transmitted() * seen),
            clearcoat: None,
            sheen: None,
            anisotropy: None,
        }
    }

    /// None at all: the path goes on by the reflection.
    pub(crate) fn none() -> Self {
        let (first, throughput, words, transmitted) = (1.0, Vec3::ZERO, [0; 2], (0.0, Vec3::ZERO));
        Self { first, throughput, scale: 1.0, words, transmitted, clearcoat: None, sheen: None, anisotropy: None }
    }

    /// For the reflection of `material`: the path goes on in search of other glossy surfaces.
    pub(crate) fn reflection(
        material: &Material,
        layers: &Layers,
        glossy: &Glossy,
        mut seen: Vec3,
        anisotropy: Option<u32>,
    ) -> Self {
        let (words, factor) = ReflectionLobe::pack(material, layers);
        let mut throughput = seen * factor;
        let mut clearcoat = None;
        let share = glossy.clearcoat_probability();
        if share > 0.0 {
            let (words, factor) = ReflectionLobe::pack_clearcoat(layers);
            clearcoat = Some((share, seen * factor / share, words));
            let passed = glossy.clearcoat_through() / (1.0 - share).max(f32::EPSILON);
            seen *= passed;
            throughput *= passed;
        }
        let own = glossy.sheen_probability();
        let mut sheen = None;
        if own > 0.0 {
            sheen = Some((own, seen * layers.sheen_color / own, ReflectionLobe::pack_sheen(layers)));
            throughput *= glossy.sheen_through() / (1.0 - own).max(f32::EPSILON);
        }
        Self { first: 0.5, throughput, scale: 1.0, words, transmitted: (0.0, Vec3::ZERO), clearcoat, sheen, anisotropy }
    }
}

/// The side of a surface from which a light is sampled.
pub(crate) struct Side {
    pub(crate) start: Vec3,
    /// Geometric and shading normal on that side.
    pub(crate) normals: [Vec3; 2],
    pub(crate) media: MediumStack,
    /// Of choosing this side.
    pub(crate) probability: f32,
}

impl Reflection {
    /// After a specular surface.
    #[inline]
    pub(crate) fn before_specular(self) -> Self {
        Self { pdf: if self.pdf == 0.0 { 0.0 } else { -1.0 }, shows_all: self.shows_all, ..Self::default() }
    }

    pub(crate) fn new(pdf: f32, position: Vec3, normal: Vec3) -> Self {
        Self { pdf, position, normal, shows_all: false }
    }

    /// Whether light that the path finds is not counted in full: where shadow rays or photons find it too.
    #[inline]
    pub(crate) fn weighs_lights(&self) -> bool {
        self.pdf > 0.0 || self.shows_all
    }
}

impl Eye<'_> {
    /// Adds the light that a shadow ray from a glossy surface finds, as its reflection shows it. `seen` is the factor from
    /// radiance that leaves the surface to its contribution at the camera.
    pub(crate) fn light_reflection<const ALPHA: bool>(
        &self,
        path: &Path,
        at: &GlossyPoint<'_>,
        seen: Vec3,
        pixel: &mut FilmPixel,
        sampler: &impl Fn(u32) -> Sampler,
    ) {
        let words = sampler(path.branch).words(BLOCK_LIGHTS + path.surfaces);
        let normals = [at.surface.normal, at.normal];
        let side = Side { start: at.surface.start, normals, media: at.media, probability: 1.0 };
        let evaluate = |direction| at.glossy.evaluate(-path.ray.direction, direction, at.normal);
        if let Some(value) = self.sampled_light::<ALPHA>(words, &side, evaluate) {
            deposit(pixel, Layer::Emission, seen.into(), value.to_array().map(f64::from));
        }
    }

    /// Light that a shadow ray finds, as `evaluate` shows it: BSDF times cosine and density of a direction. Weighted for the
    /// onward ray, which may find it too.
    pub(crate) fn sampled_light<const ALPHA: bool>(
        &self,
        [choice, u, v, low]: [u32; 4],
        side: &Side,
        evaluate: impl FnOnce(Vec3) -> Reflected,
    ) -> Option<Vec3> {
        let (scene, [geometric, shading]) = (self.scene, side.normals);
        if scene.lights.is_empty() {
            return None;
        }
        let [(index, share)] = LightSampler::at(scene, side.start, geometric).pick([[choice, low]]);
        let from = offset::off_surface(side.start, geometric);
        let sampled = light_sample::sample::<true>(scene, &scene.lights[index], from, None, [u, v])?;
        let direction = sampled.ray.direction;
        let found = evaluate(direction);
        let value = sampled.times(glossy::limited(direction, geometric, shading)) * found.value;
        // NaN counts as no light.
        if !(value.max_element() > 0.0) || scene.occluded_with::<ALPHA>(&sampled.ray, || low) {
            return None;
        }
        let share = share as f32 * side.probability;
        let weight = balance(sampled.pdf * share, found.pdf);
        Some(value * scene.attenuation(&sampled.ray, sampled.ray.t_max, side.media) * (weight / share))
    }

    /// Leaves a query at a glossy surface, and continues the path by its reflection; or, where the path has split as often
    /// as it may, one of the two.
    pub(crate) fn reflect(
        &self,
        path: &mut Path,
        at: &GlossyPoint<'_>,
        leaves: &Leaves,
        queries: &mut Vec<Query>,
        query: impl Fn(Vec3, u32, [u32; 2]) -> Query,
        sampler: &impl Fn(u32) -> Sampler,
    ) -> Option<Option<Path>> {
        let (glossy, surface, first) = (at.glossy, at.surface, leaves.first);
        // The next block, as at glass: the words of this one belong to the surface before.
        path.surfaces += 1;
        let [choice, u, v, _] = sampler(path.branch).words(BLOCK_SURFACES + path.surfaces);
        let splits = first > 0.0 && first < 1.0 && path.splits < self.max_splits;
        let reflects = splits || unit_f32(choice) < first;
        if splits || !reflects {
            let share = if splits { 1.0 } else { 1.0 - first };
            let choice = unit_f32(choice);
            let choice = if splits { choice } else { glossy::rest_of(choice, first) };
            let above = leaves.clearcoat.map_or(0.0, |(probability, ..)| probability);
            let (left, words, packed, normal) = match (leaves.clearcoat, leaves.sheen) {
                (Some((probability, throughput, words)), _) if choice < probability => {
                    (throughput, words, leaves.anisotropy.and(Some(0)), glossy.coat_normal(at.normal))
                }
                (_, Some((probability, throughput, words))) if glossy::rest_of(choice, above) < probability => {
                    (throughput, words, leaves.anisotropy.and(Some(0)), at.normal)
                }
                _ => (leaves.throughput, leaves.words, leaves.anisotropy, at.normal),
            };
            let mut throughput = left * (leaves.scale / share);
            let (second, through) = leaves.transmitted;
            if second > 0.0 {
                // Light from both sides, if the path may split once more, or from one of them.
                let bit = path.splits + u32::from(splits);
                let (near, far) = match bit < self.max_splits {
                    _ if second >= 1.0 => (0.0, 1.0),
                    true => (1.0, 1.0),
                    false if choice < second => (0.0, 1.0 / second),
                    false => (1.0 / (1.0 - second), 0.0),
                };
                let beyond = through * (leaves.scale / share * far);
                throughput *= near;
                if beyond != Vec3::ZERO {
                    let branch = path.branch | if near > 0.0 { 1 << bit } else { 0 };
                    queries.push(on_other_side(query(beyond, branch, words), at.normal));
                }
            }
            if throughput != Vec3::ZERO {
                let mut query = query(throughput, path.branch, words);
                if normal != at.normal {
                    query.shading_normal = octahedral::pack(normal);
                }
                if let Some(packed) = packed {
                    query.path = anisotropy::path_word(query.path, packed);
                }
                queries.push(query);
            }
        }
        if !reflects || self.ends(path, sampler) {
            return None;
        }
        let (direction, reflected) = glossy.sample(-path.ray.direction, at.normal, unit_f32(u), unit_f32(v));
        let share = if splits { 1.0 } else { first };
        let weight = reflected.weight(glossy::limited(direction, surface.normal, at.normal) / share);
        path.throughput *= weight;
        if path.throughput == Vec3::ZERO {
            return None;
        }
        if splits {
            path.branch |= 1 << path.splits;
            path.splits += 1;
        }
        let shows_all = at.shows_all;
        path.reflected = Reflection { shows_all, ..Reflection::new(reflected.pdf, surface.start, surface.normal) };
        path.media = at.media;
        path.ray = surface.spawn(Lobe::SpecularReflection, direction);
        Some(None)
    }

    /// The weight of light that a reflected path has found itself: `pdf` is the density with which a shadow ray samples
    /// its direction once it has chosen `light`. 0 by way of something specular, where photons have the light.
    pub(crate) fn share(&self, path: &Path, light: Option<usize>, pdf: impl FnOnce() -> f32) -> f32 {
        let Some(light) = light else { return 1.0 };
        let Reflection { position, normal, pdf: reflected, .. } = path.reflected;
        if reflected < 0.0 {
            return 0.0;
        }
        let pdf = pdf();
        let chosen = LightSampler::at(self.scene, position, normal).probability(light) as f32;
        balance(reflected, pdf * chosen)
    }

    /// The density with which a shadow ray samples the direction of a reflected path that hits the triangle of `light`.
    pub(crate) fn pdf_of_light(&self, path: &Path, light: Option<usize>, distance: f32) -> f32 {
        let Some(light) = light else { return 0.0 };
        let from = offset::off_surface(path.reflected.position, path.reflected.normal);
        let light = &self.scene.lights[light];
        light_sample::pdf_of_triangle(self.scene, light, from, path.ray.direction, distance)
    }
}

/// The same query for light on the other side of a sheet, where shadow rays have no offset; `shading` is the shading normal
/// on this side.
fn on_other_side(query: Query, shading: Vec3) -> Query {
    let shading_normal = octahedral::pack(-shading);
    Query { normal: query.normal.map(|part| -part), offset_or_wo: 0, shading_normal, ..query }
}

/// The weight of a sample of density `mine` where another technique has density `other` (Veach 1997, equation 9.8). 1 for
/// a light without extent, whose density of 0 stands for one that the other technique cannot reach.
pub(crate) fn balance(mine: f32, other: f32) -> f32 {
    if mine > 0.0 { mine / (mine + other) } else { 1.0 }
}

//! Photon paths in f64, with the same random words as the shipped ones.

use photon_core::glam::DVec3;
use photon_core::random::{BLOCK_LIGHT, BLOCK_START, BLOCK_SURFACES, Domain, Sampler, centred_f32, unit_f32};
use photon_core::{
    Light, LightCone, MapKind, MaterialKind, MediumStack, Pass, interface, light_probability, pick_light,
};

use super::optics;
use super::scene::Wide;

/// A photon when it leaves a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Normalised space.
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    /// Linear RGB, in units of the total power.
    pub power: DVec3,
    /// The triangle that it leaves, or `u32::MAX`.
    pub from: u32,
    /// The media that it starts in.
    pub media: MediumStack,
}

/// A photon where it hits a diffuse surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Number of surfaces hit before.
    pub bounce: u32,
    /// The map that it is stored in.
    pub map: MapKind,
    /// Normalised space.
    pub point: DVec3,
    /// Unit vector towards where it came from.
    pub back: DVec3,
    /// Linear RGB.
    pub power: DVec3,
    /// Normal on the side where it arrived.
    pub normal: DVec3,
    /// Index of the triangle.
    pub primitive: u32,
}

/// How a path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Left the scene.
    Escaped,
    /// Absorbed by a surface.
    Absorbed,
    /// Reached the maximum path length.
    Truncated,
}

/// The first ray of a path. Spotlights and directional lights, which the study does not use, are not implemented.
#[must_use]
pub fn emit(scene: &Wide, pass: Pass, path: u32) -> Start {
    let mut sampler = Sampler::new(pass.random, pass.seed, pass.index, Domain::Photon, path);
    let [choice, a, b, side] = sampler.words(BLOCK_LIGHT);
    let [c, d, ..] = sampler.words(BLOCK_START);
    let height = f64::from(centred_f32(c)).rem_euclid(1.0);
    let [a, b, c, d] = [a, b, c, d].map(|word| f64::from(unit_f32(word)));
    let index = pick_light(&scene.light_cdf, choice);
    let light = &scene.lights[index];
    let cone = scene.light_cones.get(index).copied().flatten();
    let per_path = cone.map_or(1.0, |cone| cone.share(light)) / light_probability(&scene.light_cdf, index);
    let power = DVec3::from(light.power.map(f64::from)) * per_path;
    let mut back = false;
    let (origin, direction, from) = match light.kind {
        Light::POINT => {
            let within = |cone: LightCone| optics::within_cone(cone.axis.as_dvec3(), cone.versine.into(), c, d);
            let direction = cone.map_or_else(|| optics::uniform_sphere(height, d), within);
            (scene.light_places[index], direction, u32::MAX)
        }
        Light::TRIANGLE => {
            let root = a.sqrt();
            let (u, v) = (root * (1.0 - b), root * b);
            let front = scene.normals[light.primitive as usize];
            back = light.flags & Light::BOTH_SIDES != 0 && side >> 31 == 1;
            let normal = if back { -front } else { front };
            let point = scene.point(light.primitive as usize, u, v);
            (point + normal * scene.step, optics::cosine_hemisphere(normal, c, d), light.primitive)
        }
        kind => panic!("no twin of light {kind}"),
    };
    let media = scene.light_media[index][usize::from(back)];
    Start { origin, direction, power, from, media }
}

/// Parameters of path tracing.
#[derive(Clone, Copy, Debug)]
pub struct Twin<'a> {
    /// The scene.
    pub scene: &'a Wide,
    /// Key of the random numbers.
    pub pass: Pass,
    /// Maximum number of surfaces.
    pub max_bounces: u32,
}

impl Twin<'_> {
    /// Traces one path to its end.
    #[must_use]
    pub fn follow(&self, start: &Start, path: u32) -> (Vec<Landing>, End) {
        let scene = self.scene;
        let mut sampler = Sampler::new(self.pass.random, self.pass.seed, self.pass.index, Domain::Photon, path);
        let mut landings = Vec::new();
        let Start { mut origin, mut direction, mut power, mut from, mut media } = *start;
        let mut specular_only = true;
        for bounce in 0..self.max_bounces {
            let Some(hit) = scene.tree.nearest(origin, direction, f64::INFINITY, from) else {
                return (landings, End::Escaped);
            };
            let primitive = hit.primitive as usize;
            let point = scene.point(primitive, hit.u, hit.v);
            let front = direction.dot(scene.normals[primitive]) < 0.0;
            let normal = if front { scene.normals[primitive] } else { -scene.normals[primitive] };
            let cosine = -direction.dot(normal);
            let material = &scene.materials[scene.material_of[primitive] as usize];
            let sides = interface(&scene.media, material, front, media, true);
            let before = &scene.media[sides.before.current(&scene.media) as usize];
            power *= DVec3::from(before.absorption.map(|sigma| (-f64::from(sigma) * hit.t).exp()));
            let [choice, u, v, _] = sampler.words(BLOCK_SURFACES + bounce).map(|word| f64::from(unit_f32(word)));
            let mut albedo = DVec3::from(material.albedo.map(f64::from));
            if material.kind() == MaterialKind::Mirror {
                albedo += (1.0 - albedo) * f64::from(material.metallic) * (1.0 - cosine).powi(5);
            }
            let russian_roulette = |power: DVec3| {
                let next = power * albedo;
                let chance = next.max_element() / power.max_element();
                (choice < chance).then(|| next / chance)
            };
            match material.kind() {
                MaterialKind::Mirror => {
                    let Some(next) = russian_roulette(power) else { return (landings, End::Absorbed) };
                    power = next;
                    (origin, direction) = (point + normal * scene.step, optics::reflect(direction, normal));
                }
                MaterialKind::Dielectric | MaterialKind::Thin => {
                    let solid = material.kind() == MaterialKind::Dielectric;
                    let index = |stack: MediumStack| f64::from(scene.media[stack.current(&scene.media) as usize].ior);
                    let eta =
                        if solid { index(sides.transmitted) / index(sides.before) } else { f64::from(material.ior) };
                    let (single, transmitted) = optics::fresnel(cosine, eta);
                    let reflectance = if solid { single } else { optics::sheet(single) };
                    if choice < reflectance {
                        (origin, direction) = (point + normal * scene.step, optics::reflect(direction, normal));
                    } else {
                        if sides.is_active {
                            power *= albedo;
                        }
                        if solid {
                            direction = optics::refract(direction, normal, eta, transmitted);
                            media = sides.transmitted;
                        }
                        origin = point - normal * scene.step;
                    }
                }
                MaterialKind::Lambert => {
                    let map = MapKind::of_path(specular_only, bounce);
                    if material.albedo != [0.0; 3] {
                        let primitive = hit.primitive;
                        landings.push(Landing { bounce, map, point, back: -direction, power, normal, primitive });
                    }
                    let Some(next) = russian_roulette(power) else { return (landings, End::Absorbed) };
                    power = next;
                    specular_only = false;
                    (origin, direction) = (point + normal * scene.step, optics::cosine_hemisphere(normal, u, v));
                }
                other => panic!("the twin has no such material: {other:?}"),
            }
            from = hit.primitive;
        }
        (landings, End::Truncated)
    }
}

//! How photons are distributed over the lights of a scene: a report of lights that get too few.

use crate::scene::light::Light;
use crate::scene::{SceneView, light_probability};
use crate::shading::light_cone::LightCone;

/// A light; all emissive triangles of one material count as one area light.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LightShare {
    /// Description: kind and index of the light, or index of the material of an area light.
    pub what: String,
    /// Number of entries in [`SceneView::lights`] that belong to it.
    pub lights: usize,
    /// Its share of the power that leaves towards the scene, mean of RGB, in `[0, 1]`.
    pub power: f64,
    /// The probability that a light path starts at it, in `(0, 1]`.
    pub probability: f64,
}

impl LightShare {
    /// With fewer paths, its light is seen in blotches or not at all.
    pub const MIN_PATHS: f64 = 64.0;

    /// Expected number of paths from this light, among `of` paths.
    #[must_use]
    pub fn paths(&self, of: u32) -> f64 {
        self.probability * f64::from(of)
    }

    /// Whether a pass with `of` paths has too few from this light to show its effect.
    #[must_use]
    pub fn starves(&self, of: u32) -> bool {
        self.paths(of) < Self::MIN_PATHS
    }
}

/// The lights of a scene, in order, with their shares.
#[must_use]
pub fn light_shares(scene: &SceneView<'_>) -> Vec<LightShare> {
    let mean = |light: &Light| light.power.iter().map(|&power| f64::from(power)).sum::<f64>() / 3.0;
    let arriving = LightCone::arriving(scene);
    let total: f64 = scene.lights.iter().zip(&arriving).map(|(light, arriving)| arriving * mean(light)).sum();
    let mut shares: Vec<LightShare> = Vec::new();
    let mut area_lights: Vec<Option<usize>> = vec![None; scene.materials.len()];
    for (index, light) in scene.lights.iter().enumerate() {
        let power = if total > 0.0 { arriving[index] * mean(light) / total } else { 0.0 };
        let probability = light_probability(scene.light_cdf, index);
        let material = scene.primitives.get(light.primitive as usize).map(|primitive| primitive.material as usize);
        let known = material.and_then(|material| area_lights.get(material).copied().flatten());
        if let Some(area_light) = known {
            shares[area_light].lights += 1;
            shares[area_light].power += power;
            shares[area_light].probability += probability;
            continue;
        }
        let what = match (light.kind, material) {
            (_, Some(material)) => {
                if let Some(area_light) = area_lights.get_mut(material) {
                    *area_light = Some(shares.len());
                }
                format!("area light of material {material}")
            }
            (Light::POINT, _) => format!("point light {index}"),
            (Light::SPOT, _) => format!("spot light {index}"),
            (Light::ENVIRONMENT, _) => "the environment".to_owned(),
            _ => format!("directional light {index}"),
        };
        shares.push(LightShare { what, lights: 1, power, probability });
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::light_cdf;
    use crate::scene::material::{Material, Primitive};
    use crate::scene::units::Units;

    #[test]
    fn an_area_light_is_one_and_a_weak_light_is_told_from_a_starving_one() {
        let primitives = [0, 1, 1].map(|material| Primitive { normal: [0.0, 1.0, 0.0], material });
        let materials = [Material::default(); 2];
        let light = |kind, primitive, power| Light { kind, primitive, power: [power; 3], ..Light::default() };
        let lights =
            [light(Light::TRIANGLE, 1, 0.25), light(Light::POINT, u32::MAX, 1e-20), light(Light::TRIANGLE, 2, 0.75)];
        let scene = SceneView {
            positions: &[],
            triangles: &[],
            primitives: &primitives,
            materials: &materials,
            media: &[crate::scene::medium::Medium::VACUUM],
            lights: &lights,
            light_cdf: &light_cdf(&[0.25, 1e-20, 0.75]),
            radius: 1.0,
            units: Units::default(),
            ..SceneView::default()
        };
        let shares = light_shares(&scene);
        assert_eq!(shares.len(), 2);
        assert_eq!((shares[0].what.as_str(), shares[0].lights), ("area light of material 1", 2));
        assert_eq!((shares[1].what.as_str(), shares[1].lights), ("point light 1", 1));
        assert!((shares.iter().map(|share| share.probability).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((shares[0].power - 1.0).abs() < 1e-12 && shares[1].power < 1e-19);
        // A sixty-fourth is distributed evenly over three.
        assert!((shares[1].paths(192_000) - 1000.0).abs() < 0.01);
        assert!(!shares[1].starves(192_000) && shares[1].starves(12_000) && !shares[0].starves(12_000));
    }
}

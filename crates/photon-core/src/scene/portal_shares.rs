//! How much of the light from infinitely far away passes portals: a report.

use std::f64::consts::PI;

use glam::Vec3;

use crate::scene::light::Light;
use crate::scene::{SceneView, light_probability};
use crate::shading::portals::{DISC_SHARE, total_area};

/// Directions of an environment that are sampled, in each of two dimensions.
const STEPS: u32 = 64;

/// What part of the light of infinitely distant lights passes portals, whether or not anything is in its way.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PortalShares {
    /// Share of the flux through the discs that photons would start from without portals; light that passes two portals
    /// counts twice. In `[0, 1]`.
    pub light: f64,
    /// Share of the photons of these lights that pass a portal, in `[0, 1]`.
    pub photons: f64,
}

/// The shares of a scene; `None` without portals, and without an infinitely distant light.
#[must_use]
pub fn portal_shares(scene: &SceneView<'_>) -> Option<PortalShares> {
    if scene.portals.is_empty() {
        return None;
    }
    let (mut power, mut light, mut chance, mut photons) = (0.0, 0.0, 0.0, 0.0);
    for (index, source) in scene.lights.iter().enumerate() {
        let radius = f64::from(source.radius);
        let part =
            |direction: Vec3| (f64::from(total_area(scene.portals, direction)) / (PI * radius * radius)).min(1.0);
        let (of_light, of_photons) = match source.kind {
            Light::DIRECTIONAL => {
                let part = part(source.direction.into());
                (part, started(part))
            }
            Light::ENVIRONMENT => environment(scene, part),
            _ => continue,
        };
        let probability = light_probability(scene.light_cdf, index);
        let mean = source.power.iter().map(|&p| f64::from(p)).sum::<f64>() / 3.0;
        (power, light) = (power + mean, light + mean * of_light);
        (chance, photons) = (chance + probability, photons + probability * of_photons);
    }
    (power > 0.0).then(|| PortalShares { light: light / power, photons: photons / chance })
}

/// Share of the photons along a direction that pass portals, if they cover `part` of the disc.
fn started(part: f64) -> f64 {
    let disc = f64::from(DISC_SHARE);
    if part > 0.0 { disc * part + (1.0 - disc) } else { 0.0 }
}

/// Shares of the light and of the photons of the environment, over directions as its photons have.
fn environment(scene: &SceneView<'_>, part: impl Fn(Vec3) -> f64) -> (f64, f64) {
    let Some(map) = scene.environment else { return (0.0, 0.0) };
    let (mut flux, mut through, mut photons) = (0.0, 0.0, 0.0);
    for step in 0..STEPS * STEPS {
        let word = |at: u32| (u64::from(2 * at + 1) << 31).wrapping_div(u64::from(STEPS)) as u32;
        let found = map.sample([word(step / STEPS), word(step % STEPS)]);
        let weight = f64::from(found.weight.element_sum());
        let part = part(found.direction);
        (flux, through, photons) = (flux + weight, through + weight * part, photons + started(part));
    }
    (if flux > 0.0 { through / flux } else { 0.0 }, photons / f64::from(STEPS * STEPS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::environment::EnvironmentMap;
    use crate::scene::portal::Portal;

    /// Under an even environment, the mean of |n·ω| over directions is ½: a portal of area A has a share of A/(2πR²). For a
    /// directional light it is A |n·ω|/(πR²), and of the photons half, and half of that share, pass.
    #[test]
    fn shares_of_a_portal() {
        let portals = [Portal::new([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.1]])];
        let map = EnvironmentMap::constant([1.0; 3]).unwrap();
        let radius = 0.5;
        let sky = [Light { kind: Light::ENVIRONMENT, radius, power: [1.0; 3], ..Light::default() }];
        let disc = PI * f64::from(radius) * f64::from(radius);
        let scene = SceneView {
            portals: &portals,
            lights: &sky,
            light_cdf: &[0],
            environment: Some(&map),
            ..SceneView::default()
        };
        let even = portal_shares(&scene).unwrap();
        let part = 0.01 / (2.0 * disc);
        assert!((even.light / part - 1.0).abs() < 1e-3, "{even:?} instead of {part}");
        assert!((even.photons - (0.5 + 0.5 * part)).abs() < 1e-5, "{even:?}");

        let direction = [0.0, -0.8, 0.6];
        let sun = [Light { kind: Light::DIRECTIONAL, direction, radius, power: [1.0; 3], ..Light::default() }];
        let parallel = portal_shares(&SceneView { lights: &sun, environment: None, ..scene }).unwrap();
        assert!((parallel.light / (0.008 / disc) - 1.0).abs() < 1e-5, "{parallel:?}");
        let point = [Light { kind: Light::POINT, power: [1.0; 3], ..Light::default() }];
        assert_eq!(portal_shares(&SceneView { lights: &point, environment: None, ..scene }), None);
        assert_eq!(portal_shares(&SceneView { portals: &[], ..scene }), None);
    }
}

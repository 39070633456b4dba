//! Bounds of lights: box, cone of normals, intensity; and how much a node with such bounds costs.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};

use super::{COSINE_STEPS, LightNode};
use crate::scene::SceneView;
use crate::scene::light::Light;
use crate::shading::octahedral;
use crate::shading::sampling::spot_solid_angle;

/// Largest intensity of a node, so that importances stay finite: divided by the smallest squared distance it is 1e32.
const MAX_INTENSITY: f64 = 1e20;

/// Bounds of one or more lights.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightBounds {
    /// Corners of the bounding box; for lights at infinity, of the unit vectors towards them.
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    /// Axis and half angle of the cone that contains the normals.
    axis: DVec3,
    spread: f64,
    /// Angle about the normals within which the lights emit.
    emission: f64,
    intensity: f64,
}

/// Whether a light is infinitely far away.
pub(super) fn is_infinite(light: &Light) -> bool {
    matches!(light.kind, Light::DIRECTIONAL | Light::ENVIRONMENT)
}

impl LightBounds {
    pub(super) fn of(scene: &SceneView<'_>, light: &Light) -> Self {
        let power = light.power.iter().map(|&part| f64::from(part)).sum::<f64>() / 3.0;
        let direction = Vec3::from(light.direction).as_dvec3();
        let disc = PI * f64::from(light.radius) * f64::from(light.radius);
        // Of a spot without width, or a directional light without a disc, infinite.
        let limited = |intensity: f64| if power > 0.0 { intensity.min(MAX_INTENSITY) } else { 0.0 };
        let at = |position: DVec3, axis, spread, emission, intensity| Self {
            low: position,
            high: position,
            axis,
            spread,
            emission,
            intensity: limited(intensity),
        };
        let position = Vec3::from(light.position).as_dvec3();
        let angle = |versine: f32| 2.0 * libm::asin(f64::from(0.5 * versine).sqrt().min(1.0));
        match light.kind {
            Light::TRIANGLE => {
                let primitive = light.primitive as usize;
                let corner = |vertex: u32| Vec3::from(scene.positions[vertex as usize]).as_dvec3();
                let [a, b, c] = scene.triangles[primitive].map(corner);
                let normal = Vec3::from(scene.primitives[primitive].normal).as_dvec3();
                let both = light.flags & Light::BOTH_SIDES != 0;
                let (spread, power) = if both { (PI, 0.5 * power) } else { (0.0, power) };
                let (low, high) = (a.min(b).min(c), a.max(b).max(c));
                Self { low, high, axis: normal, spread, emission: FRAC_PI_2, intensity: power / PI }
            }
            Light::SPOT => {
                let (inner, outer) = (angle(light.versine_inner), angle(light.versine_outer));
                let emission = (outer - inner).min(FRAC_PI_2);
                let intensity = power / spot_solid_angle(light.versine_inner, light.versine_outer);
                at(position, direction, outer - emission, emission, intensity)
            }
            // The cone is that of the directions to the disc of a sun.
            Light::DIRECTIONAL => at(-direction, -direction, angle(light.versine_outer), 0.0, power / disc),
            Light::ENVIRONMENT => at(DVec3::ZERO, DVec3::Y, PI, 0.0, power / (4.0 * disc)),
            _ => at(position, DVec3::Y, PI, FRAC_PI_2, power / (4.0 * PI)),
        }
    }

    /// Twice the centre of the box.
    pub(super) fn centroid(&self) -> DVec3 {
        self.low + self.high
    }

    pub(super) fn union(&self, other: &Self) -> Self {
        let (axis, spread) = cone_union((self.axis, self.spread), (other.axis, other.spread));
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            axis,
            spread,
            emission: self.emission.max(other.emission),
            intensity: self.intensity + other.intensity,
        }
    }

    /// Intensity × measure of the directions × squared diagonal: Conty Estevez and Kulla 2018, equation 1, with the
    /// squared diagonal for the surface, which is 0 for lights on a line.
    pub(super) fn cost(&self) -> f64 {
        let (spread, widest) = (self.spread, (self.spread + self.emission).min(PI));
        let (sin, cos) = (libm::sin(spread), libm::cos(spread));
        let rim = 2.0 * widest * sin - libm::cos(spread - 2.0 * widest) - 2.0 * spread * sin + cos;
        let directions = TAU * (1.0 - cos) + FRAC_PI_2 * rim;
        self.intensity * directions * (self.high - self.low).length_squared()
    }

    /// The node of these bounds.
    pub(super) fn node(&self, infinite: bool, next: u32) -> LightNode {
        let center = (0.5 * self.centroid()).as_vec3();
        // From the rounded centre, rounded up.
        let half = (self.high - center.as_dvec3()).max(center.as_dvec3() - self.low).length();
        let radius = if infinite { -1.0 } else { (half * (1.0 + 1e-6)) as f32 };
        let steps = |angle: f64| (libm::cos(angle) * f64::from(COSINE_STEPS)).floor() as i32 as u32 & 0xFFFF;
        LightNode {
            center: center.to_array(),
            radius,
            intensity: self.intensity.min(MAX_INTENSITY) as f32,
            axis: octahedral::pack(self.axis.as_vec3()),
            cone: steps(self.spread) | steps(self.emission) << 16,
            next,
        }
    }
}

/// A cone that contains two: axes and half angles.
fn cone_union(a: (DVec3, f64), b: (DVec3, f64)) -> (DVec3, f64) {
    let (a, b) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    if a.1 >= PI || a.0 == b.0 {
        return a;
    }
    let cosine = a.0.dot(b.0).clamp(-1.0, 1.0);
    let between = libm::acos(cosine);
    if between + b.1 <= a.1 {
        return a;
    }
    let spread = 0.5 * (a.1 + between + b.1);
    let sine = libm::sqrt(1.0 - cosine * cosine);
    if spread >= PI || sine < 1e-6 {
        return (a.0, if cosine > 0.0 { spread.min(PI) } else { PI });
    }
    let turn = spread - a.1;
    let axis = a.0 * (libm::sin(between - turn) / sine) + b.0 * (libm::sin(turn) / sine);
    (axis.normalize_or(a.0), spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The union contains both cones, and none is wider than it must be.
    #[test]
    fn unions_of_cones_contain_both() {
        let direction = |turn: f64, height: f64| {
            let r = (1.0 - height * height).sqrt();
            DVec3::new(r * (TAU * turn).cos(), height, r * (TAU * turn).sin())
        };
        let contains = |cone: (DVec3, f64), of: (DVec3, f64)| {
            cone.1 >= PI || cone.0.dot(of.0).clamp(-1.0, 1.0).acos() + of.1 <= cone.1 + 1e-7
        };
        for step in 0..2000_u32 {
            let part = |factor: f64| (f64::from(step) * factor).fract();
            let cone = |k: f64| {
                let spread = PI * part(0.618_034 * k).powi(2) * f64::from(step % 7 != 0);
                (direction(part(0.754_878 * k), 2.0 * part(0.569_84 * k) - 1.0), spread)
            };
            let (a, b) = (cone(1.0), if step % 5 == 0 { (-cone(1.0).0, 0.1) } else { cone(1.37) });
            let both = cone_union(a, b);
            assert!(contains(both, a) && contains(both, b), "{a:?} {b:?}: {both:?}");
            let least = 0.5 * (a.0.dot(b.0).clamp(-1.0, 1.0).acos() + a.1 + b.1);
            // Between opposite axes any other would do: all directions instead.
            let opposite = a.0.dot(b.0) < -1.0 + 1e-12;
            assert!(both.1 <= least.max(a.1).max(b.1).min(PI) + 1e-7 || opposite, "{both:?}");
        }
    }

    /// The importance is above 0 wherever a light of the node shines, and for a light that is a point it is its irradiance.
    #[test]
    fn importance_of_a_point_light_is_its_irradiance() {
        let light = Light { kind: Light::POINT, power: [3.0; 3], position: [0.0, 0.0, 0.25], ..Light::default() };
        let node = LightBounds::of(&SceneView::default(), &light).node(false, 0);
        let found = node.importance(Vec3::new(0.25, 0.0, 0.0), Vec3::Z);
        let expected = 3.0 / (4.0 * PI) * 0.5_f64.sqrt() / 0.125;
        assert!((f64::from(found) / expected - 1.0).abs() < 1e-4, "{found} instead of {expected}");
        assert_eq!(node.importance(Vec3::new(0.25, 0.0, 0.0), -Vec3::Z), 0.0);
    }
}

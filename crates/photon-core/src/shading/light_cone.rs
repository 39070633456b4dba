//! Point and spot lights that stand outside of a scene, whose photons leave only towards it.

use glam::{DVec3, Vec3};

use crate::scene::SceneView;
use crate::scene::light::Light;
use crate::scene::medium::Medium;
use crate::shading::sampling;

/// The directions in which a point or spot light has photons: evenly within a cone around a sphere that contains all surfaces.
/// Light that leaves elsewhere meets nothing: from ten radii away, 99.7 % of that of a point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightCone {
    /// Unit vector towards the middle of the sphere.
    pub axis: Vec3,
    /// 1 − cos of the angle to its rim, in `(0, 1)`.
    pub versine: f32,
}

/// A sphere around points; room is left for rounding.
#[derive(Clone, Copy, Debug)]
struct Sphere {
    centre: DVec3,
    radius: f64,
}

impl LightCone {
    /// Cone of each light: `None` for lights of other kinds, for those within the sphere, and for spot lights whose own cone
    /// is narrower. Empty if there is none at all, or if photons may also meet a medium outside of the sphere. Solids are
    /// taken to be closed.
    #[must_use]
    pub fn of_lights(scene: &SceneView<'_>) -> Vec<Option<Self>> {
        let has_place = |light: &Light| matches!(light.kind, Light::POINT | Light::SPOT);
        if !scene.lights.iter().any(has_place) || scene.media.first() != Some(&Medium::VACUUM) {
            return Vec::new();
        }
        let Some(sphere) = Sphere::around(scene) else { return Vec::new() };
        let cone = |light: &Light| Self::new(light, sphere).filter(|_| has_place(light));
        let cones: Vec<_> = scene.lights.iter().map(cone).collect();
        if cones.iter().any(Option::is_some) { cones } else { Vec::new() }
    }

    fn new(light: &Light, sphere: Sphere) -> Option<Self> {
        let gap = sphere.centre - Vec3::from(light.position).as_dvec3();
        let distance = gap.length();
        // Directions are rounded, by more than the surfaces are wide if these are far away.
        let radius = sphere.radius * (1.0 + 1e-4) + distance * (4.0 * f64::from(f32::EPSILON));
        if !(distance > radius) {
            return None;
        }
        let squared_sine = (radius / distance) * (radius / distance);
        // Without the difference of 1 and a cosine.
        let versine = squared_sine / (1.0 + (1.0 - squared_sine).sqrt());
        let cone = Self { axis: (gap / distance).as_vec3().normalize(), versine: versine as f32 };
        (cone.share(light) < 1.0).then_some(cone)
    }

    /// Share of each light's power that leaves towards the scene, in `[0, 1]`: 1 for those without a cone. That of spot
    /// lights is a mean over 256 directions.
    #[must_use]
    pub fn arriving(scene: &SceneView<'_>) -> Vec<f64> {
        let cones = Self::of_lights(scene);
        let of_light = |(index, light): (usize, &Light)| {
            let cone: Option<Self> = cones.get(index).copied().flatten();
            cone.map_or(1.0, |cone| cone.share(light) * cone.mean_intensity(light))
        };
        scene.lights.iter().enumerate().map(of_light).collect()
    }

    /// Mean intensity over the greatest, by the midpoint rule.
    fn mean_intensity(&self, light: &Light) -> f64 {
        const SIDE: u16 = 16;
        let at = |index: u16| (f32::from(index) + 0.5) / f32::from(SIDE);
        let samples = (0..SIDE * SIDE).map(|index| self.sample(light, at(index / SIDE), at(index % SIDE)).1);
        samples.map(f64::from).sum::<f64>() / f64::from(SIDE * SIDE)
    }

    /// The power of a photon over that of one without a cone. Of a point light it is the share of the power within the cone; of a
    /// spot light it would be at full intensity.
    #[must_use]
    pub fn share(&self, light: &Light) -> f64 {
        let versine = f64::from(self.versine);
        if light.kind == Light::SPOT {
            return std::f64::consts::TAU * versine
                / sampling::spot_solid_angle(light.versine_inner, light.versine_outer);
        }
        0.5 * versine
    }

    /// Samples a direction within the cone, from `u` in `[0, 1)` and `turns` around its axis; and the intensity of the light in
    /// that direction over the greatest. Where a spot light is dark, the direction is the opposite one, away from the scene: the
    /// path ends at once.
    #[inline]
    #[must_use]
    pub fn sample(&self, light: &Light, u: f32, turns: f32) -> (Vec3, f32) {
        let direction = sampling::about(self.axis, self.versine * u, turns);
        if light.kind == Light::SPOT {
            let off = sampling::versine(direction, light.direction.into());
            let intensity = sampling::spot_falloff(off, light.versine_inner, light.versine_outer);
            return (if intensity > 0.0 { direction } else { -direction }, intensity);
        }
        (direction, 1.0)
    }
}

impl Sphere {
    /// Around all vertices of a scene, and those of boundaries of media; `None` without any.
    fn around(scene: &SceneView<'_>) -> Option<Self> {
        let wide = |at: &[f32; 3]| Vec3::from(*at).as_dvec3();
        let scale = f64::from(scene.boundaries.scale);
        let points =
            || scene.positions.iter().map(wide).chain(scene.boundaries.positions.iter().map(|at| wide(at) * scale));
        let first = points().next()?;
        let (low, high) = points().fold((first, first), |(low, high), at| (low.min(at), high.max(at)));
        let centre = 0.5 * (low + high);
        let squared = points().map(|at| at.distance_squared(centre)).fold(0.0, f64::max);
        Some(Self { centre, radius: squared.sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of a square of side 2, whose sphere has the radius √2.
    const POSITIONS: [[f32; 3]; 4] = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];

    fn cones(lights: &[Light]) -> Vec<Option<LightCone>> {
        LightCone::of_lights(&SceneView { positions: &POSITIONS, lights, ..SceneView::default() })
    }

    fn point(y: f32) -> Light {
        Light { kind: Light::POINT, position: [0.0, y, 0.0], ..Light::default() }
    }

    fn spot(outer: f32) -> Light {
        aimed([0.0, -1.0, 0.0], outer)
    }

    fn aimed(direction: [f32; 3], outer: f32) -> Light {
        Light { kind: Light::SPOT, direction, versine_inner: 0.5 * outer, versine_outer: outer, ..point(4.0) }
    }

    #[test]
    fn only_lights_outside_that_would_miss_have_cones() {
        // At the distance 4 the sine is √2/4.
        let versine = 1.0 - (1.0 - 2.0_f64 / 16.0).sqrt();
        let near =
            |cone: Option<LightCone>| cone.is_some_and(|cone| (f64::from(cone.versine) / versine - 1.0).abs() < 1e-3);
        let found =
            cones(&[point(1.4), point(4.0), spot(0.5), spot(0.05), Light { kind: Light::DIRECTIONAL, ..point(4.0) }]);
        assert!(near(found[1]) && near(found[2]), "{found:?}");
        assert_eq!([found[0], found[3], found[4]], [None; 3]);
        assert_eq!(found[1].map(|cone| cone.axis), Some(Vec3::NEG_Y));
        assert!(cones(&[point(1.4), spot(0.05)]).is_empty());
        let fog = Medium { scattering: [1.0; 3], ..Medium::VACUUM };
        let lights = [point(4.0)];
        let scene = SceneView { positions: &POSITIONS, lights: &lights, media: &[fog], ..SceneView::default() };
        assert!(LightCone::of_lights(&scene).is_empty());
    }

    /// From a million radii away, where the cosine of the angle is 1 in f32.
    #[test]
    fn far_cones_cover_the_sphere() {
        let light = Light { position: [0.6e6, 0.8e6, 0.0], ..point(0.0) };
        let [Some(cone)] = cones(&[light])[..] else { panic!("no cone") };
        let sine = 2.0_f64.sqrt() / 1e6;
        assert!((f64::from(cone.versine) / (0.5 * sine * sine) - 1.0).abs() < 1.0, "{}", cone.versine);
        let (rim, _) = cone.sample(&light, 1.0, 0.3);
        let off = f64::from(sampling::versine(rim, cone.axis));
        assert!((off / f64::from(cone.versine) - 1.0).abs() < 0.1, "{off}");
        assert!((cone.share(&light) / (0.5 * f64::from(cone.versine)) - 1.0).abs() < 1e-12);
    }

    /// A spot whose intensity falls within the cone, by the integral of `((outer − v)/(outer − inner))²` over versines v; and
    /// one that is aimed aside, whose photons leave towards the scene only where it shines.
    #[test]
    fn spots_keep_their_power_within_the_cone() {
        let arriving = |light: Light| {
            let lights = [light];
            LightCone::arriving(&SceneView { positions: &POSITIONS, lights: &lights, ..SceneView::default() })[0]
        };
        let light = spot(0.11);
        let [Some(cone)] = cones(&[light])[..] else { panic!("no cone") };
        let [inner, outer, rim] = [0.055, 0.11, f64::from(cone.versine)];
        assert!(inner < rim && rim < outer);
        let x = (outer - rim) / (outer - inner);
        let within = inner + (outer - inner) * (1.0 - x.powi(3)) / 3.0;
        let all = inner + (outer - inner) / 3.0;
        assert!((arriving(light) / (within / all) - 1.0).abs() < 1e-3, "{}", arriving(light));
        let light = aimed([0.6, -0.8, 0.0], 0.2);
        let [Some(cone)] = cones(&[light])[..] else { panic!("no cone") };
        let found: Vec<_> = (0..64).map(|i| cone.sample(&light, 0.99, i as f32 / 64.0)).collect();
        assert!(found.iter().all(|(direction, intensity)| (*intensity > 0.0) == (direction.y < 0.0)));
        let dark = found.iter().filter(|(_, intensity)| *intensity == 0.0).count();
        assert!((1..63).contains(&dark), "{dark}");
        assert!(arriving(light) > 0.0 && arriving(light) < cone.share(&light));
        assert_eq!([arriving(aimed([0.0, 1.0, 0.0], 0.2)), arriving(point(1.0))], [0.0, 1.0]);
    }
}

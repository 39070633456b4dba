//! Samples of lights, for shadow rays.

use photon_core::glam::Vec3;
use photon_core::random::unit_f32;
use photon_core::solid_angle::{self, Seen};
use photon_core::{Features, Light, Ray, offset, sampling};

use crate::scene::CpuScene;

/// A sampled direction towards a light.
pub(crate) struct LightSample {
    /// The shadow ray: from the surface to the light.
    pub(crate) ray: Ray,
    color: Vec3,
    factor: f32,
    divisor: f32,
    /// Density per solid angle of the direction, if this light was chosen; 0 for a light without extent, which nothing
    /// but a shadow ray can find.
    pub(crate) pdf: f32,
}

impl LightSample {
    /// Unoccluded radiance over the density of the sample, times `cosine`: its contribution to irradiance.
    #[inline]
    pub(crate) fn times(&self, cosine: f32) -> Vec3 {
        self.color * (self.factor * cosine / self.divisor)
    }
}

/// Samples light from infinity, that of a directional light or of the environment; `None` for other lights.
#[inline(always)]
pub(crate) fn sample_far(scene: &CpuScene, light: &Light, from: Vec3, [u, v]: [u32; 2]) -> Option<LightSample> {
    if light.kind == Light::DIRECTIONAL {
        let area = std::f32::consts::PI * light.radius * light.radius;
        let (mut direction, mut factor) = (-Vec3::from(light.direction), 1.0);
        if light.is_sun() {
            let versine = sampling::sun_versine(light.versine_outer, unit_f32(u));
            direction = sampling::about(direction, versine, unit_f32(v));
            factor = 1.0 / (1.0 - versine);
        }
        let ray = Ray { origin: from, direction, t_max: f32::INFINITY };
        // The sun counts as a light without extent: the camera paths that it is found by are those without shadow rays.
        return Some(LightSample { ray, color: light.power.into(), factor, divisor: area, pdf: 0.0 });
    }
    let (Light::ENVIRONMENT, Some(environment)) = (light.kind, &scene.environment) else { return None };
    let found = environment.sample([u, v]);
    let ray = Ray { origin: from, direction: found.direction, t_max: f32::INFINITY };
    Some(LightSample { ray, color: found.weight, factor: 1.0, divisor: 1.0, pdf: found.pdf })
}

/// Samples a point on a light as seen from `from`, a point just above the surface. `None` if the light faces the other
/// way. `SHADED`: the light may be textured, or under a clearcoat. With a `normal`, directions to a nearby area light are
/// roughly in proportion to the cosine to it; [`pdf_of_triangle`] is without.
#[inline(always)]
pub(crate) fn sample<const SHADED: bool>(
    scene: &CpuScene,
    light: &Light,
    from: Vec3,
    normal: Option<Vec3>,
    words: [u32; 2],
) -> Option<LightSample> {
    if let Some(found) = sample_far(scene, light, from, words) {
        return Some(found);
    }
    let target = if light.kind == Light::TRIANGLE {
        at_area_light(scene, light, from, normal, words.map(unit_f32))?
    } else {
        Target::position_of(light)
    };
    let Target { front, per_pdf, .. } = target;
    let gap = target.to - from;
    let squared = gap.length_squared();
    let distance = squared.sqrt();
    let direction = gap / distance;
    let ray = Ray { origin: from, direction, t_max: distance };
    if per_pdf > 0.0 {
        // Radiance is power / (π · area).
        let per_power = per_pdf * std::f32::consts::FRAC_1_PI / light.area;
        let (color, pdf) = (power_from_area::<SHADED>(scene, light, target.barycentric, direction), 1.0 / per_pdf);
        return Some(LightSample { ray, color, factor: per_power, divisor: 1.0, pdf });
    }
    let intensity = intensity::<SHADED>(scene, light, &target, direction);
    if intensity == Vec3::ZERO {
        return None;
    }
    let pdf = if light.kind == Light::TRIANGLE { squared / (light.area * -direction.dot(front)) } else { 0.0 };
    Some(LightSample { ray, color: intensity, factor: 1.0, divisor: squared, pdf })
}

/// Power of an area light as it shines from one point of it against `direction`: half of it if it has two sides, of which
/// only one counts.
#[inline(always)]
fn power_from_area<const SHADED: bool>(scene: &CpuScene, light: &Light, (b, c): (f32, f32), direction: Vec3) -> Vec3 {
    let mut power = Vec3::from(light.power);
    if SHADED && scene.present.contains(Features::TEXTURED_LIGHTS) {
        power *= scene.emission_ratio(light, b, c);
    }
    if SHADED && scene.present.contains(Features::COATED_LIGHTS) {
        power *= scene.emission_through(light.primitive, (b, c), -direction);
    }
    power * if light.flags & Light::BOTH_SIDES != 0 { 0.5 } else { 1.0 }
}

/// Radiant intensity of a light that is not infinitely far away, against `direction`; of an area light that of its whole power,
/// as if emitted with a Lambertian cosine from the point.
#[inline(always)]
pub(crate) fn intensity<const SHADED: bool>(scene: &CpuScene, light: &Light, target: &Target, direction: Vec3) -> Vec3 {
    let power = Vec3::from(light.power);
    match light.kind {
        Light::POINT => power * (0.25 * std::f32::consts::FRAC_1_PI),
        Light::SPOT => {
            let off = sampling::versine(-direction, light.direction.into());
            let falloff = sampling::spot_falloff(off, light.versine_inner, light.versine_outer);
            let solid_angle = sampling::spot_solid_angle(light.versine_inner, light.versine_outer) as f32;
            power * (falloff / solid_angle)
        }
        _ => {
            let cosine = -direction.dot(target.front);
            power_from_area::<SHADED>(scene, light, target.barycentric, direction)
                * (cosine * std::f32::consts::FRAC_1_PI).max(0.0)
        }
    }
}

/// The density per solid angle with which [`sample`] samples a direction from `from` that hits the triangle of `light` at
/// `distance`, if this light is chosen; 0 if it does not sample the light from there.
pub(crate) fn pdf_of_triangle(scene: &CpuScene, light: &Light, from: Vec3, direction: Vec3, distance: f32) -> f32 {
    let View { corners, front, height, near } = View::of(scene, light, from);
    if !(height > if near { solid_angle::MIN_HEIGHT } else { 0.0 }) {
        return 0.0;
    }
    if near {
        let whole = solid_angle::of(corners, height, light.area);
        if whole > 0.0 {
            return 1.0 / whole;
        }
    }
    let cosine = -direction.dot(front);
    if cosine > 0.0 { distance * distance / (light.area * cosine) } else { 0.0 }
}

/// The triangle of an area light as seen from a point.
struct View {
    /// Relative to the eye, which is as far behind the point as shadow rays end above the light.
    corners: [Vec3; 3],
    /// Normal of the triangle on the side of the point.
    front: Vec3,
    /// Distance of the eye from the plane, above 0 in front of the light.
    height: f32,
    near: bool,
}

impl View {
    #[inline]
    fn of(scene: &CpuScene, light: &Light, from: Vec3) -> Self {
        let primitive = light.primitive as usize;
        let vertices = scene.vertices[primitive];
        let mut front = Vec3::from(scene.primitives[primitive].normal);
        if light.flags & Light::BOTH_SIDES != 0 && front.dot(from - vertices[0]) < 0.0 {
            front = -front;
        }
        let eye = offset::off_surface(from, -front);
        let corners = vertices.map(|vertex| vertex - eye);
        Self { corners, front, height: -front.dot(corners[0]), near: solid_angle::is_near(corners) }
    }
}

/// A sampled point on a light.
pub(crate) struct Target {
    pub(crate) to: Vec3,
    /// Normal of an area light on the side where the ray arrives.
    pub(crate) front: Vec3,
    /// The reciprocal of the density per solid angle; 0 if the point is uniform in area.
    per_pdf: f32,
    /// Its barycentric coordinates on the triangle of an area light.
    barycentric: (f32, f32),
}

impl Target {
    /// The position of a light without area.
    fn position_of(light: &Light) -> Self {
        Self { to: Vec3::from(light.position), front: Vec3::ZERO, per_pdf: 0.0, barycentric: (0.0, 0.0) }
    }

    /// A point evenly over the area of a light, with the normal of its front; `None` for light from infinity.
    pub(crate) fn evenly(scene: &CpuScene, light: &Light, [u, v]: [u32; 2]) -> Option<Self> {
        match light.kind {
            Light::DIRECTIONAL | Light::ENVIRONMENT => None,
            Light::TRIANGLE => {
                let (b, c) = sampling::triangle(unit_f32(u), unit_f32(v));
                let primitive = light.primitive as usize;
                let to = offset::barycentric(scene.vertices[primitive], b, c);
                let front = scene.primitives[primitive].normal.into();
                Some(Self { to, front, per_pdf: 0.0, barycentric: (b, c) })
            }
            _ => Some(Self::position_of(light)),
        }
    }
}

/// Samples a point of a triangle, on an emitting side that faces the query; `None` if there is none.
#[inline]
fn at_area_light(
    scene: &CpuScene,
    light: &Light,
    from: Vec3,
    normal: Option<Vec3>,
    [u, v]: [f32; 2],
) -> Option<Target> {
    let View { corners, front, height, near } = View::of(scene, light, from);
    if !(height > if near { solid_angle::MIN_HEIGHT } else { 0.0 }) {
        return None;
    }
    let seen = if near { solid_angle::sample(corners, height, light.area, normal, u, v) } else { None };
    let ((b, c), per_pdf) = match seen {
        Some(Seen { b, c, per_pdf }) => ((b, c), per_pdf),
        None => (sampling::triangle(u, v), 0.0),
    };
    let vertices = scene.vertices[light.primitive as usize];
    let to = offset::off_surface(offset::barycentric(vertices, b, c), front);
    Some(Target { to, front, per_pdf, barycentric: (b, c) })
}

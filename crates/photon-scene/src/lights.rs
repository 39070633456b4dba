//! The tables of lights and materials, with powers relative to the scene's total power.

use crate::boundaries::BoundaryTables;
use crate::describe::{
    AlphaMode, AmbientMedium, GridDesc, LightDesc, MaterialDesc, MediaTable, Surface, medium_record,
};
use crate::environment::Sun;
use crate::error::SceneError;
use crate::normalise::{Frame, Geometry};
use crate::order;
use crate::shading::{Radiances, is_smooth_metal, simplest};
use crate::validate::unit;
use glam::DVec3;
use photon_core::sampling::spot_solid_angle;
use photon_core::{EnvironmentMap, Light, Material, MaterialKind, Medium, MediumStack, OwnedGridTables};
use std::f64::consts::PI;

/// Everything that emits light.
#[derive(Debug)]
pub(crate) struct Lit {
    pub(crate) lights: Vec<Light>,
    /// Mean of RGB of each light's power.
    pub(crate) means: Vec<f64>,
    /// Total flux, mean of RGB, watts; 1 if nothing emits.
    pub(crate) power: f64,
    /// The same in W per squared normalised length, by which radiances are divided.
    total: f64,
}

impl Lit {
    /// Whether the environment map is among the lights: not if it is too weak beside the others.
    pub(crate) fn shows_environment(&self) -> bool {
        self.lights.iter().any(|light| light.kind == Light::ENVIRONMENT)
    }

    /// Factor from radiance in user units to units of total power.
    pub(crate) fn per_power(&self) -> f64 {
        if self.total > 0.0 { 1.0 / self.total } else { 0.0 }
    }
}

/// All lights but emissive triangles.
#[derive(Clone, Copy)]
pub(crate) struct Sources<'a> {
    pub(crate) lights: &'a [(String, LightDesc)],
    pub(crate) sun: Option<&'a Sun>,
    pub(crate) environment: Option<&'a EnvironmentMap>,
}

/// Lists emissive triangles, the other lights, the sun, then the environment, each with its power.
///
/// Powers are first computed relative to the squared scale, which stays in the range of f64 even for a scene
/// ten to the thirty times as large, while its watts might not. A triangle on which an emission texture is black is no
/// light. Light from infinity shines on all within the radius `reach` of the origin.
pub(crate) fn table(
    sources: Sources<'_>,
    materials: &[MaterialDesc],
    geometry: &Geometry,
    (frame, reach): (Frame, f64),
    mut radiances: Radiances<'_>,
    warnings: &mut Vec<String>,
) -> Result<Lit, SceneError> {
    let triangles = geometry.emitters.iter().map(|&(primitive, area)| {
        let material = &materials[geometry.primitives[primitive as usize].1 as usize];
        // Flux of a Lambertian emitter: π L A from each side that emits.
        let sides = if material.emits_both_sides { 2.0 } else { 1.0 };
        let power = DVec3::from_array(material.emission) * (sides * PI * area);
        let power = radiances.factor(primitive).map_or(power, |factor| power * factor);
        let flags = if material.emits_both_sides { Light::BOTH_SIDES } else { 0 };
        (Light { kind: Light::TRIANGLE, primitive, area: area as f32, flags, ..blank() }, power)
    });
    let mut others: Vec<_> = sources.lights.iter().map(|(_, desc)| punctual(desc, reach, frame)).collect();
    order::sort_lights(&mut others);
    let sun = sources.sun.map(|sun| disc(sun, reach));
    let sky = sources.environment.map(|map| infinite(map, reach));
    let all: Vec<(Light, DVec3)> = triangles.chain(others).chain(sun).chain(sky).collect();

    let total: f64 = all.iter().map(|(_, power)| mean(*power)).sum();
    let power = total * frame.scale * frame.scale;
    if !total.is_finite() || (total > 0.0 && !(power.is_finite() && power > 0.0)) {
        return Err(SceneError::Extreme {
            what: "the power of all lights together".to_owned(),
            value: format!("{power:e} W"),
            hint: "use another unit of length or of power",
        });
    }
    let mut lit = Lit { lights: Vec::new(), means: Vec::new(), power: if total > 0.0 { power } else { 1.0 }, total };
    let mut weak = 0_usize;
    for (light, power) in all {
        let share = power / total;
        // A light whose power vanishes relative to the others' would only get photons without power;
        // a denormal one would, depending on the device.
        if total > 0.0 && share.max_element() >= f64::from(f32::MIN_POSITIVE) {
            lit.lights.push(Light { power: share.as_vec3().to_array(), ..light });
            lit.means.push(mean(share));
        } else if power != DVec3::ZERO {
            weak += 1;
        }
    }
    if weak > 0 {
        warnings.push(format!(
            "{weak} of the lights are too weak, relative to all lights together, to be represented in 32 bits, \
             and are left out; render them separately"
        ));
    }
    if lit.lights.len() >= u32::MAX as usize {
        return Err(SceneError::TooMany { what: "lights", count: lit.lights.len() });
    }
    Ok(lit)
}

/// The light of an environment map: flux through the scene's disc, from all directions.
fn infinite(map: &EnvironmentMap, radius: f64) -> (Light, DVec3) {
    let light = Light { kind: Light::ENVIRONMENT, radius: radius as f32, ..blank() };
    (light, DVec3::from_array(map.mean_radiance()) * (4.0 * PI * PI * radius * radius))
}

/// The sun, and its flux through a disc that contains the projection of the scene along every direction of its light.
fn disc(sun: &Sun, radius: f64) -> (Light, DVec3) {
    let half = 0.5 * sun.radius_degrees.to_radians();
    let versine_outer = (2.0 * square(libm::sin(half))) as f32;
    let radius = radius / (1.0 - f64::from(versine_outer));
    let direction = unit(sun.direction).as_vec3().to_array();
    let light = Light { kind: Light::DIRECTIONAL, direction, versine_outer, radius: radius as f32, ..blank() };
    (light, DVec3::from_array(sun.irradiance) * (PI * radius * radius))
}

/// A point, spot or directional light, and its flux per squared scale.
fn punctual(desc: &LightDesc, radius: f64, frame: Frame) -> (Light, DVec3) {
    let place = |position| frame.point(position).as_vec3().to_array();
    let per_area = |intensity| DVec3::from_array(intensity) / frame.scale / frame.scale;
    match *desc {
        LightDesc::Point { position, intensity } => {
            let light = Light { kind: Light::POINT, position: place(position), ..blank() };
            (light, per_area(intensity) * (4.0 * PI))
        }
        LightDesc::Spot { position, direction, intensity, inner_angle, outer_angle } => {
            // 1 − cos, from the half angle: computing it from a cosine would round the narrowest cones to 0.
            let versine = |angle: f64| 2.0 * square(libm::sin(0.5 * angle));
            let versine_outer = versine(outer_angle).min(1.0) as f32;
            let versine_inner = (versine(inner_angle) as f32).min(versine_outer);
            // ∫ I dω over the cone, of the rounded numbers, so that dividing by it gives I exactly.
            let solid_angle = spot_solid_angle(versine_inner, versine_outer);
            let light = Light {
                kind: Light::SPOT,
                position: place(position),
                direction: unit(direction).as_vec3().to_array(),
                versine_inner,
                versine_outer,
                ..blank()
            };
            (light, per_area(intensity) * solid_angle)
        }
        LightDesc::Directional { direction, irradiance } => {
            let direction = unit(direction).as_vec3().to_array();
            let light = Light { kind: Light::DIRECTIONAL, direction, radius: radius as f32, ..blank() };
            (light, DVec3::from_array(irradiance) * (PI * radius * radius))
        }
    }
}

fn blank() -> Light {
    Light { primitive: u32::MAX, ..Light::default() }
}

fn square(x: f64) -> f64 {
    x * x
}

fn mean(power: DVec3) -> f64 {
    power.element_sum() / 3.0
}

/// The materials, in the order in which they were added, then the glass of those in use that are partly glass, in the same
/// order; and the table of media that they refer to, the ambient medium first.
pub(crate) fn materials(
    descs: &[MaterialDesc],
    (ambient, boundaries): (Option<&AmbientMedium>, &mut BoundaryTables),
    geometry: &Geometry,
    lit: &Lit,
    frame: Frame,
) -> Result<(Vec<Material>, Vec<Medium>, OwnedGridTables), SceneError> {
    let mut shines = vec![false; descs.len()];
    for &(primitive, _) in &geometry.emitters {
        shines[geometry.primitives[primitive as usize].1 as usize] = true;
    }
    let mut in_use = vec![false; descs.len()];
    for &(_, material) in &geometry.primitives {
        in_use[material as usize] = true;
    }
    let mut media = MediaTable::new(ambient.map_or(Medium::VACUUM, |medium| medium.record(frame.scale)));
    let mut all_glass = Vec::new();
    // Simplified and partly transmitting materials have no grids.
    let mut materials: Vec<Material> = descs
        .iter()
        .zip(shines.into_iter().zip(in_use))
        .map(|(desc, (shines, in_use))| {
            let glass = desc.transmitting_surface().filter(|_| in_use);
            let glass = glass
                .map(|glass| surface(&MaterialDesc { surface: glass, ..desc.clone() }, None, true, &mut media, frame));
            let surface = match glass {
                None => surface(desc, desc.grid.as_ref(), in_use, &mut media, frame),
                // It has not been simplified, since its glass needs all of it.
                Some(_) => {
                    let opaque = MaterialDesc { surface: simplest(desc.surface.clone()), ..desc.clone() };
                    surface(&opaque, None, in_use, &mut media, frame)
                }
            };
            // An emissive material that no triangle uses must not count as a light.
            let emission =
                if shines && lit.total > 0.0 { DVec3::from_array(desc.emission) / lit.total } else { DVec3::ZERO };
            let flags = if desc.emits_both_sides { Material::EMITS_BOTH_SIDES } else { 0 };
            let (coverage, alpha_cutoff) = match desc.alpha_mode {
                AlphaMode::Opaque => (0, 0.0),
                AlphaMode::Mask { cutoff } => (Material::ALPHA, cutoff as f32),
                AlphaMode::Blend => (Material::ALPHA, 0.0),
            };
            // As the record has it.
            let through = if desc.diffuse_transmission as f32 > 0.0 { Material::DIFFUSE_TRANSMISSION } else { 0 };
            let emission = emission.as_vec3().to_array();
            let partly = if glass.is_some() { Material::PARTIAL_TRANSMISSION } else { 0 };
            all_glass.extend(glass.map(|glass| Material { emission, flags, ..glass }));
            let (flags, alpha) = (flags | coverage | through | partly, desc.alpha as f32);
            Material { emission, flags, alpha, alpha_cutoff, ..surface }
        })
        .collect();
    materials.extend(all_glass);
    boundaries.enter(&mut media, descs);
    let count = media.solids();
    if count > MediumStack::MAX_MEDIA {
        return Err(SceneError::TooMany { what: "different media", count });
    }
    let (media, grids) = media.build(frame)?;
    Ok((materials, media, grids))
}

fn surface<'a>(
    desc: &MaterialDesc,
    grid: Option<&'a GridDesc>,
    in_use: bool,
    media: &mut MediaTable<'a>,
    frame: Frame,
) -> Material {
    let colour = |colour: [f64; 3]| colour.map(|part| part as f32);
    let of = |kind: MaterialKind| Material { kind: kind as u32, ior: 1.0, ..Material::default() };
    let glossy = |base_color: [f64; 3], metallic: f32, roughness: f32| Material {
        albedo: colour(base_color),
        ior: 1.5,
        metallic,
        roughness,
        ..of(MaterialKind::Glossy)
    };
    let has_sheen = desc.sheen_color != [0.0; 3];
    match desc.surface {
        // Under a clearcoat or a sheen, a reflection of their own is only that of the layer, or as narrow as any.
        Surface::Lambert { albedo } | Surface::Glossy { base_color: albedo, metallic: 0.0, specular: 0.0, .. }
            if desc.clearcoat > 0.0 || desc.diffuse_transmission > 0.0 || has_sheen =>
        {
            glossy(albedo, 0.0, 1.0)
        }
        Surface::Mirror { reflectance } if desc.clearcoat > 0.0 || has_sheen => glossy(reflectance, 1.0, 0.0),
        Surface::Lambert { albedo } => Material { albedo: colour(albedo), ..of(MaterialKind::Lambert) },
        Surface::Mirror { reflectance } => Material { albedo: colour(reflectance), ..of(MaterialKind::Mirror) },
        // A solid material that no triangle uses does not take one of the 255 media; without a medium it is no solid.
        Surface::Dielectric { tint, .. } if !in_use => Material { albedo: colour(tint), ..of(MaterialKind::Lambert) },
        Surface::Dielectric { ior, absorption, tint, roughness } => {
            let dispersed = desc.dispersion.map(|dispersion| dispersion.medium(ior));
            let Medium { ior, dispersion, terms, .. } =
                dispersed.unwrap_or(Medium { ior: ior as f32, ..Medium::VACUUM });
            let inside = medium_record(absorption, desc.scattering, desc.phase, frame.scale * desc.density());
            let medium = Medium { ior, dispersion, terms, priority: desc.priority, ..inside };
            let ior = medium.ior;
            let medium = media.index_of(medium, grid);
            let roughness = roughness as f32;
            Material { albedo: colour(tint), ior, medium, roughness, ..of(MaterialKind::Dielectric) }
        }
        // No triangle has it.
        Surface::Boundary { .. } => of(MaterialKind::Lambert),
        Surface::Thin { ior, tint, roughness } => {
            Material { albedo: colour(tint), ior: ior as f32, roughness: roughness as f32, ..of(MaterialKind::Thin) }
        }
        // Without metal and coat, what is left is diffuse.
        Surface::Glossy { base_color, metallic: 0.0, specular: 0.0, .. } => {
            Material { albedo: colour(base_color), ..of(MaterialKind::Lambert) }
        }
        Surface::Glossy { base_color, .. } if is_smooth_metal(desc) => {
            Material { albedo: colour(base_color), metallic: 1.0, ..of(MaterialKind::Mirror) }
        }
        Surface::Glossy { base_color, metallic, roughness, specular, ior } => Material {
            albedo: colour(base_color),
            ior: ior as f32,
            metallic: metallic as f32,
            roughness: roughness as f32,
            specular: specular as f32,
            ..of(MaterialKind::Glossy)
        },
    }
}

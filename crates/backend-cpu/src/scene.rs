//! A scene, ready to be traced.

use std::time::Instant;

use photon_core::glam::Vec3;
use photon_core::{
    Error, Facet, Features, Hit, Light, Material, Ray, RayCaster, Requirements, Result, SceneView, math, offset,
};

use crate::cpu::Cpu;

/// A scene, ready to be traced.
#[expect(missing_debug_implementations, reason = "holds a foreign ray caster")]
pub struct CpuScene {
    pub(crate) vertices: Vec<[Vec3; 3]>,
    /// Of each triangle, what `offset::margin` says.
    pub(crate) margins: Vec<f32>,
    pub(crate) facets: Vec<Facet>,
    pub(crate) materials: Vec<Material>,
    pub(crate) lights: Vec<Light>,
    pub(crate) light_starts: Vec<u32>,
    pub(crate) caster: Box<dyn RayCaster>,
    pub(crate) features: Features,
    /// Seconds that the ray caster took to build.
    pub build_seconds: f64,
}

impl CpuScene {
    pub(crate) fn new(on: &Cpu, view: &SceneView<'_>, required: &Requirements) -> Result<Self> {
        view.validate()?;
        required.check(Features::of(view))?;
        let start = Instant::now();
        let caster = match &on.make_caster {
            Some(make) => make(view)?,
            None => on.pool.install(|| {
                photon_scene::Accel::build(view.positions, view.triangles)
                    .map(|accel| Box::new(accel) as Box<dyn RayCaster>)
                    .map_err(|source| Error::Backend { backend: "cpu: building the BVH", source: Box::new(source) })
            })?,
        };
        let vertex = |index: u32| Vec3::from(view.positions[index as usize]);
        let vertices: Vec<[Vec3; 3]> = view.triangles.iter().map(|triangle| triangle.map(vertex)).collect();
        Ok(Self {
            margins: vertices.iter().map(|&corners| offset::margin(corners)).collect(),
            vertices,
            facets: view.facets.to_vec(),
            materials: view.materials.to_vec(),
            lights: view.lights.to_vec(),
            light_starts: view.light_starts.to_vec(),
            caster,
            features: required.features,
            build_seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// The nearest surface, with all that shading needs.
    #[inline]
    pub(crate) fn surface(&self, ray: &Ray) -> Option<Surface> {
        let Hit { t, primitive, u, v } = self.caster.nearest(ray)?;
        let facet = self.facets[primitive as usize];
        let normal = Vec3::from(facet.normal);
        let cosine = -ray.direction.dot(normal);
        let front = cosine > 0.0;
        let (vertices, margin) = (self.vertices[primitive as usize], self.margins[primitive as usize]);
        Some(Surface {
            t,
            point: offset::barycentric(vertices, u, v),
            start: offset::within(vertices, margin, u, v),
            normal: if front { normal } else { -normal },
            cosine: cosine.abs(),
            front,
            material: facet.material,
        })
    }

    /// Share of each channel that is left after the stretch that ended on `surface`: Beer and
    /// Lambert's law inside solids.
    #[inline]
    pub(crate) fn transmittance(&self, surface: &Surface, medium: u32) -> Vec3 {
        self.solid(surface, medium).map_or(Vec3::ONE, |solid| surface.transmittance(solid))
    }

    /// The solid that the stretch that ended on `surface` was inside of. A back side of glass says itself
    /// that it was; for other surfaces it is what the path last entered.
    #[inline]
    pub(crate) fn solid(&self, surface: &Surface, medium: u32) -> Option<&Material> {
        if !surface.front {
            let material = &self.materials[surface.material as usize];
            if material.kind == Material::DIELECTRIC {
                return Some(material);
            }
        }
        if medium == VACUUM { None } else { self.materials.get(medium as usize) }
    }
}

/// Index of the material that a path is inside of, when it is in none.
pub(crate) const VACUUM: u32 = u32::MAX;

/// Where a ray meets the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(crate) t: f32,
    pub(crate) point: Vec3,
    /// Where rays go on from, but for the step off the surface.
    pub(crate) start: Vec3,
    /// On the side that the ray came from.
    pub(crate) normal: Vec3,
    /// Between that normal and the way back, ≥ 0.
    pub(crate) cosine: f32,
    /// Whether that is the front.
    pub(crate) front: bool,
    pub(crate) material: u32,
}

impl Surface {
    /// What is left of light after the stretch that ended here, inside `solid`.
    #[inline]
    pub(crate) fn transmittance(&self, solid: &Material) -> Vec3 {
        Vec3::from(solid.absorption.map(|sigma| math::exp_neg(sigma * self.t)))
    }

    /// A ray that goes on from here on the side that it came from.
    #[inline]
    pub(crate) fn leave(&self, direction: Vec3) -> Ray {
        Ray { origin: offset::off_surface(self.start, self.normal), direction, t_max: f32::INFINITY }
    }

    /// A ray that goes on beyond.
    #[inline]
    pub(crate) fn pass(&self, direction: Vec3) -> Ray {
        Ray { origin: offset::off_surface(self.start, -self.normal), direction, t_max: f32::INFINITY }
    }
}

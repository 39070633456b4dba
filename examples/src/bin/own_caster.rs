//! Example: the whole pipeline with a ray caster of your own.
//!
//! The custom caster here is the traversal and triangle test of the crate obvhs; Embree, or the BVH of your own
//! renderer, can take its place. Both casters render the same passes, and the pictures are compared: hits agree
//! except for rounding, so that the pictures differ by far less than their noise.
//!
//!     cargo run --release -p photon-examples --bin own_caster -- cornell
#![expect(clippy::print_stdout, reason = "the comparison is the result")]

use std::error::Error;

use backend_cpu::Cpu;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::{Ray as TheirRay, RayHit};
use obvhs::triangle::Triangle;
use photon_core::glam::Vec3A;
use photon_core::{Budget, Film, Hit, Pipeline, Ray, RayCaster, Render, SceneView, Settings, View, render};

const SIZE: u32 = 128;
const PHOTONS: u32 = 50_000;
const PASSES: u32 = 4;

/// The existing acceleration structure of another renderer.
struct Foreign {
    tree: Bvh2,
    triangles: Vec<Triangle>,
}

impl Foreign {
    fn new(scene: &SceneView<'_>) -> Self {
        let at = |vertex: u32| Vec3A::from(scene.positions[vertex as usize]);
        let triangles: Vec<Triangle> =
            scene.triangles.iter().map(|&[a, b, c]| Triangle { v0: at(a), v1: at(b), v2: at(c) }).collect();
        let mut taken = std::time::Duration::default();
        Self { tree: build_bvh2_from_tris(&triangles, BvhBuildParams::fast_build(), &mut taken), triangles }
    }
}

impl RayCaster for Foreign {
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        let theirs = TheirRay::new(ray.origin.into(), ray.direction.into(), 0.0, ray.t_max);
        let mut hit = RayHit::none();
        let id = |slot: u32| self.tree.primitive_indices[slot as usize];
        let found = self.tree.ray_traverse(theirs, &mut hit, |ray, slot| {
            self.triangles[self.tree.primitive_indices[slot] as usize].intersect(ray)
        });
        if !found {
            return None;
        }
        let primitive = id(hit.primitive_id);
        // Barycentric coordinates of the hit, which obvhs does not return.
        let Triangle { v0, v1, v2 } = self.triangles[primitive as usize];
        let (e1, e2) = (v1 - v0, v2 - v0);
        let p = theirs.direction.cross(e2);
        let determinant = e1.dot(p);
        let s = theirs.origin - v0;
        let (u, v) = (s.dot(p) / determinant, theirs.direction.dot(s.cross(e1)) / determinant);
        (u.is_finite() && v.is_finite()).then(|| Hit {
            t: hit.t,
            primitive,
            u: u.clamp(0.0, 1.0),
            v: v.clamp(0.0, 1.0),
        })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "cornell".to_owned());
    let scene = photon_scene::builtin(&name).ok_or(format!("{name}: no built-in scene has that name"))?.build()?;
    let view = View { camera: scene.camera(None, SIZE, SIZE)?, width: SIZE, height: SIZE };
    let picture = |cpu: Cpu| -> Result<Film, Box<dyn Error>> {
        let settings = Settings { photons: PHOTONS, ..Settings::default() };
        let mut renderer = Pipeline::new(cpu, &scene.view(), view, settings)?;
        render(&mut renderer, Budget::passes(PASSES), &mut ())?;
        Ok(renderer.film()?)
    };
    let ours = picture(Cpu::new()?)?;
    let foreign = picture(Cpu::new()?.with_caster(|scene| Ok(Box::new(Foreign::new(scene)))))?;
    compare(&ours, &foreign)
}

/// Prints the difference; it is an error if rounding does not explain it.
fn compare(ours: &Film, foreign: &Film) -> Result<(), Box<dyn Error>> {
    let noise = ours.standard_error();
    let (mut apart, mut sum, mut squares) = (0, 0.0, 0.0);
    let (a, b) = (ours.beauty(), foreign.beauty());
    for ((a, b), noise) in a.iter().zip(&b).zip(&noise) {
        let mean = |c: &[f32; 3]| f64::from(c[0] + c[1] + c[2]) / 3.0;
        let difference = mean(a) - mean(b);
        apart += usize::from(difference.abs() > 4.5 * f64::from(*noise) + 1e-6);
        sum += mean(a);
        squares += difference * difference;
    }
    let pixels = a.len() as f64;
    let relative = (squares / pixels).sqrt() / (sum / pixels);
    println!("RMS difference {relative:.5} of the mean; {apart} of {pixels} pixels beyond 4.5 standard errors");
    // One ray in many thousands hits an edge, where the other caster may hit the adjacent triangle.
    if apart as f64 > 0.01 * pixels {
        return Err("the pictures differ by more than rounding explains".into());
    }
    Ok(())
}

//! Closest hits: ours, watertight, against obvhs' own traversal and triangle test, rays in random
//! directions from the walls of a room and from a bumpy sphere inside it.
//!
//! The binary tree is built with the same parameters for both; obvhs' eight-wide compressed tree
//! (CWBVH), its fastest, is measured too, and with `--features embree` Embree's robust mode, the
//! watertight one. One thread; rounds in turn; medians.
#![expect(clippy::print_stdout, reason = "a benchmark prints its table")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as TheirRay, RayHit};
use obvhs::triangle::Triangle;
#[cfg(feature = "embree")]
use photon_benches::embree::Robust;
use photon_core::glam::{Vec3, Vec3A};
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{RandomKind, Ray, RayCaster, sampling};
use photon_scene::Accel;

type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// A room of 12 triangles with a bumpy sphere of about `count` in it.
fn scene(count: usize) -> Mesh {
    let rings = ((count as f64) / 4.0).sqrt() as u32;
    let segments = 2 * rings;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for ring in 0..=rings {
        for segment in 0..segments {
            let theta = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            let phi = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let r = 0.25 * (1.0 + 0.1 * (20.0 * theta).sin() * (24.0 * phi).sin());
            let at = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            positions.push(at.map(|c| (r * c) as f32));
        }
    }
    for ring in 0..rings {
        for segment in 0..segments {
            let at = |r: u32, s: u32| r * segments + s % segments;
            let (a, b) = (at(ring, segment), at(ring, segment + 1));
            let (c, d) = (at(ring + 1, segment), at(ring + 1, segment + 1));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    let base = positions.len() as u32;
    for corner in 0..8_u8 {
        positions.push([0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { 0.5 } else { -0.5 }));
    }
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]] {
        triangles.extend([[base + a, base + b, base + c], [base + a, base + c, base + d]]);
    }
    (positions, triangles)
}

/// Half from the walls, half from the sphere, in random directions.
fn rays(count: u32) -> Vec<Ray> {
    (0..count)
        .map(|path| {
            let mut sampler = Sampler::new(RandomKind::Counter, 1, 0, Domain::Photon, path);
            let [a, b, c, d] = sampler.words(0).map(unit_f32);
            let outward = sampling::uniform_sphere(a, b);
            let (origin, normal) = if path % 2 == 0 {
                let m = outward.abs().max_element();
                let wall = outward / m * 0.499_99;
                let axis = if outward.x.abs() == m {
                    Vec3::X
                } else if outward.y.abs() == m {
                    Vec3::Y
                } else {
                    Vec3::Z
                };
                (wall, -axis * outward.dot(axis).signum())
            } else {
                (outward * 0.28, outward)
            };
            Ray { origin, direction: sampling::cosine_hemisphere(normal, c, d), t_max: f32::INFINITY }
        })
        .collect()
}

fn median(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let quick = std::env::args().any(|argument| argument == "--test");
    let (rounds, count, sizes) = if quick { (1, 1000, vec![1000]) } else { (9, 200_000, vec![100_000, 1_000_000]) };
    for size in sizes {
        let (positions, triangles) = scene(size);
        let rays = rays(count);
        let theirs: Vec<Triangle> = triangles
            .iter()
            .map(|t| {
                let [v0, v1, v2] = t.map(|i| Vec3A::from(positions[i as usize]));
                Triangle { v0, v1, v2 }
            })
            .collect();
        let start = Instant::now();
        let ours = Accel::build(&positions, &triangles)?;
        let build_ours = start.elapsed();
        #[cfg(feature = "embree")]
        let embree = {
            let start = Instant::now();
            let mesh = Robust::build(&positions, &triangles).ok_or("Embree builds nothing")?;
            println!("\nEmbree, robust: build {:.2?}", start.elapsed());
            mesh
        };
        println!("\n{} triangles, {count} rays; our build {build_ours:.2?}", triangles.len());
        for (preset, parameters) in
            [("medium", BvhBuildParams::medium_build()), ("very slow", BvhBuildParams::very_slow_build())]
        {
            let (mut two, mut eight) = (Duration::default(), Duration::default());
            let bvh2 = build_bvh2_from_tris(&theirs, parameters, &mut two);
            let cwbvh = build_cwbvh_from_tris(&theirs, parameters, &mut eight);
            let mut times: [Vec<Duration>; 4] = Default::default();
            let mut apart = 0_usize;
            for round in 0..rounds {
                #[cfg(feature = "embree")]
                {
                    let start = Instant::now();
                    for ray in &rays {
                        black_box(embree.nearest(ray.origin.into(), ray.direction.into()));
                    }
                    times[3].push(start.elapsed());
                }
                let start = Instant::now();
                for ray in &rays {
                    black_box(ours.nearest(ray));
                }
                times[0].push(start.elapsed());
                let mut run = |slot: usize, trace: &mut dyn FnMut(TheirRay, &mut RayHit)| {
                    let start = Instant::now();
                    for ray in &rays {
                        let theirs = TheirRay::new(ray.origin.into(), ray.direction.into(), 0.0, f32::INFINITY);
                        let mut hit = RayHit::none();
                        trace(theirs, &mut hit);
                        black_box(&hit);
                        if round == 0 && slot == 1 {
                            let same = match ours.nearest(ray) {
                                Some(ours) => (ours.t - hit.t).abs() <= 1e-4 * ours.t.max(0.01),
                                None => hit.t == f32::INFINITY,
                            };
                            apart += usize::from(!same);
                        }
                    }
                    times[slot].push(start.elapsed());
                };
                run(1, &mut |ray, hit| {
                    bvh2.ray_traverse(ray, hit, |ray, id| theirs[bvh2.primitive_indices[id] as usize].intersect(ray));
                });
                run(2, &mut |ray, hit| {
                    cwbvh.ray_traverse(ray, hit, |ray, id| theirs[cwbvh.primitive_indices[id] as usize].intersect(ray));
                });
            }
            let rate = |times: &Vec<Duration>| f64::from(count) / median(times.clone()) / 1e6;
            let [a, b, c] = [0, 1, 2].map(|slot| rate(&times[slot]));
            println!(
                "  obvhs {preset:<9} (builds {two:.2?}, {eight:.2?}): ours {a:.2} M rays/s, BVH2 {b:.2} (ratio {:.2}), \
                 CWBVH {c:.2} (ratio {:.2}); {apart} rays differ",
                a / b,
                a / c
            );
            #[cfg(feature = "embree")]
            {
                let theirs = rate(&times[3]);
                let same = |ray: &&Ray| {
                    let them = embree.nearest(ray.origin.into(), ray.direction.into());
                    match (ours.nearest(ray), them) {
                        (Some(ours), Some((t, _))) => (ours.t - t).abs() <= 1e-4 * ours.t.max(0.01),
                        (ours, theirs) => ours.is_none() && theirs.is_none(),
                    }
                };
                let apart = rays.len() - rays.iter().filter(same).count();
                println!("  Embree, robust: {theirs:.2} M rays/s (ratio {:.2}); {apart} rays differ", a / theirs);
            }
        }
    }
    Ok(())
}

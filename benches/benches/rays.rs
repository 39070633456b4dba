//! Closest hits: our watertight caster compared with obvhs' own traversal and triangle test, for rays in random
//! directions from the walls of a room and from a bumpy sphere inside it (*incoherent*), and for those of a camera in the
//! room, row by row (*coherent*).
//!
//! The binary tree is built with the same parameters for both; obvhs' eight-wide compressed tree
//! (CWBVH), its fastest, is measured too, and with `--features embree` Embree in robust mode,
//! which is watertight. One thread; blocks of rays alternate.
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
use photon_core::{Ray, RayCaster};
use photon_scene::Accel;
use room::{rays, scene};

#[path = "../../crates/backend-vulkan/examples/bench/room.rs"]
#[expect(dead_code, reason = "the device's benchmarks need more of it")]
mod room;

/// Rays per timed block: about a millisecond, which other programs rarely interrupt.
const BLOCK: usize = 4000;

/// Times of each contender's blocks. The lower quartile counts, as the time of blocks that were not
/// interrupted.
struct Times {
    blocks: Vec<Duration>,
}

impl Times {
    fn of<T>(&mut self, rays: &[Ray], trace: impl Fn(&Ray) -> T) {
        let start = Instant::now();
        for ray in rays {
            black_box(trace(ray));
        }
        self.blocks.push(start.elapsed());
    }

    /// Million rays per second.
    fn rate(&mut self) -> f64 {
        self.blocks.sort();
        BLOCK as f64 / self.blocks[self.blocks.len() / 4].as_secs_f64() / 1e6
    }
}

/// Number of rays with a distance different from ours.
fn apart(rays: &[Ray], ours: &Accel, theirs: impl Fn(&Ray) -> Option<f32>) -> usize {
    let same = |ray: &&Ray| match (ours.nearest(ray), theirs(ray)) {
        (Some(ours), Some(t)) => (ours.t - t).abs() <= 1e-4 * ours.t.max(0.01),
        (ours, theirs) => ours.is_none() && theirs.is_none(),
    };
    rays.len() - rays.iter().filter(same).count()
}

/// Camera rays of a square picture, row by row, from the middle of a wall.
fn camera_rays(count: usize) -> Vec<Ray> {
    let side = (count as f64).sqrt() as usize;
    let at = |index: usize| (index as f32 + 0.5) / side as f32 - 0.5;
    let ray = |index: usize| Ray {
        origin: Vec3::new(-0.499_99, 0.0, 0.0),
        direction: Vec3::new(0.5, at(index % side), at(index / side)).normalize(),
        t_max: f32::INFINITY,
    };
    (0..side * side).map(ray).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let quick = std::env::args().any(|argument| argument == "--test");
    let (rounds, count, sizes) = if quick { (1, BLOCK, vec![1000]) } else { (9, 50 * BLOCK, vec![100_000, 1_000_000]) };
    let kinds = [("incoherent", rays(count as u32)), ("coherent", camera_rays(count))];
    for size in sizes {
        let (positions, triangles) = scene(size);
        let theirs: Vec<Triangle> = triangles
            .iter()
            .map(|t| {
                let [v0, v1, v2] = t.map(|i| Vec3A::from(positions[i as usize]));
                Triangle { v0, v1, v2 }
            })
            .collect();
        let start = Instant::now();
        let ours = Accel::build(&positions, &triangles)?;
        println!("\n{} triangles; our build {:.2?}", triangles.len(), start.elapsed());
        #[cfg(feature = "embree")]
        let embree = {
            let start = Instant::now();
            let mesh = Robust::build(&positions, &triangles).ok_or("Embree builds nothing")?;
            println!("  Embree, robust: build {:.2?}", start.elapsed());
            mesh
        };
        for (preset, parameters) in
            [("medium", BvhBuildParams::medium_build()), ("very slow", BvhBuildParams::very_slow_build())]
        {
            let (mut two, mut eight) = (Duration::default(), Duration::default());
            let bvh2 = build_bvh2_from_tris(&theirs, parameters, &mut two);
            let cwbvh = build_cwbvh_from_tris(&theirs, parameters, &mut eight);
            println!("  obvhs {preset} builds {two:.2?}, {eight:.2?}");
            let their_ray = |ray: &Ray| TheirRay::new(ray.origin.into(), ray.direction.into(), 0.0, f32::INFINITY);
            let by_two = |ray: &Ray| {
                let mut hit = RayHit::none();
                bvh2.ray_traverse(their_ray(ray), &mut hit, |ray, id| {
                    theirs[bvh2.primitive_indices[id] as usize].intersect(ray)
                });
                hit
            };
            let by_eight = |ray: &Ray| {
                let mut hit = RayHit::none();
                cwbvh.ray_traverse(their_ray(ray), &mut hit, |ray, id| {
                    theirs[cwbvh.primitive_indices[id] as usize].intersect(ray)
                });
                hit
            };
            for (kind, rays) in &kinds {
                let mut times = [(); 4].map(|()| Times { blocks: Vec::new() });
                for _ in 0..rounds {
                    for block in rays.chunks_exact(BLOCK) {
                        times[0].of(block, |ray| ours.nearest(ray));
                        times[1].of(block, by_two);
                        times[2].of(block, by_eight);
                        #[cfg(feature = "embree")]
                        times[3].of(block, |ray| embree.nearest(ray.origin.into(), ray.direction.into()));
                    }
                }
                let finite = |hit: RayHit| (hit.t < f32::INFINITY).then_some(hit.t);
                let two_apart = apart(rays, &ours, |ray| finite(by_two(ray)));
                let eight_apart = apart(rays, &ours, |ray| finite(by_eight(ray)));
                let [a, b, c] = [0, 1, 2].map(|slot: usize| times[slot].rate());
                println!(
                    "  {kind:<10} ours {a:.2} M rays/s, BVH2 {b:.2} (ratio {:.2}), CWBVH {c:.2} (ratio {:.2}); {two_apart} \
                     and {eight_apart} rays differ",
                    a / b,
                    a / c
                );
                #[cfg(feature = "embree")]
                {
                    let d = times[3].rate();
                    let differ = apart(rays, &ours, |ray| {
                        embree.nearest(ray.origin.into(), ray.direction.into()).map(|(t, _)| t)
                    });
                    println!("  {kind:<10} Embree, robust: {d:.2} M rays/s (ratio {:.2}); {differ} rays differ", a / d);
                }
            }
        }
    }
    Ok(())
}

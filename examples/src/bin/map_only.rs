//! Example: the photon map alone, with photons and query points of your own.
//!
//! Photons are distributed uniformly on a square, as if traced by another renderer. The program finds the nearest
//! photons of some points, and estimates irradiance by Jensen's formula: the flux of the photons divided by the area
//! of the disc that contains them. `photonmap map` does such searches for files.
//!
//!     cargo run --release -p photon-examples --bin map_only
#![expect(clippy::print_stdout, reason = "the result")]

use std::error::Error;
use std::f64::consts::PI;

use backend_cpu::index::PointIndex;
use photon_core::IndexKind;

/// Photons along a side of the square, whose side is 1, and the total flux of all photons, in watts.
const SIDE: usize = 300;
const FLUX: f64 = 5.0;
/// Photons per estimate.
const K: usize = 100;

fn main() -> Result<(), Box<dyn Error>> {
    // A jittered grid: one photon per cell, at an offset given by an irrational rotation.
    let photons: Vec<[f32; 3]> = (0..SIDE * SIDE)
        .map(|i| {
            let jitter = |step: f64| (i as f64 * step).fract();
            let at = |cell: usize, jitter: f64| ((cell as f64 + jitter) / SIDE as f64) as f32;
            [at(i % SIDE, jitter(0.618_033_988_75)), at(i / SIDE, jitter(0.414_213_562_37)), 0.0]
        })
        .collect();
    let queries: Vec<[f32; 3]> = (1..8).map(|i| [i as f32 / 8.0, 0.5, 0.0]).collect();

    let index = PointIndex::build(&photons, IndexKind::Morton)?;
    let mut nearest = vec![0_u32; queries.len() * K];
    // Rows of K photon indices, nearest first; the third argument is a limit on the squared distance.
    index.nearest_many(&queries, K, f32::INFINITY, &mut nearest)?;

    let photon_flux = FLUX / photons.len() as f64;
    let mut worst = 0.0_f64;
    for (query, row) in queries.iter().zip(nearest.chunks_exact(K)) {
        let farthest = photons[row[K - 1] as usize];
        let r2: f64 = query.iter().zip(farthest).map(|(q, p)| f64::from(p - q).powi(2)).sum();
        // The farthest photon only determines the radius, so that K - 1 lie within it.
        let irradiance = (K - 1) as f64 * photon_flux / (PI * r2);
        worst = worst.max((irradiance / FLUX - 1.0).abs());
        println!("at ({:.3}, {:.3}): {irradiance:.3} W/m², radius {:.4}", query[0], query[1], r2.sqrt());
    }
    println!("expected {FLUX} W/m²; off by at most {:.1} %", 100.0 * worst);
    // A jittered grid is more uniform than independent photons, for which a tenth would be one standard deviation.
    if worst > 0.1 {
        return Err("the estimate differs from the flux over the area".into());
    }
    Ok(())
}

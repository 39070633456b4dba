//! Example: a renderer lends its own Vulkan device to the photon map, with photons and query points that
//! its own compute shader wrote there. Neither ever leaves the device; only the estimates are read back.
//!
//! The photons are distributed uniformly on a square, so that the exact result is known: irradiance is their flux
//! divided by the area of the square.
//!
//!     cargo run --release -p photon-examples --bin host_device -- [PHOTONS] [median|vvh|morton]
#![expect(clippy::print_stdout, reason = "a program's output")]

mod host;

use std::error::Error;

use backend_vulkan::{Vulkan, VulkanBuffer};
use host::{Host, Push};
use photon_core::{Backend, Estimate, EstimateParams, IndexKind, Photon, Query, Search};

/// Watts on the square, its side in normalised space, and queries along a side.
const FLUX: f32 = 3.0;
const SIDE: f32 = 0.5;
const QUERIES: u32 = 64;
const RADIUS: f32 = 0.01;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let photon_count: u32 = arguments.next().map_or(Ok(200_000), |text| text.parse())?;
    let kind: IndexKind = arguments.next().map_or(Ok(IndexKind::Morton), |text| text.parse())?;
    // With fewer, the noise exceeds the bounds of the check at the end.
    if !(10_000..=1 << 26).contains(&photon_count) {
        return Err("the number of photons must be from 10000 to 67108864".into());
    }
    let mut host = Host::new()?;
    let queries = u64::from(QUERIES * QUERIES);
    let (photon_buffer, photon_address) = host.buffer(u64::from(photon_count) * size_of::<Photon>() as u64)?;
    let (query_buffer, query_address) = host.buffer(queries * size_of::<Query>() as u64)?;
    host.run(&Push {
        photons: photon_address,
        queries: query_address,
        photon_count,
        query_side: QUERIES,
        // Each photon carries the total flux; it is divided by the number of photons at the end, as with paths.
        power: FLUX,
        side: SIDE,
        radius: RADIUS,
        reserved: 0,
    })?;

    let estimates = {
        // SAFETY: the host's handles belong together and outlive this block, its device has the
        // required features, and the host does not use the queue meanwhile.
        let mut on = unsafe { Vulkan::from_raw(host.device.clone()) }?;
        // SAFETY: the host's buffers have the required usages and flag, hold this many
        // records, outlive this block, and the kernel that writes them was submitted to the same queue,
        // with a barrier at its end.
        let (photons, there) = unsafe {
            let photons = VulkanBuffer::<Photon>::from_raw(&mut on, photon_buffer, 0, u64::from(photon_count))?;
            (photons, VulkanBuffer::<Query>::from_raw(&mut on, query_buffer, 0, queries)?)
        };
        let mut stages = on.map_stages(kind)?;
        let map = stages.builder.build(&mut on, photons)?;
        let mut answers = on.alloc::<Estimate>("estimates", queries)?;
        let gather = EstimateParams { min_normal_cosine: 0.7, ..EstimateParams::new(Search::Radius) };
        stages.estimator.estimate(&mut on, &map, &there, &gather, &mut answers)?;
        let mut found = Vec::new();
        on.download(&answers, &mut found)?;
        println!("{}: {} photons, {} queries", on.device(), photon_count, found.len());
        found
    };
    check(&estimates, u64::from(photon_count))
}

/// Compares the estimates with the exact result, within statistical bounds.
fn check(estimates: &[Estimate], photons: u64) -> Result<(), Box<dyn Error>> {
    let truth = f64::from(FLUX) / f64::from(SIDE * SIDE);
    let relative: Vec<f64> = estimates.iter().map(|e| e.irradiance(photons)[0] / truth - 1.0).collect();
    let mean = relative.iter().sum::<f64>() / relative.len() as f64;
    let worst = relative.iter().fold(0.0_f64, |worst, r| worst.max(r.abs()));
    // A disc contains about n photons, with a standard deviation of √n.
    let in_disc = photons as f64 * std::f64::consts::PI * f64::from(RADIUS * RADIUS) / f64::from(SIDE * SIDE);
    // Discs overlap, so that the mean cannot be more accurate than one estimate from all photons of the square.
    let error = 1.2 / (photons as f64).sqrt();
    println!(
        "irradiance {:.4} W/m², exact {truth:.4}: error {:+.3} %, standard error {:.3} %; worst query {:.1} %",
        truth * (1.0 + mean),
        100.0 * mean,
        100.0 * error,
        100.0 * worst
    );
    // 4.5 standard errors for the mean; 6 for the worst of 4096, which are correlated.
    if estimates.len() != (QUERIES * QUERIES) as usize || mean.abs() > 4.5 * error || worst > 6.0 / in_disc.sqrt() {
        return Err("the result differs from the closed form".into());
    }
    Ok(())
}

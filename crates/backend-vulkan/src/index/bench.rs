//! Benchmark of map building: device times.

use std::cell::RefCell;

use photon_core::random::SplitMix64;
use photon_core::{Backend, IndexKind, KdTreeBuilder, Photon, Result, Stage};

use super::VulkanBuilder;
use crate::scan::Scan;
use crate::sort::{Pairs, Sort};
use crate::vulkan::Vulkan;

/// Measured runs, after [`WARM`] warm-up runs.
const RUNS: usize = 10;
const WARM: usize = 2;

/// One row of the table.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Row {
    /// The operation.
    pub work: String,
    /// The number of elements.
    pub count: u64,
    /// Median, minimum and maximum of the runs, in milliseconds.
    pub milliseconds: [f64; 3],
}

/// Times prefix sums, sorts and the three map builders for each of `sizes`, on photons as found in scenes and
/// in worst cases, and calls `tell` with each row as it is completed.
///
/// # Errors
/// Errors of the device.
pub fn run(on: &mut Vulkan, sizes: &[u64], tell: &mut dyn FnMut(&Row)) -> Result<()> {
    for &count in sizes {
        primitives(on, count, tell)?;
        let sets = [("walls", walls(count)), ("disc", disc(count)), ("a point", place(count)), ("a cell", cell(count))];
        for (name, points) in sets {
            for (kind, of) in [
                (IndexKind::Morton, "Morton index"),
                (IndexKind::Median, "median kd-tree"),
                (IndexKind::Vvh, "VVH kd-tree"),
            ] {
                let milliseconds = build(on, &points, kind)?;
                tell(&Row { work: format!("{of}, {name}"), count, milliseconds });
            }
        }
    }
    Ok(())
}

/// Device milliseconds of `work`: median, minimum and maximum.
fn timed(
    on: &mut Vulkan,
    mut prepare: impl FnMut(&mut Vulkan) -> Result<()>,
    mut work: impl FnMut(&mut Vulkan) -> Result<()>,
) -> Result<[f64; 3]> {
    let mut all = Vec::with_capacity(RUNS);
    for turn in 0..WARM + RUNS {
        prepare(on)?;
        let _ = on.timings()?;
        on.mark(Some(Stage::Build));
        work(on)?;
        on.mark(None);
        let milliseconds = on.timings()?.get(Stage::Build) * 1e3;
        if turn >= WARM {
            all.push(milliseconds);
        }
    }
    all.sort_by(f64::total_cmp);
    Ok([f64::midpoint(all[RUNS / 2 - 1], all[RUNS / 2]), all[0], all[RUNS - 1]])
}

fn primitives(on: &mut Vulkan, count: u64, tell: &mut dyn FnMut(&Row)) -> Result<()> {
    let mut random = SplitMix64(3);
    let words: Vec<u32> = (0..2 * count).map(|_| random.word() as u32).collect();
    let pristine = on.memory("bench", 8 * count)?;
    on.write(&pristine, 0, bytemuck::cast_slice(&words))?;
    drop(words);
    let keys = [on.memory("bench", 8 * count)?, on.memory("bench", 8 * count)?];
    let values = [on.memory("bench", 4 * count)?, on.memory("bench", 4 * count)?];

    let mut scan = Scan::new(on)?;
    let (from, to) = (pristine.address(), keys[1].address());
    let milliseconds = timed(on, |_| Ok(()), |on| scan.exclusive(on, from, to, count, 0))?;
    tell(&Row { work: "prefix sums".to_owned(), count, milliseconds });

    let mut sort = Sort::new(on)?;
    for (words, bits) in [(1, 32), (2, 63)] {
        let pairs = Pairs {
            keys: [0, 1].map(|at: usize| keys[at].address()),
            values: [0, 1].map(|at: usize| values[at].address()),
            count,
            words,
            bits,
            numbered: false,
            forget_keys: false,
        };
        let prepare = |on: &mut Vulkan| on.copy(&pristine, 0, &keys[0], 0, 4 * u64::from(words) * count);
        let milliseconds = timed(on, prepare, |on| sort.pairs(on, &pairs).map(|_| ()))?;
        tell(&Row { work: format!("sort of pairs, {bits} bits"), count, milliseconds });
    }
    Ok(())
}

fn build(on: &mut Vulkan, points: &[Photon], kind: IndexKind) -> Result<[f64; 3]> {
    let mut builder = VulkanBuilder::new(on, kind)?;
    let photons = RefCell::new(Some(on.upload("photons: global", points)?));
    // The photons are still in the buffer: only their count is cleared when a map is reclaimed.
    let again = |on: &mut Vulkan| match photons.borrow_mut().as_mut() {
        Some(buffer) => on.set_length(buffer, points.len() as u64),
        None => Ok(()),
    };
    timed(on, again, |on| {
        let Some(buffer) = photons.take() else { return Ok(()) };
        let map = builder.build(on, buffer)?;
        photons.replace(Some(builder.reclaim(map)));
        Ok(())
    })
}

fn photon(position: [f32; 3]) -> Photon {
    Photon { position, direction: 1, power: [1.0; 3], normal: 2 }
}

/// On five walls of a unit box.
fn walls(count: u64) -> Vec<Photon> {
    let mut random = SplitMix64(1);
    let on_wall = |i: u64| {
        let (u, v) = (random.unit(), random.unit());
        photon(match i % 5 {
            0 => [u, 0.0, v],
            1 => [u, 1.0, v],
            2 => [u, v, 1.0],
            3 => [0.0, u, v],
            _ => [1.0, u, v],
        })
    };
    (0..count).map(on_wall).collect()
}

/// All photons at one point.
fn place(count: u64) -> Vec<Photon> {
    (0..count).map(|_| photon([0.5, 0.25, 0.125])).collect()
}

/// On the walls, except one that is so far away that all others share one Morton code.
fn cell(count: u64) -> Vec<Photon> {
    let mut all = walls(count);
    if let Some(last) = all.last_mut() {
        last.position = [1e9, 0.0, 0.0];
    }
    all
}

/// Nine tenths in a disc of radius 0.05 on the floor, with density 1/r.
fn disc(count: u64) -> Vec<Photon> {
    let mut random = SplitMix64(2);
    let mut all = walls(count);
    for photon in &mut all {
        if random.unit() < 0.9 {
            let (r, angle) = (0.05 * random.unit(), random.unit() * std::f32::consts::TAU);
            photon.position = [0.5 + r * angle.cos(), 0.0, 0.5 + r * angle.sin()];
        }
    }
    all
}

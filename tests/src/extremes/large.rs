//! S10, S11: maps of as many photons as fit in memory.

use photon_core::{Backend, Error, Estimate, EstimateParams, IndexKind, Photon, Query, Result, Search};

use super::sheet::Sheet;
use crate::harness::{TestBackend, photon_at, query_at};

/// Photons along a side of the unit square. The last two give slightly more and slightly less than 2³² bytes of
/// photons; the latter fits a device whose largest allocation is just below 4 GiB.
const LONG: [u32; 4] = [5478, 8200, 11_600, 11_582];

/// Rank of the neighbour whose distance is requested.
const K: u32 = 20;

/// Power of each photon, in W.
const POWER: f32 = 1e-8;

/// Runs the group.
pub fn all<T: TestBackend>(sheet: &mut Sheet) {
    if !sheet.long() {
        lattice::<T>(sheet, 317, IndexKind::Morton);
        return;
    }
    // A software device would take hours.
    if T::make(1).device().contains("llvmpipe") {
        lattice::<T>(sheet, 1733, IndexKind::Morton);
        return;
    }
    let mut tried = LONG.iter();
    for &side in tried.by_ref() {
        let held = [IndexKind::Morton, IndexKind::Median, IndexKind::Vvh].map(|kind| lattice::<T>(sheet, side, kind));
        // The remaining ones are smaller than this one, which held.
        if side >= LONG[2] && held == [true; 3] {
            break;
        }
    }
}

/// Coordinate of the photon with this number along a side.
fn at(i: u32, side: u32) -> f32 {
    (i as f32 + 0.5) / side as f32
}

/// Maximum number of photons per query: a GPU assigns one subgroup to a query.
const MAX_PHOTONS: u64 = 31_000_000;

/// A map of `side²` photons: whether it fits; that discs of many sizes, up to one with all photons, contain as many
/// as a count of the lattice gives; and that its flux sums accurately.
fn lattice<T: TestBackend>(sheet: &mut Sheet, side: u32, kind: IndexKind) -> bool {
    let count = u64::from(side) * u64::from(side);
    let range = format!("{kind:?}, {count} photons, {:.3} GiB", count as f64 * 32.0 / f64::from(1 << 30));
    let places = [0.0, 0.001, 0.3, 0.5, 0.77, 0.999, 1.0];
    let radii = [5.3 / side as f32, 20.0 / side as f32, 0.01_f32.max(40.0 / side as f32)];
    let about = |radius: f32| places.iter().flat_map(move |&y| places.map(|x| query_at([x, y, 0.0], radius)));
    let mut queries: Vec<Query> = radii.into_iter().flat_map(about).collect();
    let whole = count <= MAX_PHOTONS;
    if whole {
        queries.push(query_at([0.5, 0.5, 0.0], 2.0));
    }
    let [within, nearest] = match ask(&mut T::make(2), kind, side, &queries) {
        Ok(found) => found,
        Err(error @ (Error::OutOfMemory { .. } | Error::AllocationTooLarge { .. })) => {
            let what = "photons that no allocation holds are refused by name";
            sheet.holds("S10 S11", what, range, error.to_string(), side == LONG[2]);
            return false;
        }
        Err(error) => {
            sheet.holds("S10 S11", "a large map", range, error.to_string(), false);
            return false;
        }
    };
    let (mut wrong, mut worst, mut most) = (0, 0.0_f64, 0);
    for (query, (within, nearest)) in queries.iter().zip(within.iter().zip(&nearest)) {
        let all = query.radius > 1.0;
        let squares = by_hand(side, query);
        let expected = if all { count } else { squares.len() as u64 };
        wrong += usize::from(expected != u64::from(within.photons));
        wrong += usize::from(squares[K as usize - 1].to_bits() != nearest.radius_squared.to_bits());
        worst = worst.max((f64::from(within.flux[0]) / (expected as f64 * f64::from(POWER)) - 1.0).abs());
        most = most.max(within.photons);
    }
    let found = format!("{most} in one estimate, {worst:.1e}; {wrong} wrong of {}", 2 * queries.len());
    let what =
        "discs hold what a count of the lattice finds, and its flux, relative; 20th neighbours by the same count";
    sheet.holds("S10 S11", what, range, found, worst < 1e-6 && wrong == 0);
    true
}

/// Estimates with all photons within the radius of each query, and with the nearest ones.
fn ask<B: Backend>(on: &mut B, kind: IndexKind, side: u32, queries: &[Query]) -> Result<[Vec<Estimate>; 2]> {
    let mut stages = on.map_stages(kind)?;
    let photon = |i: u32| Photon { power: [POWER; 3], ..photon_at([at(i % side, side), at(i / side, side), 0.0]) };
    let photons: Vec<Photon> = (0..side * side).map(photon).collect();
    let there = on.upload("photons", &photons)?;
    drop(photons);
    let map = stages.builder.build(on, there)?;
    let mut found = [Vec::new(), Vec::new()];
    for (search, found) in [Search::Radius, Search::KNearest { k: K }].into_iter().zip(&mut found) {
        let asked = on.upload("queries", queries)?;
        let mut estimates = on.alloc("estimates", queries.len() as u64)?;
        let gather = EstimateParams::new(search);
        stages.estimator.estimate(on, &map, &asked, &gather, &mut estimates)?;
        on.download(&estimates, found)?;
    }
    Ok(found)
}

/// Squared distances of the photons within the radius, nearest first, in the arithmetic of the kernels; if the
/// radius contains all photons, only of the nearest ones.
fn by_hand(side: u32, query: &Query) -> Vec<f32> {
    let reach = if query.radius > 1.0 { 10 } else { (query.radius * side as f32) as u32 + 3 };
    let about = |x: f32| {
        let middle = (x * side as f32) as u32;
        middle.saturating_sub(reach)..(middle + reach).min(side)
    };
    let mut squares = Vec::new();
    for row in about(query.position[1]) {
        for column in about(query.position[0]) {
            let (dx, dy) = (at(column, side) - query.position[0], at(row, side) - query.position[1]);
            squares.push(dx * dx + dy * dy);
        }
    }
    squares.retain(|&square| square <= query.radius * query.radius);
    squares.sort_unstable_by(f32::total_cmp);
    squares
}

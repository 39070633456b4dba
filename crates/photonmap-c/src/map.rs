//! Photon maps of the caller's photons.

use photonmap::IndexKind;
use photonmap::cpu::index::{IndexError, Neighbours, PointIndex};
use photonmap::glam::Vec3;
use rayon::prelude::*;

use crate::error::{Fault, PmStatus, Result, call, free};
use crate::pointer;

/// Photons for searching. Several threads may read it at once. Searches use all cores.
#[derive(Debug)]
pub struct PmMap {
    index: PointIndex,
    /// By slot of the index; empty without normals.
    normals: Vec<Vec3>,
    /// By slot of the index; empty without powers.
    powers: Vec<Vec3>,
}

/// Photons on the other side of a surface, or of one that is inclined by more than 45 degrees, do not count.
const MIN_COSINE: f32 = 0.7;

/// Fails at the first point that is not finite.
fn check(points: &[[f32; 3]], name: &str) -> Result {
    match points.iter().position(|point| !point.iter().all(|part| part.is_finite())) {
        Some(index) => Err(Fault::argument(format!("{name}: {index} is {:?}, which is not finite", points[index]))),
        None => Ok(()),
    }
}

/// Triples of floats of the caller.
///
/// # Safety
/// As [`pointer::array`].
unsafe fn triples<'a>(pointer: *const f32, count: usize, name: &str) -> Result<&'a [[f32; 3]]> {
    // SAFETY: as the caller ensures.
    let all = unsafe { pointer::array(pointer, pointer::product(count, 3, name)?, name) }?.as_chunks().0;
    check(all, name)?;
    Ok(all)
}

impl PmMap {
    fn new(positions: &[[f32; 3]], normals: &[[f32; 3]], powers: &[[f32; 3]]) -> Result<Self> {
        let index =
            PointIndex::build(positions, IndexKind::Morton).map_err(|error: IndexError| Fault::argument(error))?;
        let sorted = |all: &[[f32; 3]]| -> Vec<Vec3> {
            if all.is_empty() { Vec::new() } else { index.order().iter().map(|&id| all[id as usize].into()).collect() }
        };
        let normals = sorted(normals).into_iter().map(Vec3::normalize_or_zero).collect();
        let powers = sorted(powers);
        Ok(Self { index, normals, powers })
    }

    /// Irradiance at a point, from the `k` nearest photons that face the same way, of which the farthest only sets the
    /// radius.
    fn irradiance(&self, at: [f32; 3], normal: Vec3, k: usize, max_r2: f32, found: &mut Neighbours) -> [f32; 3] {
        let faces = |slot: u32| match self.normals.get(slot as usize) {
            Some(photon) => photon.dot(normal) >= MIN_COSINE,
            None => true,
        };
        self.index.nearest(at, k, max_r2, faces, found);
        let found = found.as_slice();
        let (inside, r2) = match found {
            // All photons within the largest radius.
            _ if found.len() < k && max_r2 < f32::INFINITY => (found, max_r2),
            [inside @ .., farthest] => (inside, farthest.d2),
            [] => return [0.0; 3],
        };
        let flux: [f64; 3] = inside.iter().fold([0.0; 3], |sum, neighbour| {
            let power = self.powers.get(neighbour.slot as usize).copied().unwrap_or(Vec3::ONE);
            [0, 1, 2].map(|c| sum[c] + f64::from(power[c]))
        });
        if !(r2 > 0.0) {
            return [0.0; 3];
        }
        flux.map(|sum| (sum / (std::f64::consts::PI * f64::from(r2))) as f32)
    }
}

/// Makes a photon map of `count` photons; the arrays are copied.
///
/// `positions`: 3 coordinates for each photon, finite. `normals`: those of the surfaces, 3 for each, of any length; NULL:
/// photons of all surfaces count. `powers`: flux in RGB, W, 3 for each; NULL: 1 W each. `*map` is to be freed with
/// pm_map_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_map_new(
    positions: *const f32,
    normals: *const f32,
    powers: *const f32,
    count: usize,
    map: *mut *mut PmMap,
) -> PmStatus {
    call(|| {
        let length = |array: *const f32| if array.is_null() { 0 } else { count };
        // SAFETY: the caller's arrays of 3 `count` elements, or NULL, and pointer to a handle.
        unsafe {
            pointer::hand_out(map, || {
                PmMap::new(
                    triples(positions, count, "positions")?,
                    triples(normals, length(normals), "normals")?,
                    triples(powers, length(powers), "powers")?,
                )
            })
        }
    })
}

/// Finds the `k` nearest photons, above 0, of each of `count` points.
///
/// `positions`: 3 coordinates for each point, finite. `max_radius`: photons farther away do not count; may be infinite.
/// `ids` and `squared_distances`, each of `count` times `k` elements, of which one may be NULL: rows of `k`, nearest
/// first, of equal distances the lowest index first; where there are fewer, UINT32_MAX and infinity.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_map_nearest(
    map: *const PmMap,
    positions: *const f32,
    count: usize,
    k: usize,
    max_radius: f32,
    ids: *mut u32,
    squared_distances: *mut f32,
) -> PmStatus {
    call(|| {
        let max_r2 = squared(max_radius)?;
        if k == 0 || (ids.is_null() && squared_distances.is_null()) {
            let what =
                if k == 0 { "k is 0, but has to be above 0" } else { "ids and squared_distances are NULL; give one" };
            return Err(Fault::argument(what));
        }
        let all = pointer::product(count, k, "ids")?;
        // SAFETY: the caller's handle and arrays, of which those that are NULL have no elements.
        let (map, points, ids, distances) = unsafe {
            let ids_length = if ids.is_null() { 0 } else { all };
            let distances_length = if squared_distances.is_null() { 0 } else { all };
            (
                pointer::shared(map, "map")?,
                triples(positions, count, "positions")?,
                pointer::array_mut(ids, ids_length, "ids")?,
                pointer::array_mut(squared_distances, distances_length, "squared_distances")?,
            )
        };
        if all == 0 {
            return Ok(());
        }
        let mut found = reserved(all)?;
        found.par_chunks_mut(k).zip(points).for_each_init(Neighbours::new, |neighbours, (row, &point)| {
            map.index.nearest_of_all(point, k, max_r2, neighbours);
            for (slot, neighbour) in row.iter_mut().zip(neighbours.as_slice()) {
                *slot = (neighbour.id, neighbour.d2);
            }
        });
        ids.iter_mut().zip(&found).for_each(|(slot, &(id, _))| *slot = id);
        distances.iter_mut().zip(&found).for_each(|(slot, &(_, d2))| *slot = d2);
        Ok(())
    })
}

/// Rows of neighbours that have not been found.
fn reserved(count: usize) -> Result<Vec<(u32, f32)>> {
    let mut rows = Vec::new();
    let refused = |_| Fault::new(PmStatus::OutOfMemory, format!("{count} neighbours do not fit into memory"));
    rows.try_reserve_exact(count).map_err(refused)?;
    rows.resize(count, (u32::MAX, f32::INFINITY));
    Ok(rows)
}

/// The square of a radius of the caller.
fn squared(radius: f32) -> Result<f32> {
    // NaN fails the comparison.
    if !(radius > 0.0) {
        return Err(Fault::argument(format!("max_radius is {radius}, but has to be above 0")));
    }
    Ok(radius * radius)
}

/// Estimates irradiance, W/m² in RGB, at each of `count` points (Jensen 1996): the flux of the `k` nearest photons over the
/// area of their disc, whose radius is the distance of the farthest, which does not count itself.
///
/// `positions` and `normals`: 3 for each point; photons count whose normal differs by at most 45 degrees, and all of them if
/// the map has no normals. `k`: at least 2. `max_radius`: largest radius, may be infinite; it is the radius where there are
/// fewer than `k` photons within. `irradiance`: 3 for each point.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_map_irradiance(
    map: *const PmMap,
    positions: *const f32,
    normals: *const f32,
    count: usize,
    k: usize,
    max_radius: f32,
    irradiance: *mut f32,
) -> PmStatus {
    call(|| {
        if !(2..=u32::MAX as usize).contains(&k) {
            return Err(Fault::argument(format!("k is {k}, but has to be at least 2 and below 2^32")));
        }
        let max_r2 = squared(max_radius)?;
        // SAFETY: the caller's handle and arrays of 3 `count` elements.
        let (map, positions, normals, values) = unsafe {
            (
                pointer::shared(map, "map")?,
                triples(positions, count, "positions")?,
                triples(normals, count, "normals")?,
                pointer::array_mut(irradiance, pointer::product(count, 3, "irradiance")?, "irradiance")?,
            )
        };
        let points = positions.par_iter().zip(normals);
        values.as_chunks_mut::<3>().0.par_iter_mut().zip(points).for_each_init(
            Neighbours::new,
            |neighbours, (value, (&position, &normal))| {
                *value = map.irradiance(position, Vec3::from(normal).normalize_or_zero(), k, max_r2, neighbours);
            },
        );
        Ok(())
    })
}

/// Frees a map; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_map_free(map: *mut PmMap) {
    // SAFETY: the caller's handle.
    free(|| unsafe { pointer::free(map) });
}

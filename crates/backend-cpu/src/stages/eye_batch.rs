//! Camera paths in batches: those of a row surface by surface, so that a ray caster gets many rays at once.

use photon_core::memory::{self, OutOfMemory};
use photon_core::{FilmPixel, QUERIES_PER_PIXEL};

use crate::stages::eye::{Eye, Found, POINTS, Path, QUERIES, REFLECTIONS};

/// The paths of a pixel: the one that is being traced, and those that have branched off.
struct Pixel {
    column: usize,
    path: Path,
    waiting: Vec<Path>,
}

/// Traces the paths of a row, in a scene without alpha or media that scatter light. Each pixel meets its surfaces in the same
/// order as without batches.
pub(super) fn trace_row(
    eye: &Eye<'_>,
    row: u32,
    (has_lens, reflections): (bool, bool),
    pixels: &mut [FilmPixel],
    found: &mut Found,
) -> Result<(), OutOfMemory> {
    let first = if has_lens { Eye::first::<true> } else { Eye::first::<false> };
    let start = |column| Pixel { column, path: first(eye, column as u32, row), waiting: Vec::new() };
    let mut active = memory::collected((0..pixels.len()).map(start), QUERIES)?;
    let mut rays = memory::with_capacity(active.len(), QUERIES)?;
    let mut hits = memory::with_capacity(active.len(), QUERIES)?;
    while !active.is_empty() {
        memory::reserve_doubling(&mut found.queries, active.len() * QUERIES_PER_PIXEL as usize, QUERIES)?;
        rays.clear();
        rays.extend(active.iter().map(|pixel| pixel.path.ray));
        eye.scene.hit_many(&rays, &mut hits);
        let mut hit = hits.iter();
        active.retain_mut(|Pixel { column, path, waiting }| {
            let number = row * eye.view.width + *column as u32;
            let sampler = |branch: u32| eye.sampler(number, branch);
            let (pixel, hit) = (&mut pixels[*column], Some(hit.next().copied().flatten()));
            let next = if reflections {
                eye.step::<true, false, REFLECTIONS>(path, hit, number, pixel, found, &sampler)
            } else {
                eye.step::<true, false, POINTS>(path, hit, number, pixel, found, &sampler)
            };
            if let Some(branch) = next {
                waiting.extend(branch);
                return true;
            }
            let Some(next) = waiting.pop() else { return false };
            *path = next;
            true
        });
    }
    // In the order of the pixels; the queries of a pixel keep theirs.
    found.queries.sort_by_key(|query| query.pixel);
    debug_assert!(found.queries.len() <= pixels.len() * QUERIES_PER_PIXEL as usize);
    Ok(())
}

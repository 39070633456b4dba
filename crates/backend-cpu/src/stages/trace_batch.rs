//! Photon tracing in batches: the paths of a block surface by surface, so that a ray caster gets many rays at once.

use photon_core::{Photon, PhotonRay};

use crate::stages::trace::{Paused, TraceOutput, Walk};

/// Traces the paths that begin with `starts`. The photons are appended in the order in which they are stored if each path
/// is traced to its end before the next one.
pub(super) fn trace(walk: &Walk<'_>, starts: &[PhotonRay], output: &mut TraceOutput) {
    let before = output.photons.each_ref().map(|photons| photons.stored.len());
    let mut owners = output.photons.each_ref().map(|_| Vec::new());
    let mut paths: Vec<(usize, Paused)> = (0..starts.len()).map(|index| (index, Paused::default())).collect();
    let (mut rays, mut hits) = (Vec::with_capacity(paths.len()), Vec::with_capacity(paths.len()));
    loop {
        paths.retain_mut(|(index, paused)| {
            (walk.follow)(walk, &starts[*index], output, paused);
            for (kind, photons) in output.photons.iter() {
                // What this path has stored at its surface.
                owners[kind].resize(photons.stored.len() - before[kind], *index);
            }
            paused.path.is_some()
        });
        if paths.is_empty() {
            break;
        }
        rays.clear();
        rays.extend(paths.iter().filter_map(|(_, paused)| paused.path.map(|path| path.ray)));
        walk.scene.hit_many(&rays, &mut hits);
        paths.iter_mut().zip(&hits).for_each(|((_, paused), &hit)| paused.hit = Some(hit));
    }
    for (kind, owners) in owners.iter() {
        sort(&mut output.photons[kind].stored[before[kind]..], owners);
    }
}

/// Sorts photons by the path that has stored them; those of one path keep their order.
fn sort(photons: &mut [Photon], owners: &[usize]) {
    let mut order: Vec<usize> = (0..photons.len()).collect();
    order.sort_by_key(|&at| owners[at]);
    let sorted: Vec<Photon> = order.into_iter().map(|at| photons[at]).collect();
    photons.copy_from_slice(&sorted);
}

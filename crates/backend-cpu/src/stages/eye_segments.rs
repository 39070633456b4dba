//! Segments of camera paths in media that scatter light.

use photon_core::glam::Vec3;
use photon_core::random::{BLOCK_SEGMENTS, Domain, Sampler, unit_f32};
use photon_core::{MediumStack, QUERIES_PER_PIXEL, Query, RandomKind, Ray, Segment, flight};

use super::eye::{Eye, Path};
use crate::stretches::Stretch;

/// The end of a segment.
#[derive(Clone, Copy)]
pub(super) struct End {
    /// Distance from the start.
    pub(super) distance: f32,
    /// Normal of the plane there.
    pub(super) normal: Vec3,
}

/// Leaves the segments of a path in `media` up to its end: one for each stretch in which light is scattered. Returns the
/// transmittance of all of it.
#[inline]
pub(super) fn leave(
    eye: &Eye<'_>,
    path: &Path,
    media: MediumStack,
    end: End,
    pixel: u32,
    segments: &mut Vec<Query>,
) -> Vec3 {
    let (scene, direction) = (eye.scene, path.ray.direction);
    let start = if path.start.dot(direction) < 0.0 { -path.start } else { path.start };
    let camera = MediumStack::from_bits(eye.view.camera.media);
    let solid = scene.solid(media);
    let seen = path.throughput * scene.radiance_scale(camera, media, path.wavelength);
    let mut passed = Vec3::ONE;
    for stretch in scene.stretches(&path.ray, end.distance, media) {
        let (length, throughput) = (stretch.to - stretch.from, seen * passed);
        if scene.medium_at(stretch.medium).scatters() && length > 0.0 && throughput != Vec3::ZERO {
            let origin = path.ray.origin + direction * stretch.from;
            let planes = [stretch.planes[0].unwrap_or(start), stretch.planes[1].unwrap_or(end.normal)];
            // The medium that applies, above that of the solid if they differ.
            let media = MediumStack::in_medium(solid);
            let media = if stretch.medium == solid { media } else { media.enter(stretch.medium) };
            segments.push(Segment { origin, direction, length, planes, media, throughput }.query(pixel, 0));
        }
        passed *= scene.stretch_transmittance(&path.ray, &stretch);
    }
    passed
}

/// Leaves at most [`Eye::most_segments`] of the segments of a pixel, those from `first` on: of the last and all that come
/// later only one, chosen in proportion to the light that it may scatter, which then stands for all of them.
pub(super) fn limit(eye: &Eye<'_>, pixel: u32, segments: &mut Vec<Query>, first: usize) {
    let most = eye.most_segments as usize;
    if segments.len() - first > most {
        let last = first + most - 1;
        let pass = eye.pass;
        let mut sampler =
            Sampler::new(RandomKind::Counter, pass.seed, pass.index, Domain::Segment, pixel * QUERIES_PER_PIXEL)
                .of_sample(pass.sample);
        let (mut total, mut kept) = (0.0, None);
        for (number, &candidate) in (0..).zip(&segments[last..]) {
            let weight = weight(eye, &candidate);
            total += weight;
            let [word, ..] = sampler.words(BLOCK_SEGMENTS + number);
            if weight > 0.0 && unit_f32(word) * total < weight {
                kept = Some((candidate, weight));
            }
        }
        segments.truncate(last);
        segments.extend(kept.map(|(mut kept, weight)| {
            kept.throughput = (Vec3::from(kept.throughput) * (total / weight)).into();
            kept
        }));
    }
    for (number, segment) in (0..).zip(&mut segments[first..]) {
        segment.path = pixel * QUERIES_PER_PIXEL + number;
    }
}

/// Light that a segment scatters into the pixel, if all of it arrives evenly.
fn weight(eye: &Eye<'_>, query: &Query) -> f32 {
    let segment = Segment::of(query);
    let (index, medium) = eye.scene.medium(segment.media);
    let (extinction, scattering) = (medium.extinction(), Vec3::from(medium.scattering));
    let (ray, whole) = along(&segment, index);
    let column = eye.scene.column(&ray, &whole);
    let lost = Vec3::ONE - flight::transmittance(medium, column);
    // For small depths the limit.
    let share = |c: usize| {
        if lost[c] > 1e-3 { scattering[c] * lost[c] / extinction[c] } else { scattering[c] * column }
    };
    (0..3).map(|c| segment.throughput[c] * share(c)).sum()
}

/// A segment as a ray and the whole of it, in the medium with this index.
fn along(segment: &Segment, medium: u32) -> (Ray, Stretch) {
    let ray = Ray { origin: segment.origin, direction: segment.direction, t_max: segment.length };
    (ray, Stretch { from: 0.0, to: segment.length, medium, planes: [None; 2] })
}

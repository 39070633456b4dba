//! Mean radiance of textured emitters: the integral of a texture over a triangle.

use glam::{DVec2, DVec3};
use photon_core::{Filter, Texture};

use super::pyramid::{Level, Pyramid};
use super::{Source, uvs};
use crate::normalise::Geometry;

/// Number of evaluations for all triangles together.
const EFFORT: f64 = (1 << 24) as f64;

/// The means of textures over emissive triangles.
pub(crate) struct Radiances<'a> {
    source: Source<'a>,
    geometry: &'a Geometry,
    /// By texture; made on first use.
    pyramids: Vec<Option<Pyramid>>,
    /// Largest number of parts into which each edge of a triangle is divided.
    max_parts: f64,
}

impl<'a> Radiances<'a> {
    pub(crate) fn new(source: Source<'a>, geometry: &'a Geometry) -> Self {
        let max_parts = (EFFORT / geometry.emitters.len().max(1) as f64).sqrt().clamp(8.0, 512.0);
        Self { source, geometry, pyramids: vec![None; source.textures.len()], max_parts }
    }

    /// The factor on the emission of a triangle's material: the mean of its emission texture over the triangle, 0 only
    /// if the texture is black there. `None` without a texture.
    pub(crate) fn factor(&mut self, primitive: u32) -> Option<DVec3> {
        let (_, material) = self.geometry.primitives[primitive as usize];
        let used = self.source.materials[material as usize].textures.emission?;
        let mesh = &self.source.meshes[self.geometry.mesh_of(primitive)];
        let uvs = &mesh.attributes.uvs[used.uv_set as usize];
        let corners = mesh.triangles[self.geometry.sources[primitive as usize] as usize];
        let places = corners.map(|vertex| {
            let place = used.place(uvs[vertex as usize].map(uvs::finite)).map(uvs::finite);
            // Beyond this, f64 has no fractions, and sums could overflow.
            DVec2::from_array(place.map(|part| part.clamp(-1e15, 1e15)))
        });
        let image = self.source.image(used);
        let pyramid = self.pyramids[used.texture.0 as usize].get_or_insert_with(|| Pyramid::new(image));
        let mean = mean(pyramid, image, places, self.max_parts);
        Some(if mean == DVec3::ZERO { trace(pyramid, image, places) } else { mean })
    }
}

/// The extent of the triangle along each axis, in texels of a level.
fn extent(places: [DVec2; 3], level: &Level) -> f64 {
    let [a, b, c] = places;
    let size = DVec2::new(level.width as f64, level.height as f64);
    let longest = [b - a, c - a, c - b].into_iter().fold(DVec2::ZERO, |most, edge| most.max(edge.abs()));
    (longest * size).max_element()
}

/// The mean over a triangle: centroids of parts half a texel wide, of the finest level for which they are not too many.
fn mean(pyramid: &Pyramid, image: &Texture, places: [DVec2; 3], max_parts: f64) -> DVec3 {
    let fits = |level: &&Level| 2.0 * extent(places, level) <= max_parts;
    let last = pyramid.levels.len() - 1;
    let number = pyramid.levels.iter().position(|level| fits(&level)).unwrap_or(last);
    let level = &pyramid.levels[number];
    // Coarser levels are means already, so that there is nothing sharp in them.
    let filter = if number == 0 && pyramid.is_exact { image.filter } else { Filter::Linear };
    let parts = (2.0 * extent(places, level)).ceil().clamp(1.0, max_parts) as usize;
    let step = 1.0 / parts as f64;
    let [a, b, c] = places;
    let mut sum = DVec3::ZERO;
    for row in 0..parts {
        for column in 0..parts - row {
            // The centroid of the part, and of the reversed one beside it.
            for third in [1.0 / 3.0, 2.0 / 3.0] {
                if third > 0.5 && row + column + 1 >= parts {
                    continue;
                }
                let (s, t) = ((column as f64 + third) * step, (row as f64 + third) * step);
                sum += level.lookup(a + (b - a) * s + (c - a) * t, image.wrap, filter);
            }
        }
    }
    sum * (step * step)
}

/// A small colour for a triangle of which no evaluated point is bright: a trace of the texels that it touches, 0 if they
/// all are black.
fn trace(pyramid: &Pyramid, image: &Texture, places: [DVec2; 3]) -> DVec3 {
    const MAX_EXTENT: f64 = 64.0;
    const SHARE: f64 = 1.0 / 4096.0;
    let Some(level) = pyramid.levels.iter().find(|level| extent(places, level) <= MAX_EXTENT) else {
        // It covers the whole texture many times, and the mean of all is 0.
        return DVec3::ZERO;
    };
    let size = DVec2::new(level.width as f64, level.height as f64);
    let texels = places.map(|place| place * size);
    let low = texels.iter().fold(texels[0], |low, at| low.min(*at)).floor() - 1.0;
    let high = texels.iter().fold(texels[0], |high, at| high.max(*at)).floor() + 1.0;
    let reach = if image.filter == Filter::Nearest && pyramid.is_exact { 0.5 } else { 1.0 };
    let mut most = DVec3::ZERO;
    for row in 0..=(high.y - low.y) as usize {
        for column in 0..=(high.x - low.x) as usize {
            let centre = low + DVec2::new(column as f64, row as f64) + 0.5;
            let color = level.lookup(centre / size, image.wrap, Filter::Nearest);
            if color != DVec3::ZERO && overlaps(texels, centre, reach) {
                most = most.max(color);
            }
        }
    }
    most * SHARE
}

/// Whether a triangle overlaps the inside of a square around `centre` (separating axes).
fn overlaps(triangle: [DVec2; 3], centre: DVec2, half: f64) -> bool {
    let corners = triangle.map(|corner| corner - centre);
    let edges = [corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]];
    [DVec2::X, DVec2::Y].into_iter().chain(edges.map(DVec2::perp)).all(|axis| {
        let along = corners.map(|corner| corner.dot(axis));
        let (low, high) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
        let reach = half * (axis.x.abs() + axis.y.abs());
        // A degenerate edge separates nothing.
        axis == DVec2::ZERO || (low < reach && high > -reach)
    })
}

//! The smallest radius that is useful: a share of the width of a pixel on the surfaces that show a map's light.

use crate::backend::stages::View;
use crate::scene::camera::Camera;
use crate::scene::layout::{Estimate, Query};

/// The smallest derived radius of the first pass, in widths of a pixel. The disc then has 0.8 of the pixel's area: light
/// that is concentrated in one point is found by most of the camera rays of that pixel, and spread no farther than
/// to its neighbours.
const LEAST: f64 = 0.5;

/// Radius with which light is searched to weight pixels, in widths of a pixel: above √2, so that no light in a pixel is
/// missed, wherever in the pixel its camera ray is.
const SEARCH: f64 = 1.5;

/// The share of a map's light that may be seen by pixels that are narrower than the one from which the bound is taken.
const NARROWER: f64 = 0.05;

/// Most pixels for which light is searched. Those of larger pictures are joined, so that spots of light are not missed between
/// them.
const MOST_PIXELS: f64 = 16_384.0;

/// Largest distance of two points of the scene, normalised space: the diagonal of the unit cube.
const DIAGONAL: f64 = 1.732_050_807_568_877_2;

/// Widths of the pixels of a view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    /// The view with at most [`MOST_PIXELS`] pixels.
    pub(crate) joined: View,
    /// Half the width and height of the picture, at distance 1 or everywhere.
    half: [f64; 2],
    /// Width of a pixel of `joined` at distance 1, or everywhere if rays are parallel: of its two sides the shorter one.
    unit: f64,
    /// Width of a pixel of the picture, in widths of a pixel of `joined`.
    part: f64,
}

impl Footprint {
    pub(crate) fn new(view: &View) -> Self {
        let length = |[x, y, z]: [f32; 3]| libm::hypot(libm::hypot(f64::from(x), f64::from(y)), f64::from(z));
        let half = [length(view.camera.right), length(view.camera.up)];
        let reduction = (MOST_PIXELS / (f64::from(view.width) * f64::from(view.height))).sqrt().min(1.0);
        let reduced = |all: u32, most: f64| ((f64::from(all) * reduction).min(most) as u32).max(1);
        // The shorter side has at least one pixel, and the longer one as many as are left.
        let short = reduced(view.width.min(view.height), MOST_PIXELS);
        let long = reduced(view.width.max(view.height), MOST_PIXELS / f64::from(short));
        let (width, height) = if view.width < view.height { (short, long) } else { (long, short) };
        let joined = View { camera: view.camera, width, height };
        let unit = |view: &View| (2.0 * half[0] / f64::from(view.width)).min(2.0 * half[1] / f64::from(view.height));
        Self { joined, half, unit: unit(&joined), part: unit(view) / unit(&joined) }
    }

    /// An upper bound of the smallest radius anywhere in the scene: larger radii need no camera rays to be known useful.
    pub(crate) fn most(&self) -> f64 {
        let camera = &self.joined.camera;
        let distance = match camera.kind {
            Camera::ORTHOGRAPHIC => 1.0,
            _ => {
                let from_centre = camera.origin.iter().map(|&x| f64::from(x) * f64::from(x)).sum::<f64>().sqrt();
                from_centre + 0.5 * DIAGONAL
            }
        };
        LEAST * self.part * self.unit * distance
    }

    /// Width of the query's pixel of `joined` at the query, perpendicular to the camera ray and in the direction in which it is
    /// narrowest, normalised space. A path by way of mirrors or glass is at least as long as the straight line that is
    /// used here. What they magnify is seen by narrower pixels: it is left out.
    fn width(&self, query: &Query) -> f64 {
        let camera = &self.joined.camera;
        if camera.kind == Camera::ORTHOGRAPHIC {
            return self.unit;
        }
        let towards = |axis: usize| f64::from(query.position[axis]) - f64::from(camera.origin[axis]);
        let distance = (0..3).map(|axis| towards(axis) * towards(axis)).sum::<f64>().sqrt();
        let (column, row) = (query.pixel % self.joined.width, query.pixel / self.joined.width);
        let offset = |at: u32, all: u32, half: f64| half * ((2.0 * f64::from(at) + 1.0) / f64::from(all) - 1.0);
        let x = offset(column, self.joined.width, self.half[0]);
        let y = offset(row, self.joined.height, self.half[1]);
        // Across the ray a pixel is narrower by the cosine of its angle to the axis, for each of two reasons: its side is
        // farther away, and seen obliquely.
        self.unit * distance / (1.0 + x * x + y * y)
    }

    /// Gives each query a radius that finds all of the light in its pixel.
    pub(crate) fn search(&self, queries: &mut [Query]) {
        queries.iter_mut().for_each(|query| query.radius = (SEARCH * self.width(query)) as f32);
    }

    /// The smallest useful radius of the first pass of a map, normalised space, from estimates of its light at
    /// [`Footprint::search`]; 0 if no light was found.
    ///
    /// All pixels share the radius of a map, and one that suits a distant wall would blur caustics near the camera.
    /// Therefore the bound is that of the narrowest pixels that show the map's light: only a twentieth of it is seen by
    /// narrower ones. Pixels are weighted by the radiance that they show, so that it does not matter how large the rest of
    /// the scene is.
    pub(crate) fn bound(&self, queries: &[Query], estimates: &[Estimate]) -> f32 {
        let light = |(query, estimate): (&Query, &Estimate)| {
            let flux = query.throughput.iter().zip(estimate.flux).map(|(&t, f)| f64::from(t) * f64::from(f));
            (self.width(query), flux.sum::<f64>() / f64::from(estimate.radius_squared))
        };
        let lit = queries.iter().zip(estimates).map(light).filter(|(_, light)| *light > 0.0 && light.is_finite());
        (LEAST * self.part * quantile(lit.collect())) as f32
    }
}

/// The smallest width such that the pixels up to it show more than the share [`NARROWER`] of the light; 0 without light.
fn quantile(mut lit: Vec<(f64, f64)>) -> f64 {
    lit.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = lit.iter().map(|(_, light)| light).sum();
    let mut sum = 0.0;
    let found = lit.iter().find(|(_, light)| {
        sum += light;
        sum > NARROWER * all
    });
    found.map_or(0.0, |(width, _)| *width)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(kind: u32) -> View {
        let camera = Camera {
            origin: [0.0, 0.0, 0.5],
            kind,
            forward: [0.0, 0.0, -1.0],
            right: [0.4, 0.0, 0.0],
            up: [0.0, 0.3, 0.0],
            ..Camera::default()
        };
        View { camera, width: 8, height: 4 }
    }

    fn query(position: [f32; 3], pixel: u32) -> Query {
        Query { position, pixel, radius: 1.0, throughput: [1.0; 3], ..Query::default() }
    }

    /// Against the distance of the points that neighbouring pixels see, projected across the ray.
    #[test]
    fn widths_are_those_between_neighbouring_rays() {
        let view = view(Camera::PERSPECTIVE);
        let footprint = Footprint::new(&view);
        // The sides are 0.1 and 0.15 at distance 1: the shorter one counts.
        let middle = footprint.width(&query([0.0, 0.0, -0.5], 8 + 4));
        assert!((middle - 0.1 / (1.0 + 0.05_f64.powi(2) + 0.075_f64.powi(2))).abs() < 1e-7, "{middle}");
        // The pixel at the right edge of a wide picture, seen at 1 in depth: rays at its left and right side, whose angle
        // is its width at distance 1.
        let wide = View {
            camera: Camera { right: [2.0, 0.0, 0.0], up: [0.0, 0.02, 0.0], ..view.camera },
            width: 100,
            height: 1,
        };
        let (near, far) = (1.96_f64.atan(), 2.0_f64.atan());
        let got = Footprint::new(&wide).width(&query([1.98, 0.0, -0.5], 99));
        let expected = (far - near) * (1.0 + 1.98_f64.powi(2)).sqrt();
        assert!((got / expected - 1.0).abs() < 1e-3, "{got} {expected}");
        let parallel = View { camera: Camera { kind: Camera::ORTHOGRAPHIC, ..view.camera }, ..view };
        assert!((Footprint::new(&parallel).width(&query([0.3, 0.1, -9.0], 31)) - 0.1).abs() < 1e-7);
    }

    /// The same surface and light give the same bound in a larger picture, whose pixels are joined, for its own pixels.
    #[test]
    fn pixels_of_large_pictures_are_joined() {
        let small = view(Camera::PERSPECTIVE);
        let large = View { width: 800, height: 400, ..small };
        let footprint = Footprint::new(&large);
        assert_eq!((footprint.joined.width, footprint.joined.height), (181, 90));
        let at = [0.0, 0.0, -0.5];
        let joined = [query(at, 45 * 181 + 90)];
        let estimates = [Estimate { flux: [1.0; 3], radius_squared: 1.0, ..Estimate::default() }];
        // Pixels of the small picture are a hundred times as wide, at the same place.
        let expected = 0.01 * LEAST * 0.1;
        let bound = f64::from(footprint.bound(&joined, &estimates));
        assert!((bound / expected - 1.0).abs() < 1e-3, "{bound} {expected}");
        assert!((footprint.most() / Footprint::new(&small).most() - 0.01).abs() < 1e-9);
        // Light is searched in all of a joined pixel.
        let mut searched = joined;
        footprint.search(&mut searched);
        assert!((f64::from(searched[0].radius) / (SEARCH * 2.0 * 0.4 / 181.0) - 1.0).abs() < 1e-3);
        // A long picture of one row.
        let row = Footprint::new(&View { width: 100_000, height: 1, ..small });
        assert_eq!((row.joined.width, row.joined.height), (16_384, 1));
        let column = Footprint::new(&View { width: 1, height: 100_000, ..small });
        assert_eq!((column.joined.width, column.joined.height), (1, 16_384));
    }

    /// No bound is above the one that is compared first.
    #[test]
    fn nothing_in_the_scene_is_wider_than_the_most() {
        for kind in [Camera::PERSPECTIVE, Camera::ORTHOGRAPHIC] {
            let view = view(kind);
            let footprint = Footprint::new(&view);
            for corner in 0..8 {
                let position = std::array::from_fn(|axis| if corner >> axis & 1 == 0 { -0.5 } else { 0.5 });
                let width = footprint.width(&query(position, 12));
                assert!(LEAST * width <= footprint.most(), "{corner}: {width} {}", footprint.most());
            }
        }
    }

    #[test]
    fn narrow_pixels_with_little_light_do_not_count() {
        let lit = |narrow: f64| vec![(3.0, 0.5), (1.0, narrow), (2.0, 0.5)];
        assert_eq!(quantile(lit(0.06)), 1.0);
        assert_eq!(quantile(lit(0.05)), 2.0);
        assert_eq!(quantile(Vec::new()), 0.0);
        let view = view(Camera::PERSPECTIVE);
        let footprint = Footprint::new(&view);
        let queries = [query([0.0, 0.0, 0.3], 12), query([0.0, 0.0, -0.5], 12)];
        // The same flux in discs of different areas: radiance counts.
        let estimate = |radius_squared: f32| Estimate { flux: [1.0; 3], radius_squared, ..Estimate::default() };
        let bound = |near: f32| footprint.bound(&queries, &[estimate(near), estimate(1.0)]);
        assert!((f64::from(bound(18.0)) / (LEAST * footprint.width(&queries[0])) - 1.0).abs() < 1e-6);
        assert!((f64::from(bound(20.0)) / (LEAST * footprint.width(&queries[1])) - 1.0).abs() < 1e-6);
        assert_eq!(footprint.bound(&queries, &[Estimate { radius_squared: 1.0, ..Estimate::default() }; 2]), 0.0);
    }
}

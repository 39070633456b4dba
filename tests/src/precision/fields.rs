//! Search and estimate: photons on a plane, where the digits of their positions are exhausted.

use photon_core::{EstimateParams, IndexKind, Kernel, Photon, Search};

use super::{Table, quantile, relative};
use crate::backends::OnCpu;
use crate::harness::{Uniform, estimate, photon_at, query_at};

/// Photons around queries near a corner of the scene; `radius` is the radius of the queries.
struct Field {
    photons: Vec<[f64; 2]>,
    queries: Vec<[f64; 2]>,
    radius: f64,
}

/// Position of the plane: near the corner of the unit box, where f32 is coarsest.
const CORNER: f64 = -0.4;

impl Field {
    /// A field with a mean of `within` photons within a radius.
    fn new(radius: f64, within: usize, queries: usize) -> Self {
        let mut uniform = Uniform::new(7);
        let mut square = |side: f64| -> [f64; 2] { std::array::from_fn(|_| CORNER + (uniform.draw() - 0.5) * side) };
        // Queries in the inner square of two radii; photons as far as any query reads them.
        let count = (within as f64 * 16.0 / std::f64::consts::PI) as usize;
        let photons = (0..count).map(|_| square(4.0 * radius)).collect();
        Self { photons, queries: (0..queries).map(|_| square(2.0 * radius)).collect(), radius }
    }

    fn photons(&self) -> Vec<Photon> {
        self.photons.iter().map(|&[x, y]| photon_at([x as f32, y as f32, 0.0])).collect()
    }

    fn ask(&self, search: Search, reach: f64) -> Vec<photon_core::Estimate> {
        let queries: Vec<_> =
            self.queries.iter().map(|&[x, y]| query_at([x as f32, y as f32, 0.0], reach as f32)).collect();
        let gather =
            EstimateParams { kernel: Kernel::Epanechnikov, min_normal_cosine: 0.0, ..EstimateParams::new(search) };
        estimate::<OnCpu>(IndexKind::Morton, &self.photons(), &queries, &gather)
    }

    /// Squared distances of all photons in f64, from the coordinates before rounding.
    fn distances(&self, [x, y]: [f64; 2]) -> impl Iterator<Item = f64> {
        self.photons.iter().map(move |[px, py]| (px - x) * (px - x) + (py - y) * (py - y))
    }

    /// Errors: relative error of the irradiance and of the k-th photon's squared distance; photons on the wrong
    /// side of the radius, as a fraction of those within. Each is the bound for 99 of 100 queries.
    fn errors(&self, k: usize) -> [f64; 3] {
        let r2 = self.radius * self.radius;
        let (mut irradiance, mut members, mut kth) = (Vec::new(), Vec::new(), Vec::new());
        for (found, &query) in self.ask(Search::Radius, self.radius).iter().zip(&self.queries) {
            let within: Vec<f64> = self.distances(query).filter(|d2| *d2 <= r2).collect();
            let truth: f64 = within.iter().map(|d2| 2.0 * (1.0 - d2 / r2)).sum::<f64>() / r2;
            let found_irradiance = f64::from(found.flux[0]) / f64::from(found.radius_squared);
            irradiance.push(relative(found_irradiance, truth));
            members.push((f64::from(found.photons) - within.len() as f64).abs() / within.len().max(1) as f64);
        }
        for (found, &query) in self.ask(Search::KNearest { k: k as u32 }, 8.0 * self.radius).iter().zip(&self.queries) {
            let mut all: Vec<f64> = self.distances(query).collect();
            all.sort_unstable_by(f64::total_cmp);
            kth.push(relative(found.radius_squared.into(), all[k - 1]));
        }
        [irradiance, members, kth].map(|mut values| quantile(&mut values, 0.99))
    }
}

/// Errors as a function of the radius relative to the scene.
#[must_use]
pub fn radius(decades: std::ops::RangeInclusive<i32>, queries: usize) -> Table {
    let mut table = Table::new(
        "Search and estimate over the radius, 50 photons within it, 99 of 100 queries",
        &[
            "radius / scene",
            "irradiance, relative",
            "photons on the wrong side of the radius",
            "r² of the 50th, relative",
        ],
    );
    for k in decades {
        let errors = Field::new(10.0_f64.powi(-k), 50, queries).errors(50);
        table.row(format!("1e-{k}"), &errors);
    }
    table
}

/// Errors as a function of the number of photons in an estimate.
#[must_use]
pub fn photons(decades: std::ops::RangeInclusive<u32>, queries: usize) -> Table {
    let columns =
        ["photons", "irradiance, relative", "photons on the wrong side of the radius", "r² of the 10th, relative"];
    let mut table = Table::new("Sums over photons, radius of a tenth of the scene, 99 of 100 queries", &columns);
    for k in decades {
        let within = 10_usize.pow(k);
        table.row(format!("1e{k}"), &Field::new(0.1, within, queries).errors(10));
    }
    table
}

//! S6, S8, S24, S27: degenerate photon positions.

use photon_core::{Backend, Estimate, EstimateParams, IndexKind, Photon, Query, Search};

use super::sheet::Sheet;
use crate::harness::{TestBackend, Uniform, photon_at, query_at};
use crate::{determinism, estimators, numerics};

const INDICES: [IndexKind; 3] = [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton];

/// Lower bound of squared radii (S6), which avoids a division by 0.
const MIN_REACH: f32 = 1.0 / (1_u64 << 40) as f32;

/// Runs the group.
pub fn all<T: TestBackend>(sheet: &mut Sheet) {
    degenerate_sets::<T>(sheet);
    if sheet.long() && T::make(1).name() == "cpu" {
        no_slow_query(sheet);
    }
    sheet.proved(
        "S6",
        "photons at one point, a query there: finite, marked singular",
        "100 photons",
        "finite",
        numerics::s6_coincident_photons::<T>,
    );
    sheet.proved("S8", "all photons equal; collinear", "1e6; 1e4", "exact", numerics::s8_degenerate_maps::<T>);
    sheet.proved(
        "S9",
        "non-finite input is refused by name",
        "NaN, ∞ in photons and vertices",
        "typed errors",
        numerics::s9_not_finite::<T>,
    );
    sheet.proved(
        "S19",
        "random numbers: χ², lag 1; the LCG must fail",
        "65 536 numbers, 4 pairings",
        "|z| < 4.5",
        numerics::s19_random_numbers::<T>,
    );
    sheet.proved(
        "S20",
        "both ends of the unit interval",
        "0, 1 − 2⁻²⁴",
        "finite, unit",
        numerics::s20_ends_of_the_unit_interval::<T>,
    );
    sheet.proved(
        "S24",
        "loss at edges is the predicted one",
        "half plane, quadrant",
        "4 N^(−3/4)",
        estimators::a8_loss_at_edges::<T>,
    );
    sheet.proved(
        "S27",
        "neighbours as by brute force",
        "500 of 3000",
        "exact",
        numerics::s27_neighbour_sets_are_exact::<T>,
    );
    sheet.proved(
        "—",
        "scheduling changes no bit",
        "1 to 7 threads, batches",
        "exact",
        determinism::photons_do_not_depend_on_sharing::<T>,
    );
}

/// Sets of `n` points within the unit box.
fn sets(n: usize) -> Vec<(&'static str, Vec<[f32; 3]>)> {
    let mut uniform = Uniform::new(21);
    let mut draw = move || uniform.draw() as f32 - 0.5;
    let line = |i: usize| i as f32 / n as f32 - 0.5;
    let side = (n as f64).cbrt().ceil() as usize;
    let cell = |i: usize| i as f32 / side as f32 - 0.5;
    let mut outlier: Vec<_> = (0..n).map(|_| [draw() * 1e-6, draw() * 1e-6, draw() * 1e-6]).collect();
    outlier[n / 2] = [0.5, 0.5, 0.5];
    let spiral = |i: usize| {
        // Density falls as r⁻³, so by a factor of much more than 1e6 from the inner end to the outer.
        let at = i as f64 / n as f64;
        let (radius, angle) = (0.5 * 10.0_f64.powf(-6.0 * (1.0 - at)), 400.0 * at);
        [(radius * angle.cos()) as f32, (radius * angle.sin()) as f32, 0.0]
    };
    vec![
        ("all equal", vec![[0.125, -0.25, 0.375]; n]),
        ("two places", (0..n).map(|i| [if i % 2 == 0 { 0.5 } else { -0.5 }, 0.0, 0.0]).collect()),
        ("collinear along an axis", (0..n).map(|i| [0.0, line(i), 0.0]).collect()),
        ("collinear, oblique", (0..n).map(|i| [line(i), 0.3 * line(i), -0.7 * line(i)]).collect()),
        ("coplanar", (0..n).map(|_| [draw(), 0.1, draw()]).collect()),
        ("lattice", (0..n).map(|i| [cell(i % side), cell(i / side % side), cell(i / side / side)]).collect()),
        ("denormal spacing", (0..n).map(|i| [i as f32 * 1e-43, 0.0, -(i as f32) * 1e-42]).collect()),
        ("one far outlier", outlier),
        ("spiral, density 1e6:1", (0..n).map(spiral).collect()),
        ("signed zeros", (0..n).map(|i| if i % 2 == 0 { [0.0, -0.0, 0.0] } else { [-0.0, 0.0, -0.0] }).collect()),
    ]
}

/// S8, S27: counts within a radius and squared distances of the k-th photon, identical to brute force to the bit.
fn degenerate_sets<T: TestBackend>(sheet: &mut Sheet) {
    let n = sheet.either(1500, 20_000);
    let radii = [1e-5_f32, 0.01, 0.5];
    let mut on = T::make(2);
    let mut wrong = Vec::new();
    let mut asked = 0;
    let mut names = Vec::new();
    for (name, points) in sets(n) {
        let photons: Vec<Photon> = points.iter().map(|&at| photon_at(at)).collect();
        let places = points.iter().step_by(n / 24).copied().chain([[0.0; 3], [0.4, -0.3, 0.2]]);
        let queries: Vec<_> = places.flat_map(|at| radii.map(|radius| query_at(at, radius))).collect();
        let truth: Vec<_> = queries.iter().map(|query| brute(&points, query.position, query.radius, 20)).collect();
        for kind in INDICES {
            let [within, nearest] = ask(&mut on, kind, &photons, &queries);
            for ((truth, within), nearest) in truth.iter().zip(within).zip(nearest) {
                if within.photons != truth.0 || nearest.radius_squared != truth.1 {
                    wrong.push(name);
                }
                asked += 2;
            }
        }
        names.push(name);
    }
    let range = format!("{n} points each: {}; radii {radii:?}; 3 indices; {asked} queries", names.join(", "));
    let what = "photons within a radius, distance of the 20th: answers that differ from brute force";
    let mut found = wrong.len().to_string();
    wrong.dedup();
    found += &wrong.join(", ");
    sheet.holds("S8 S27", what, range, found, wrong.is_empty());
}

/// Estimates with all photons within the radius, and with the 20 nearest.
fn ask<B: Backend>(on: &mut B, kind: IndexKind, photons: &[Photon], queries: &[Query]) -> [Vec<Estimate>; 2] {
    let mut stages = on.map_stages(kind).unwrap();
    let there = on.upload("photons", photons).unwrap();
    let queries_there = on.upload("queries", queries).unwrap();
    let mut estimates = on.alloc("estimates", queries.len() as u64).unwrap();
    let map = stages.builder.build(on, there).unwrap();
    [Search::Radius, Search::KNearest { k: 20 }].map(|search| {
        stages.estimator.estimate(on, &map, &queries_there, &EstimateParams::new(search), &mut estimates).unwrap();
        let mut found = Vec::new();
        on.download(&estimates, &mut found).unwrap();
        found
    })
}

/// By brute force: the number of points within the radius, and the squared distance of the k-th, or the squared
/// radius if there are fewer.
fn brute(points: &[[f32; 3]], at: [f32; 3], radius: f32, k: usize) -> (u32, f32) {
    let square = |p: &[f32; 3]| {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| p[axis] - at[axis]);
        x * x + y * y + z * z
    };
    let mut squares: Vec<f32> = points.iter().map(square).filter(|&square| square <= radius * radius).collect();
    let count = squares.len();
    let reach = if count >= k { *squares.select_nth_unstable_by(k - 1, f32::total_cmp).1 } else { radius * radius };
    (count as u32, reach.max(MIN_REACH))
}

/// No query takes longer than 20 times the median of its set. Runs on the CPU, where a single query can be timed;
/// each takes the minimum of five timings, to exclude the effect of other programs.
fn no_slow_query(sheet: &mut Sheet) {
    use backend_cpu::index::{Neighbours, PointIndex};
    let n = 1_000_000;
    for (name, points) in sets(n) {
        let mut worst = (0.0_f64, IndexKind::Median);
        for kind in INDICES {
            let index = PointIndex::build(&points, kind).unwrap();
            let mut found = Neighbours::default();
            let mut times: Vec<f64> = points
                .iter()
                .step_by(n / 1000)
                .map(|&at| {
                    let once = |found: &mut Neighbours| {
                        let start = std::time::Instant::now();
                        index.nearest_of_all(at, 50, 0.01, found);
                        start.elapsed().as_secs_f64()
                    };
                    (0..5).map(|_| once(&mut found)).fold(f64::INFINITY, f64::min)
                })
                .collect();
            times.sort_unstable_by(f64::total_cmp);
            let ratio = times[times.len() - 1] / times[times.len() / 2];
            if ratio > worst.0 {
                worst = (ratio, kind);
            }
        }
        let found = format!("{:.1} times ({:?})", worst.0, worst.1);
        let what = "50 nearest: slowest query over the median one";
        sheet.holds("S8", what, format!("{name}, {n} points"), found, worst.0 <= 20.0);
    }
}

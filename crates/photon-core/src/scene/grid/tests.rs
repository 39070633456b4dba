use glam::Vec3;

use super::*;
use crate::random::{SplitMix64, unit_f32};

/// A grid that fills the box from −½ to ½.
struct Owned {
    tables: OwnedGridTables,
    cells: [u32; 3],
    densities: Vec<f32>,
}

impl Owned {
    fn new(cells: [u32; 3], density: impl Fn([u32; 3]) -> f32) -> Self {
        let [across, deep, high] = cells;
        let all = (0..high).flat_map(|z| (0..deep).flat_map(move |y| (0..across).map(move |x| [x, y, z])));
        let densities: Vec<f32> = all.map(density).collect();
        let mut tables = OwnedGridTables::default();
        let first = tables.add(cells, &densities, 1.0).unwrap();
        let row = |axis: usize| {
            let n = cells[axis] as f32;
            let mut row = [0.0, 0.0, 0.0, 0.5 * n + 0.5];
            row[axis] = n;
            row
        };
        tables.grids = vec![Grid { x: row(0), y: row(1), z: row(2), cells, first }];
        Self { tables, cells, densities }
    }

    fn density(&self) -> Density<'_> {
        self.tables.view().of(0).unwrap()
    }

    /// The density at a point by its definition, in f64.
    fn exact(&self, point: [f64; 3]) -> f64 {
        if point.iter().any(|c| c.abs() > 0.5) {
            return 0.0;
        }
        let at: [f64; 3] = std::array::from_fn(|axis| (point[axis] + 0.5) * f64::from(self.cells[axis]) - 0.5);
        let mut sum = 0.0;
        for corner in 0..8_usize {
            let (mut weight, mut index) = (1.0, 0);
            for axis in (0..3).rev() {
                let (low, is_next) = (at[axis].floor(), corner >> axis & 1 == 1);
                weight *= if is_next { at[axis] - low } else { 1.0 - (at[axis] - low) };
                let last = i64::from(self.cells[axis]) - 1;
                index = index * self.cells[axis] as usize + (low as i64 + i64::from(is_next)).clamp(0, last) as usize;
            }
            sum += weight * f64::from(self.densities[index]);
        }
        sum
    }

    /// The column by the midpoint rule.
    fn by_quadrature(&self, origin: Vec3, direction: Vec3, [from, to]: [f32; 2]) -> f64 {
        let steps = 20_000;
        let length = f64::from(to - from);
        let density = |step: i32| {
            let t = f64::from(from) + length * (f64::from(step) + 0.5) / f64::from(steps);
            self.exact((origin.as_dvec3() + direction.as_dvec3() * t).to_array())
        };
        (0..steps).map(density).sum::<f64>() * length / f64::from(steps)
    }
}

/// Numbers in `[0, 1)`.
fn numbers(seed: u64) -> impl FnMut() -> f32 {
    let mut numbers = SplitMix64(seed);
    move || unit_f32(numbers.word() as u32)
}

/// Random densities, with empty and even parts.
fn grids() -> Vec<Owned> {
    let mut next = numbers(7);
    let noise: Vec<f32> = (0..40 * 40 * 40).map(|_| next()).collect();
    let at = |[x, y, z]: [u32; 3]| noise[((z * 40 + y) * 40 + x) as usize];
    vec![
        Owned::new([1, 1, 1], |_| 0.7),
        Owned::new([5, 3, 2], at),
        Owned::new([8, 7, 9], at),
        Owned::new([40, 31, 17], |c| {
            if c[0] < 13 {
                0.0
            } else if c[1] > 20 {
                0.25
            } else {
                at(c)
            }
        }),
        Owned::new([33, 40, 1], |c| if (c[0] + c[1]) % 9 == 0 { at(c) } else { 0.0 }),
    ]
}

/// Rays in all directions, along the axes, in planes between cells, and from outside.
fn rays(count: u32) -> Vec<(Vec3, Vec3, [f32; 2])> {
    let mut next = numbers(11);
    (0..count)
        .map(|number| {
            let mut point = || Vec3::new(next(), next(), next()) * 1.4 - 0.7;
            let (mut origin, mut direction) = (point(), point().normalize());
            match number % 8 {
                0 => direction = Vec3::X,
                1 => direction = -Vec3::Z,
                // Along faces and edges of cells of all the grids.
                2 => (origin, direction) = (Vec3::new(-0.8, 0.0, 0.0), Vec3::X),
                3 => (origin, direction) = (Vec3::new(0.5, 0.5, -0.6), Vec3::Z),
                4 => (origin, direction) = (Vec3::splat(-0.5), Vec3::ONE.normalize()),
                5 => direction.y = 0.0,
                _ => {}
            }
            let direction = direction.normalize();
            let from = 0.3 * next();
            (origin, direction, [from, from + 2.0 * next()])
        })
        .collect()
}

/// The column and the density are those of the definition: the midpoint rule is exact to 1/steps² in cells, and where the box
/// ends, to half a step.
#[test]
fn columns_are_those_of_quadrature() {
    for grid in &grids() {
        let mut largest: f64 = 0.0;
        for (origin, direction, ends) in rays(160) {
            let exact = grid.by_quadrature(origin, direction, ends);
            let found = f64::from(grid.density().column(origin, direction, ends));
            let bound = 1e-4 * f64::from(ends[1] - ends[0]) + 2e-6;
            // On the border the density is both.
            let on_border = origin.to_array().iter().zip(direction.to_array()).any(|(o, d)| o.abs() == 0.5 && d == 0.0);
            assert!(
                on_border || (found - exact).abs() < bound,
                "{:?} {origin} {direction}: {found} {exact}",
                grid.cells
            );
            largest = largest.max(found);
            let point = origin + direction * 0.5 * (ends[0] + ends[1]);
            let exact = grid.exact(point.as_dvec3().to_array());
            let is_close = (f64::from(grid.density().at(point)) - exact).abs() < 1e-4;
            assert!(on_border || is_close || point.abs().max_element() > 0.4999, "{point}: {exact}");
        }
        assert!(largest > 0.01);
    }
    // The comparison sees a density that is shifted by one cell.
    let (grid, shifted) =
        (Owned::new([4, 1, 1], |c| c[0] as f32 * 0.2), Owned::new([4, 1, 1], |c| c[0] as f32 * 0.2 + 0.05));
    let exact = grid.by_quadrature(Vec3::ZERO, Vec3::X, [0.0, 0.5]);
    let found = f64::from(shifted.density().column(Vec3::ZERO, Vec3::X, [0.0, 0.5]));
    assert!((exact - found).abs() > 1e-2);
}

/// The column to the place of a column is that column, also by the knots of a segment.
#[test]
fn places_are_those_of_their_columns() {
    for grid in &grids() {
        let density = grid.density();
        for (origin, direction, [from, to]) in rays(160) {
            let all = density.column(origin, direction, [from, to]);
            for share in [0.0, 1e-6, 0.1, 0.5, 0.999, 1.0] {
                let place = density.until(origin, direction, [from, to], all * share).1;
                assert!((from..=to).contains(&place), "{from} {place} {to}");
                let found = density.column(origin, direction, [from, place]);
                assert!(
                    (found - all * share).abs() <= 4e-6 * all.max(0.1),
                    "{:?} {share}: {found} of {all}",
                    grid.cells
                );
            }
            let start = origin + direction * from;
            let columns = Columns::new(density, start, direction, to - from);
            assert!((columns.total() - all).abs() <= 2e-5, "{} {all}", columns.total());
            for share in [0.0, 0.21, 0.5, 0.77, 1.0] {
                let at = share * (to - from);
                let found = density.column(start, direction, [0.0, at]);
                assert!((columns.to(at) - found).abs() <= 2e-5, "{} {found}", columns.to(at));
                let place = columns.place(columns.total() * share);
                assert!((columns.to(place) - columns.total() * share).abs() <= 4e-6 * columns.total().max(0.1));
            }
        }
    }
}

/// P18: with the density rising evenly from 0 to 1 along z, the column of a part of the axis is the difference of z²/2; cells
/// at the border have an even half.
#[test]
fn a_slope_has_the_column_of_its_square() {
    let n = 64;
    let grid = Owned::new([1, 1, n], |c| (c[2] as f32 + 0.5) / n as f32);
    let half = 0.5 / n as f32;
    for (low, high) in [(half, 1.0 - half), (0.25, 0.5), (0.1, 0.9)] {
        let origin = Vec3::new(0.1, -0.2, low - 0.5);
        let found = grid.density().column(origin, Vec3::Z, [0.0, high - low]);
        let exact = 0.5 * (high * high - low * low);
        assert!((found / exact - 1.0).abs() < 2e-6, "{found} {exact}");
    }
}

/// A grid of one density is as homogeneous: columns are lengths.
#[test]
fn even_grids_have_lengths_as_columns() {
    for cells in [[1, 1, 1], [7, 8, 9], [64, 3, 20]] {
        let grid = Owned::new(cells, |_| 1.0);
        assert!(grid.tables.densities.is_empty());
        for (origin, direction, [from, to]) in rays(64) {
            let origin = origin * 0.5;
            let exact = Owned::new([1, 1, 1], |_| 1.0).by_quadrature(origin, direction, [from, to]);
            let found = grid.density().column(origin, direction, [from, to]);
            assert!((f64::from(found) - exact).abs() < 2e-4, "{found} {exact}");
        }
        let inside = grid.density().column(Vec3::splat(-0.3), Vec3::ONE.normalize(), [0.0, 0.6]);
        assert!((inside - 0.6).abs() < 3e-7, "{inside}");
    }
    let empty = Owned::new([30, 30, 30], |_| 0.0);
    assert_eq!(empty.density().column(Vec3::ZERO, Vec3::X, [0.0, 1.0]), 0.0);
    assert_eq!(empty.density().at(Vec3::ZERO), 0.0);
}

/// Extreme rays end.
#[test]
fn extreme_rays_end() {
    for grid in &grids() {
        for direction in [Vec3::X, Vec3::new(1.0, 1e-20, -1e-30), Vec3::new(1e-8, 1.0, 0.0), Vec3::new(-0.0, 0.0, -1.0)]
        {
            for origin in [Vec3::ZERO, Vec3::splat(0.5), Vec3::splat(-0.5), Vec3::splat(1e6), direction * -1e6] {
                let found = grid.density().column(origin, direction, [0.0, 56.0]);
                assert!((0.0..=1.8).contains(&found), "{origin} {direction}: {found}");
                let place = grid.density().until(origin, direction, [0.0, 56.0], f32::MAX).1;
                assert!((0.0..=56.0).contains(&place), "{place}");
            }
        }
    }
}

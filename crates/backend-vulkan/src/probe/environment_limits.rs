//! Simulation of a device whose divisions and square roots are as inaccurate as Vulkan allows: it is within the bounds of
//! environment maps, and one that is ten times as inaccurate is not.

use photon_core::EnvironmentMap;
use photon_core::glam::Vec3;
use photon_core::math::{sin_cos_turns, turns_of};

use super::environment::{map, rows};
use super::rough::{Rough, assert_bounded};
use super::table::output;

impl Rough {
    /// The quotient in `turns_of` is as wrong as its first argument.
    fn radiance(self, map: &EnvironmentMap, direction: Vec3) -> Vec3 {
        let across = self.root(direction.x * direction.x + direction.z * direction.z, 0);
        let from_centre = turns_of(self.divided(direction.x.abs(), 1), -direction.z);
        let u = 0.5 + from_centre.copysign(direction.x) + map.rotation();
        map.bilinear(u - u.floor(), 2.0 * turns_of(self.divided(across, 2), direction.y))
    }

    /// Direction and weight.
    fn sample(self, map: &EnvironmentMap, words: [u32; 2]) -> [Vec3; 2] {
        let (row, within_row, _) = EnvironmentMap::interval(map.row_starts(), map.row_guide(), words[0]);
        let columns = map.columns() as usize;
        let cells = row * columns..(row + 1) * columns;
        let (starts, guide) = (&map.column_starts()[cells.clone()], &map.column_guides()[cells]);
        let (column, within_column, column_probability) = EnvironmentMap::interval(starts, guide, words[1]);
        // `interval` limits the quotient.
        let limited = |within, operation| self.divided(within, operation).min(1.0 - f32::EPSILON);
        let (within_row, within_column) = (limited(within_row, 3), limited(within_column, 4));
        let cell = map.rows()[row];
        let (low, high) =
            (cell.above + cell.extent * within_row, cell.below + (cell.extent - cell.extent * within_row));
        let (low, high) = if low < 0.5 { (low, 1.0 - low) } else { (1.0 - high, high) };
        let cosine = if low < 0.5 { 1.0 - 2.0 * low } else { 2.0 * high - 1.0 };
        let sine = 2.0 * self.root((low * high).max(0.0), 5);
        let span = self.divided(1.0 / map.width() as f32, 6);
        let first = (column as u32 * map.step()) as f32;
        let texels = ((column as u32 + 1) * map.step()).min(map.width()) as f32 - first;
        let turns = (first + 0.5 + texels * within_column) * span - 0.5 - map.rotation();
        let (sin, cos) = sin_cos_turns(turns - turns.floor());
        let direction = Vec3::new(sin * sine, cosine, -cos * sine);
        let solid_angle = 4.0 * std::f32::consts::PI * cell.extent * (texels * span);
        let factor = self.divided(solid_angle / (cell.probability * column_probability), 7);
        [direction, self.radiance(map, direction) * factor]
    }
}

#[test]
fn a_device_at_the_limits_of_vulkan_passes() {
    for row in rows().into_iter().filter(|row| [1, 3, 4].contains(&row.function)) {
        assert_bounded(&row, 0..256, 10.0, |rough, i| {
            let one = match row.function {
                1 => rough.radiance(map(i), i.vector(0)),
                3 => rough.sample(map(i), [i.0[4], i.0[5]])[0],
                _ => rough.sample(map(i), [i.0[4], i.0[5]])[1],
            };
            output(one.to_array())
        });
    }
}

//! Columns of grids of densities compared with photon-core's.

use std::sync::LazyLock;

use photon_core::glam::Vec3;
use photon_core::{Columns, Density};
use photon_scene::{GridDesc, MaterialDesc, Scene, SceneBuilder, shapes};

use super::compare::Bound;
use super::draw::{Draw, input};
use super::table::{Row, Twin, output};
use super::{Input, assert_twin, whole_scene, words_of};
use crate::{Vulkan, shaders};

/// A box of smoke with empty and even parts.
static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let mut scene = SceneBuilder::new();
    let cells = [30, 21, 10];
    let density = |at: u32| match (at % 30, at / 30 % 21) {
        (0..9, _) => 0.0,
        (_, 18..) => 0.5,
        _ => Draw::of(at, 3).unit(),
    };
    let densities: Vec<f32> = (0..30 * 21 * 10).map(density).collect();
    let grid = GridDesc::new(cells, densities).with_box([-0.5; 3], [0.5; 3]);
    let smoke = MaterialDesc::boundary("smoke", [0.2; 3]).with_scattering([1.0; 3], 0.0).with_grid(grid);
    let smoke = scene.material(smoke);
    let (positions, triangles) = shapes::cuboid([-0.5; 3], [0.5; 3]);
    scene.mesh("box", positions, triangles, smoke);
    scene.build().unwrap()
});

fn density() -> Density<'static> {
    SCENE.view().grids.of(1).unwrap()
}

/// The functions, their twins and their bounds: distances have the error of a division, and densities from 0 to 1 that of their
/// change by 30 cells.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_GRID;
    let row = |name, function, twin| Row { name, module, function, bound: Bound::Within(8e-6), draw: part, twin };
    vec![
        row("grid_walk, grid_density", 0, |i| output([column(i), density().at(i.vector(0))])),
        row("grid_walk, place", 1, |i| {
            let (origin, direction, ends) = ray(i);
            let place = density().until(origin, direction, ends, column(i) * i.float(8)).1;
            output([density().column(origin, direction, [ends[0], place])])
        }),
        row("grid_columns", 2, |i| {
            let (origin, direction, [_, to]) = ray(i);
            let columns = Columns::new(density(), origin, direction, to);
            let place = columns.place(columns.total() * i.float(8));
            output([columns.to(to * i.float(8)), columns.to(place), columns.total()])
        }),
    ]
}

fn ray(i: &Input) -> (Vec3, Vec3, [f32; 2]) {
    (i.vector(0), i.vector(4), [i.float(3), i.float(7)])
}

fn column(i: &Input) -> f32 {
    let (origin, direction, ends) = ray(i);
    density().column(origin, direction, ends)
}

/// Origin and start, direction and end, and a share.
fn part(d: &mut Draw) -> Input {
    let (mut origin, mut direction) = (d.point() * 0.9, d.direction());
    if d.now_and_then() {
        // Along an axis, in a plane between cells.
        (origin, direction) = (Vec3::new(-0.6, 0.0, 0.1), d.pick(&[Vec3::X, Vec3::Y, Vec3::Z]));
    }
    // Densities jump at the border of the box.
    let is_on_border = (origin.abs() - 0.5).abs().min_element() < 1e-5;
    let origin = if is_on_border { origin * 0.5 } else { origin };
    let from = 0.2 * d.unit();
    input(
        [origin.x, origin.y, origin.z, from],
        [direction.x, direction.y, direction.z, from + d.pick(&[0.01, 0.3, 2.0])],
        [d.unit(), 0.0, 0.0, 0.0],
    )
}

/// A grid that is shifted is detected.
#[test]
fn columns_are_those_of_the_library() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = whole_scene(&mut on, &SCENE.view());
    let address = words_of(scene.address());
    let wrong: Twin = |i| output([column(i) + 1e-3, 0.0, 0.0]);
    for row in rows() {
        assert_twin(&mut on, &row, &address, wrong);
    }
}

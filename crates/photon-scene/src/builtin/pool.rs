//! A swimming pool in sunlight.

use std::collections::BTreeMap;

use super::add;
use crate::builder::{MaterialId, SceneBuilder};
use crate::describe::{CameraDesc, LightDesc, MaterialDesc, Surface};
use crate::mesh::VertexAttributes;
use crate::shapes::{Shape, grid, height_field, icosphere};

/// Half the length of the pool's square basin.
const HALF: f64 = 2.0;
const DEPTH: f64 = 1.3;
/// Height of the water at rest; the deck is at 0.
const LEVEL: f64 = -0.12;
/// Width of the deck: enough that the slanting sunlight does not get under it and behind the walls.
const DECK: f64 = 1.2;
/// Edge length of a tile.
const TILE: f64 = 0.25;
/// Grid cells of the water's surface along each side; the shortest wave spans 20.
const CELLS: u32 = 256;

/// Wave vectors (radians per metre, in x and z), amplitudes and phases of the waves.
///
/// A crest of curvature κ focuses at the depth `n / ((n − 1) κ)`: the short waves together focus at
/// about the depth of the pool, which makes a net of bright lines; the long ones bend it.
const WAVES: [([f64; 2], f64, f64); 8] = [
    ([3.1, 1.4], 0.0140, 0.3),
    ([-2.7, 5.3], 0.0090, 1.9),
    ([7.9, 5.8], 0.0068, 4.1),
    ([-10.6, 4.9], 0.0052, 2.6),
    ([3.4, -12.9], 0.0040, 5.5),
    ([13.2, -6.1], 0.0032, 0.9),
    ([8.8, 13.1], 0.0028, 3.4),
    ([-15.8, -6.4], 0.0024, 1.2),
];

/// Height of the water above `LEVEL`.
fn wave(x: f64, z: f64) -> f64 {
    WAVES.iter().map(|&([kx, kz], amplitude, phase)| amplitude * libm::sin(kx * x + kz * z + phase)).sum()
}

/// Normal of the water's surface, upwards, of any length.
fn normal(x: f64, z: f64) -> [f64; 3] {
    WAVES.iter().fold([0.0, 1.0, 0.0], |[nx, ny, nz], &([kx, kz], amplitude, phase)| {
        let slope = amplitude * libm::cos(kx * x + kz * z + phase);
        [nx - kx * slope, ny, nz - kz * slope]
    })
}

/// Adds the water: its surface with the normals of the waves, then its sides and bottom, as two meshes of one solid. Flat
/// triangles would each refract the sun as a plane, and show as a net of dark and bright lines on the floor.
fn water(scene: &mut SceneBuilder, body: Shape, material: MaterialId) {
    let (mut positions, mut triangles) = body;
    let rest = triangles.split_off(2 * (CELLS * CELLS) as usize);
    let mut numbers = BTreeMap::new();
    let mut places = Vec::new();
    let mut number = |vertex: u32| {
        *numbers.entry(vertex).or_insert_with(|| {
            places.push(positions[vertex as usize]);
            places.len() as u32 - 1
        })
    };
    let rest = rest.into_iter().map(|corners| corners.map(&mut number)).collect();
    positions.truncate(((CELLS + 1) * (CELLS + 1)) as usize);
    let normals = positions.iter().map(|&[x, _, z]| normal(x, z)).collect();
    scene.mesh_with("water", positions, triangles, VertexAttributes::default().with_normals(normals), material);
    add(scene, "water below", (places, rest), material);
}

/// A tiled basin of water with waves, seen from the deck.
pub(super) fn pool() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let tiles = [
        scene.material(MaterialDesc::lambert("light tile", [0.62, 0.78, 0.80])),
        scene.material(MaterialDesc::lambert("blue tile", [0.42, 0.66, 0.74])),
    ];
    let deck = scene.material(MaterialDesc::lambert("deck", [0.62, 0.55, 0.46]));
    let ball = scene.material(MaterialDesc::lambert("ball", [0.75, 0.16, 0.08]));
    let water = scene.material(MaterialDesc::new(
        "water",
        // Clear water absorbs red most.
        Surface::Dielectric { ior: 1.33, absorption: [0.30, 0.055, 0.025], tint: [1.0; 3], roughness: 0.0 },
    ));

    let (h, out) = (HALF, HALF + DECK);
    let [a, b, c, d] = [[-h, h], [h, h], [h, -h], [-h, -h]];
    let floor = [a, b, c, d].map(|[x, z]| [x, -DEPTH, z]);
    tile(&mut scene, "floor", floor, tiles);
    for (name, [from, to]) in
        [("far wall", [d, c]), ("right wall", [c, b]), ("near wall", [b, a]), ("left wall", [a, d])]
    {
        let [low, high] = [-DEPTH, 0.0].map(|y| [from, to].map(|[x, z]| [x, y, z]));
        tile(&mut scene, name, [low[0], low[1], high[1], high[0]], tiles);
    }
    for (name, low, high) in [
        ("far deck", [-out, -out], [out, -h]),
        ("near deck", [-out, h], [out, out]),
        ("left deck", [-out, -h], [-h, h]),
        ("right deck", [h, -h], [out, h]),
    ] {
        let [[x0, z0], [x1, z1]] = [low, high];
        scene.quad(name, [[x0, 0., z1], [x1, 0., z1], [x1, 0., z0], [x0, 0., z0]], deck);
    }
    // The water extends into the walls and below the floor: there is no gap of air between them for light
    // to cross, and the sides of the water are never seen.
    let (beyond, below) = (h + 0.1, -DEPTH - 0.1);
    let surface = |x, z| LEVEL + wave(x, z);
    let body = height_field([-beyond; 2], [beyond; 2], [CELLS; 2], below, surface);
    self::water(&mut scene, body, water);
    add(&mut scene, "ball", icosphere(5, [0.75, -DEPTH + 0.28, 0.35], 0.28), ball);

    let sun = [0.45, -1.0, -0.22];
    scene.light("sun", LightDesc::Directional { direction: sun, irradiance: [3.6, 3.4, 3.0] });
    scene.camera("deck", CameraDesc::look_at([-0.5, 3.3, 3.3], [0.0, -0.95, 0.0], [0., 1., 0.], 0.72));
    scene
}

/// A quadrilateral of tiles in two alternating colours, one mesh for each colour.
fn tile(scene: &mut SceneBuilder, name: &str, corners: [[f64; 3]; 4], colours: [MaterialId; 2]) {
    let along = |[from, to]: [[f64; 3]; 2]| {
        let squares = from.iter().zip(to).map(|(from, to)| (to - from) * (to - from));
        (squares.sum::<f64>().sqrt() / TILE).round() as u32
    };
    let [columns, rows] = [along([corners[0], corners[1]]), along([corners[0], corners[3]])];
    let (positions, triangles) = grid(corners, columns, rows);
    let parity = |cell: usize| (cell as u32 % columns + cell as u32 / columns) % 2;
    for (colour, material) in (0..).zip(colours) {
        let cells = triangles.chunks(2).enumerate().filter(|(cell, _)| parity(*cell) == colour);
        let chosen: Vec<[u32; 3]> = cells.flat_map(|(_, pair)| pair).copied().collect();
        let mut used = chosen.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        let place = |vertex| used.partition_point(|&other| other < vertex) as u32;
        let corners = chosen.iter().map(|triangle| triangle.map(place)).collect();
        scene.mesh(name, used.iter().map(|&vertex| positions[vertex as usize]).collect(), corners, material);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{open_edges, volume};

    #[test]
    fn water_is_closed_and_of_the_right_volume() {
        let side = 2.0 * HALF;
        let body = height_field([-HALF; 2], [HALF; 2], [256; 2], -DEPTH, |x, z| LEVEL + wave(x, z));
        assert_eq!(open_edges(&body), 0);
        // The height of a sum of waves is at most the sum of their amplitudes.
        let most: f64 = WAVES.iter().map(|wave| wave.1).sum();
        let mean = volume(&body) / (side * side) - (LEVEL + DEPTH);
        assert!(mean.abs() < most, "{mean}");
        assert!(LEVEL + most < 0.0, "the water must stay below the deck");
    }

    #[test]
    fn waves_are_gentle_and_well_resolved() {
        let steepest: f64 = WAVES.iter().map(|([kx, kz], amplitude, _)| kx.hypot(*kz) * amplitude).sum();
        assert!(steepest < 0.45, "{steepest}");
        let shortest =
            WAVES.iter().map(|([kx, kz], ..)| std::f64::consts::TAU / kx.hypot(*kz)).fold(f64::MAX, f64::min);
        let cells = shortest / (2.0 * (HALF + 0.1) / f64::from(CELLS));
        assert!(cells > 20.0, "{cells} cells in the shortest wave");
    }

    #[test]
    fn the_sun_does_not_shine_under_the_deck() {
        let builder = pool();
        let LightDesc::Directional { direction: [x, y, z], .. } = builder.lights[0].1 else { panic!("the sun") };
        assert!(x.hypot(z) / -y * DEPTH < DECK);
    }

    #[test]
    fn tiles_fill_the_floor() {
        let scene = pool().build().expect("valid");
        let floor =
            scene.view().primitives.iter().enumerate().filter(|(i, _)| scene.mesh_of_triangle(*i as u32) == "floor");
        assert_eq!(floor.count(), 2 * 16 * 16);
    }
}

//! S1 for lighting by rays: no shadow ray and no final-gather ray leaves a closed room near its edges.

use photon_core::{Direct, Estimator, FilmPixel, Indirect, Layer, Pipeline, Render, Settings, TransportBackend, View};
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, shapes};

use crate::harness::TestBackend;

type Point = [f64; 3];

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn unit(a: Point) -> Point {
    let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    a.map(|x| x / length)
}

/// A closed room within a shell, with lights between the two and, if `area_light`, also in the room; and cameras in
/// the room that each see 2·10⁻⁶ of an edge.
fn nested(shape: shapes::Shape, edges: usize, area_light: bool) -> (Scene, Vec<String>) {
    let (mut positions, triangles) = shapes::flip(shapes::rotate_y(shape, 0.7));
    for p in &mut positions {
        // Also rotated about x, so that no wall is axis-aligned.
        let (s, c) = 0.4_f64.sin_cos();
        *p = [p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]];
    }
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::lambert("wall", [0.5; 3]));
    let (shell, of_shell) = shapes::flip(shapes::cuboid([-4.0; 3], [4.0; 3]));
    builder.mesh("shell", shell, of_shell, wall);
    for axis in 0..3 {
        for away in [-3.0, 3.0] {
            let mut position = [0.1; 3];
            position[axis] = away;
            builder.light("outside", LightDesc::Point { position, intensity: [1.0; 3] });
        }
    }
    if area_light {
        builder.light("inside", LightDesc::Point { position: [0.1; 3], intensity: [1.0; 3] });
    }
    // Edges of the room are those shared by two walls that face different ways.
    let corner = |triangle: &[u32; 3], index: usize| positions[triangle[index % 3] as usize];
    let normal = |triangle: &[u32; 3]| {
        let [a, b] = [1, 2].map(|index| minus(corner(triangle, index), corner(triangle, 0)));
        unit(std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]))
    };
    let same = |a: Point, b: Point| minus(a, b).iter().all(|x| x.abs() < 1e-9);
    let mut sharp = Vec::new();
    for (number, one) in triangles.iter().enumerate() {
        for (other, i, j) in triangles[..number].iter().flat_map(|t| (0..9).map(move |ij| (t, ij / 3, ij % 3))) {
            let (a, b, facing) = (corner(one, i), corner(one, i + 1), [normal(one), normal(other)]);
            let shared = same(a, corner(other, j + 1)) && same(b, corner(other, j));
            if shared && !minus(facing[0], facing[1]).iter().all(|x| x.abs() < 1e-3) {
                sharp.push((a, b, unit(std::array::from_fn(|axis| facing[0][axis] + facing[1][axis]))));
            }
        }
    }
    let mut names = Vec::new();
    for (index, (a, b, inward)) in sharp.iter().step_by(sharp.len() / edges).take(edges).enumerate() {
        let along = 0.2 + 0.6 * (index as f64 + 0.5) / edges as f64;
        let position = std::array::from_fn(|i| a[i] + along * (b[i] - a[i]) + 0.02 * inward[i]);
        let projection = Projection::Orthographic { half_height: 1e-6 };
        let (direction, up) = (inward.map(|x| -x), unit(minus(*b, *a)));
        names.push(format!("edge {index}"));
        builder.camera(&names[index], CameraDesc::new(position, direction, up, projection));
    }
    builder.mesh("room", positions, triangles, wall);
    (builder.build().unwrap(), names)
}

/// The film pixels that the cameras see.
fn pixels<B: TransportBackend>(mut on: B, (scene, cameras): &(Scene, Vec<String>)) -> (Vec<FilmPixel>, B) {
    let settings = Settings {
        photons: 5000,
        direct: Direct::Nee,
        indirect: Indirect::Gather,
        gather_rays: 4,
        estimator: Estimator::Radius { radius: Some(0.5) },
        ..Settings::default()
    };
    let mut all = Vec::new();
    for camera in cameras {
        let view = View { camera: scene.camera(Some(camera), 32, 32).unwrap(), width: 32, height: 32 };
        let mut renderer = Pipeline::new(on, &scene.view(), view, settings.clone()).unwrap();
        renderer.pass(0, &mut ()).unwrap();
        all.extend(renderer.film().unwrap().pixels);
        on = renderer.into_backend().unwrap();
    }
    (all, on)
}

/// No light from outside is visible inside a closed room, even where rounding moves a point near an edge behind the
/// adjacent wall: with the unmodified hit points, 2 % of these pixels saw some. A light in the room illuminates all
/// of them.
pub fn s1_no_light_through_edges<T: TestBackend>() {
    let rooms = [(shapes::cuboid([-1.0; 3], [1.0; 3]), 6), (shapes::cylinder([0.0, -1.0, 0.0], 1.0, 2.0, 16), 6)];
    let mut on = T::make(2);
    for (shape, edges) in rooms {
        let (dark, back) = pixels(on, &nested(shape.clone(), edges, false));
        assert_eq!(dark.len(), 1024 * edges);
        let lit = |layer: Layer| {
            move |pixel: &&FilmPixel| pixel.hits > 0 && pixel.layers[layer as usize].iter().any(|&light| light > 0.0)
        };
        for layer in [Layer::Direct, Layer::Indirect] {
            assert_eq!(dark.iter().filter(lit(layer)).count(), 0, "{layer:?}");
        }
        let (bright, back) = pixels(back, &nested(shape, 1, true));
        assert_eq!(bright.iter().filter(lit(Layer::Direct)).count(), bright.len());
        assert!(bright.iter().filter(lit(Layer::Indirect)).count() * 2 > bright.len());
        on = back;
    }
}

//! Textures and vertex attributes of a builder, as tables.

mod alpha;
mod anisotropy;
mod attributes;
mod diffuse_transmission;
mod emission;
mod invalid;
mod textures;
mod transmission;

use photon_scene::{MaterialDesc, MaterialId, Scene, SceneBuilder, VertexAttributes};

/// Corners of a unit square in the plane z = 0, facing +z, and its texture coordinates: v grows downwards.
const SQUARE: [[f64; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
const UVS: [[f64; 2]; 4] = [[0., 1.], [1., 1.], [1., 0.], [0., 0.]];
const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn with_uvs(uvs: [[f64; 2]; 4]) -> VertexAttributes {
    VertexAttributes::default().with_uvs(vec![uvs.to_vec()])
}

fn square(builder: &mut SceneBuilder, attributes: VertexAttributes, material: MaterialId) {
    builder.mesh_with("square", SQUARE.to_vec(), TRIANGLES.to_vec(), attributes, material);
}

/// A scene of one square with that material, valid for backends too.
#[track_caller]
fn built(mut builder: SceneBuilder, attributes: VertexAttributes, material: MaterialDesc) -> Scene {
    let material = builder.material(material);
    square(&mut builder, attributes, material);
    let scene = builder.build().unwrap_or_else(|error| panic!("{error}"));
    scene.view().validate().unwrap_or_else(|error| panic!("{error}"));
    scene
}

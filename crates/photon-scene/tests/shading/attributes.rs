//! Normals, tangents and colours.

use glam::Vec3;
use photon_core::{ShadingTables, octahedral};
use photon_scene::{AlphaMode, MaterialDesc, SceneBuilder, TextureDesc, TextureRef, VertexAttributes};

use crate::{SQUARE, TRIANGLES, UVS, built, with_uvs};

fn grey() -> MaterialDesc {
    MaterialDesc::lambert("grey", [0.5; 3])
}

fn with_normals(normals: [[f64; 3]; 4]) -> VertexAttributes {
    VertexAttributes::default().with_normals(normals.to_vec())
}

fn close(packed: u32, expected: [f32; 3]) -> bool {
    octahedral::unpack(packed).distance(Vec3::from(expected).normalize_or_zero()) < 1e-4
}

#[test]
fn a_scene_without_attributes_has_no_tables() {
    let scene = built(SceneBuilder::new(), VertexAttributes::default(), grey());
    let tables = scene.view().shading;
    assert!(tables.normals.is_empty() && tables.colors.is_empty() && tables.uvs.is_empty());
    assert!(tables.material_textures.is_empty() && scene.view().materials[0].textures == 0);
    // Nor does one whose attributes say nothing.
    let up = [1e-4, -2e-4, 5.0];
    let attributes = with_normals([up; 4]).with_colors(vec![[1.0; 4]; 4]).with_uvs(vec![UVS.to_vec()]);
    let tables = built(SceneBuilder::new(), attributes, grey());
    let tables = tables.view().shading;
    assert!(tables.normals.is_empty() && tables.colors.is_empty() && tables.uvs.is_empty());
}

#[test]
fn normals_are_packed_and_flat_triangles_are_marked() {
    let tilted = [0.2, 0.0, 1.0];
    let up = [0.0, 0.0, 1.0];
    let scene = built(SceneBuilder::new(), with_normals([up, tilted, up, up]), grey());
    let normals = scene.view().shading.normals;
    // Vertex 1 belongs to the first triangle alone.
    assert!(close(normals[0][0], [0.0, 0.0, 1.0]) && close(normals[0][1], [0.2, 0.0, 1.0]), "{normals:?}");
    assert_eq!(normals[1][0], ShadingTables::FLAT);
    assert!(scene.warnings().iter().all(|warning| !warning.contains("normals")));
}

/// V12: normals that are zero, not finite or behind their triangle.
#[test]
fn bad_normals_become_the_geometric_one_and_are_counted() {
    let tilted = [0.5, 0.0, 1.0];
    for bad in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0], [0.0, 0.3, -1.0], [1.0, 0.0, 0.0]] {
        let scene = built(SceneBuilder::new(), with_normals([tilted, bad, tilted, tilted]), grey());
        let normals = scene.view().shading.normals;
        assert!(close(normals[0][1], [0.0, 0.0, 1.0]) && close(normals[0][0], [0.5, 0.0, 1.0]), "{bad:?}");
        assert!(scene.warnings().iter().any(|warning| warning.starts_with("1 vertex normals")), "{bad:?}");
    }
    // Extreme lengths are directions too, and normals that all point backwards are turned.
    for good in [[5e-200, 0.0, 1e-199], [5e300, 0.0, 1e301], [-0.5, 0.0, -1.0]] {
        let scene = built(SceneBuilder::new(), with_normals([good; 4]), grey());
        assert!(close(scene.view().shading.normals[0][1], [0.5, 0.0, 1.0]), "{good:?}");
        assert!(scene.warnings().iter().all(|warning| !warning.contains("normals")));
    }
}

#[test]
fn colours_are_packed_in_16_bits() {
    let colors = vec![[0.5, 0.25, 1.0, 0.0], [2.0, -1.0, 0.0, 1.0], [1.0; 4], [1.0; 4]];
    let attributes = VertexAttributes::default().with_colors(colors);
    let scene = built(SceneBuilder::new(), attributes.clone(), grey());
    let [first, second, third] = scene.view().shading.colors[0];
    assert_eq!(first, [0x4000_8000, 0xFFFF_FFFF], "alpha counts for materials that are not opaque alone");
    assert_eq!(second, [0x0000_FFFF, 0xFFFF_0000]);
    assert_eq!(third, [u32::MAX; 2]);
    let scene = built(SceneBuilder::new(), attributes, grey().with_alpha(AlphaMode::Blend, 1.0));
    assert_eq!(scene.view().shading.colors[0][0], [0x4000_8000, 0x0000_FFFF]);
}

/// A normal map that is not flat.
fn mapped(builder: &mut SceneBuilder) -> MaterialDesc {
    let map = builder.texture(TextureDesc::linear8("bumps", 2, 1, &[[128, 128, 255, 255], [160, 128, 240, 255]]));
    let mut material = grey();
    material.textures.normal = Some(TextureRef::new(map));
    material
}

/// u grows along +x, v along −y: with the normal +z, the bitangent of a glTF normal map is +y.
#[test]
fn tangents_are_generated_where_there_are_none() {
    let mut builder = SceneBuilder::new();
    let material = mapped(&mut builder);
    let scene = built(builder, with_uvs(UVS), material);
    for packed in scene.view().shading.tangents.as_flattened() {
        assert!(close(*packed, [1.0, 0.0, 0.0]) && packed & 1 == 0, "{packed:x}");
    }
    // Mirrored coordinates: the tangent is −x, and the bitangent +y has the other sign.
    let mut builder = SceneBuilder::new();
    let material = mapped(&mut builder);
    let scene = built(builder, with_uvs(UVS.map(|[u, v]| [1.0 - u, v])), material);
    for packed in scene.view().shading.tangents.as_flattened() {
        assert!(close(*packed, [-1.0, 0.0, 0.0]) && packed & 1 == 1, "{packed:x}");
    }
}

#[test]
fn given_tangents_are_used_and_bad_ones_are_counted() {
    let good = [3.0, 4.0, 0.0, -1.0];
    for (bad, lost) in [
        (good, 0),
        ([0.0, 0.0, 0.0, 1.0], 1),
        ([f64::NAN, 1.0, 0.0, 1.0], 1),
        ([0.0, 0.0, 2.0, 1.0], 1),
        ([1.0, 0.0, 0.0, 0.0], 1),
    ] {
        let mut builder = SceneBuilder::new();
        let material = mapped(&mut builder);
        let attributes = with_uvs(UVS).with_tangents(vec![bad; 4]);
        let scene = built(builder, attributes, material);
        let packed = scene.view().shading.tangents[0][0];
        let lost_count = scene.warnings().iter().filter(|warning| warning.contains("tangents")).count();
        assert_eq!(lost_count, lost, "{bad:?}");
        let tangent = octahedral::unpack(packed);
        assert!(tangent.z.abs() < 1e-4 && (tangent.length() - 1.0).abs() < 1e-6, "{bad:?}");
        if lost == 0 {
            assert!(close(packed, [0.6, 0.8, 0.0]) && packed & 1 == 1);
        }
    }
    // One bad corner takes the tangent of another.
    let mut builder = SceneBuilder::new();
    let material = mapped(&mut builder);
    let attributes = with_uvs(UVS).with_tangents(vec![[0.0; 4], good, good, good]);
    assert!(close(built(builder, attributes, material).view().shading.tangents[0][0], [0.6, 0.8, 0.0]));
}

#[test]
fn attributes_follow_the_triangles_that_remain() {
    let mut builder = SceneBuilder::new();
    let material = mapped(&mut builder);
    let grey = builder.material(grey());
    let material = builder.material(material);
    builder.mesh("before", SQUARE.to_vec(), TRIANGLES.to_vec(), grey);
    // The first triangle has no area.
    let triangles = vec![[0, 1, 1], [0, 1, 2], [0, 2, 3]];
    let tilted = [[0.1, 0.0, 1.0], [0.2, 0.0, 1.0], [0.3, 0.0, 1.0], [0.4, 0.0, 1.0]];
    let attributes = with_uvs(UVS).with_normals(tilted.to_vec());
    builder.mesh_with("after", SQUARE.map(|[x, y, _]| [x, y, 1.0]).to_vec(), triangles, attributes, material);
    let scene = builder.build().unwrap();
    let tables = scene.view().shading;
    scene.view().validate().unwrap();
    assert_eq!((tables.normals.len(), tables.tangents.len(), tables.uvs.len()), (4, 4, 4));
    assert_eq!(tables.normals[0][0], ShadingTables::FLAT);
    assert!(close(tables.normals[3][2], [0.4, 0.0, 1.0]));
    assert_eq!(tables.uvs[3], [[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
}

//! Any image and any numbers as the texture and the vertex attributes of a square: an error with a message, or a valid
//! scene that survives its export to GLB.
#![no_main]

use photon_core::{Filter, TexelFormat, Wrap};
use photon_scene::{Image, LoadReport, MaterialDesc, SceneBuilder, TextureRef, VertexAttributes, glb};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    // Numbers first, then the image.
    let Some((head, rest)) = data.split_at_checked(8 + 8 * 16) else { return };
    let number = |at: usize| f64::from_le_bytes(std::array::from_fn(|byte| head[8 + 8 * at + byte]));
    let Ok(image) = Image::decode(rest) else { return };
    let wrap = |byte: u8| [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp][usize::from(byte % 3)];
    let filter = if head[2] & 1 == 0 { Filter::Linear } else { Filter::Nearest };
    let mut scene = SceneBuilder::new();
    let desc = |bytes| image.texture("image", bytes).wrapped([wrap(head[0]), wrap(head[1])]).filtered(filter);
    let color = scene.texture(desc(TexelFormat::Srgb8));
    let normal = scene.texture(desc(TexelFormat::Linear8));
    let transform = [[number(0), number(1), number(2)], [number(3), number(4), number(5)]];
    let used = |texture| TextureRef::new(texture).with_transform(transform);
    let mut material = MaterialDesc::emissive("square", [0.5; 3], [f64::from(head[3]); 3]);
    material.textures.emission = (head[4] & 1 == 1).then(|| used(color));
    material.textures.base_color = (head[4] & 2 == 2).then(|| used(color));
    material.textures.normal = (head[4] & 4 == 4).then(|| used(normal));
    let material = scene.material(material);
    let point = |at: usize| [number(at), number(at + 1), number(at + 2)];
    let normals = vec![point(6), [0.0, 0.0, 1.0], point(7), point(8)];
    let tangents = normals.iter().map(|[x, y, z]| [*y, *z, *x, number(9)]).collect();
    let uvs = vec![[number(10), number(11)], [1.0, 0.0], [number(12), number(13)], [number(14), number(15)]];
    let attributes = VertexAttributes::default()
        .with_normals(if head[5] & 1 == 1 { normals } else { Vec::new() })
        .with_tangents(if head[5] & 2 == 2 { tangents } else { Vec::new() })
        .with_uvs(vec![uvs]);
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    scene.mesh_with("square", corners, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
    scene.camera("front", scene.frame_camera());
    let exported = glb(&scene);
    match scene.build() {
        Ok(built) => {
            built.view().validate().expect("tables that backends accept");
            if let Ok(bytes) = exported {
                let again = photon_scene::load(&photon_fuzz::file("t.glb", &bytes), None).expect("our own file").0;
                let tables = |scene: &photon_scene::Scene| format!("{:?}", scene.view());
                assert_eq!(tables(&built), tables(&again));
            }
            photon_fuzz::check(Ok((built, LoadReport::default())));
        }
        Err(error) => assert!(!error.to_string().is_empty() && exported.is_err()),
    }
});

//! Converts the elements of a PLY file to meshes.

use std::path::Path;

use super::body::Body;
use super::header::{Encoding, Header};
use super::layout::Layout;
use crate::builder::SceneBuilder;
use crate::describe::{AlphaMode, MaterialDesc};
use crate::error::SceneError;
use crate::load::budget::Budget;
use crate::load::group::NONE;
use crate::load::mtl::{has_alpha, images_alone};
use crate::load::polygon::crossing;
use crate::load::{default_material, stem, white_material};
use crate::mesh::VertexAttributes;
use crate::report::LoadReport;
use crate::texture::TextureRef;

/// Adds the mesh of a file to a scene.
pub(super) fn add(
    path: &Path,
    header: &Header,
    mut body: Body,
    budget: &Budget,
) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let (mut builder, mut report) = (SceneBuilder::new(), LoadReport::default());
    let name = stem(path);
    let subject = format!("mesh '{name}'");
    unread(&subject, header, &body, &mut report);

    let [vertices, faces] = [&body.colors, &body.face_colors].map(|colors| (colors.kind.is_some(), colors.is_given()));
    let are_of_faces = faces > vertices;
    if vertices.1 && faces.1 {
        let [part, other] = if are_of_faces { ["vertices", "faces"] } else { ["faces", "vertices"] };
        report.left_out(&subject, format!("the colours or alpha of its {part}, since its {other} have some"));
    }
    let colors = std::mem::take(if are_of_faces { &mut body.face_colors } else { &mut body.colors });
    let has_colors = colors.kind.is_some();
    let (colors, is_clear) = colors.into_linear(&subject, &mut report);

    // v is downwards in meshes.
    body.uvs.iter_mut().chain(&mut body.corner_uvs).for_each(|[_, v]| *v = 1.0 - *v);
    let images = usable_images(&subject, header, &body, &mut report);
    let textures = images_alone(path, images, &subject, &mut builder, &mut report, budget)
        .map_err(|shortage| shortage.in_file(path))?;
    if textures.iter().flatten().any(|&used| has_alpha(&builder, used)) {
        report.left_out(&subject, "the alpha of its images; give it to the vertices if it is meant");
    }
    let beyond = body.textures.iter().filter(|&&image| image != NONE && image as usize >= images.len()).count();
    if beyond > 0 && !images.is_empty() {
        let text = format!("{beyond} of its faces have a number of an image (texnumber) that does not exist");
        report.approximated(&subject, text);
    }
    let materials = Materials { images, textures, has_colors, is_clear };

    let has_images = images.len() > 1;
    let mut meshes = Vec::new();
    let crossed = if are_of_faces || !body.corner_uvs.is_empty() || has_images {
        let (pools, groups, crossed) = body.groups(colors, are_of_faces, has_images);
        for (image, group) in groups {
            let desc = materials.desc(image as usize);
            let bare = group.without_uvs();
            let is_textured = desc.textures.base_color.is_some();
            if is_textured && bare > 0 {
                report
                    .approximated(&subject, format!("{bare} of its triangles have no texture coordinates; 0 is taken"));
            } else if has_images && !is_textured {
                report.approximated(&subject, "some of its faces have no image that can be read");
            }
            meshes.push((desc, group.mesh(&pools, is_textured)));
        }
        crossed
    } else {
        let (triangles, crossed) = body.triangles();
        let uvs = if body.uvs.is_empty() { Vec::new() } else { vec![body.uvs] };
        let attributes = VertexAttributes { normals: body.normals, uvs, colors, ..VertexAttributes::default() };
        meshes.push((materials.desc(0), (body.positions, triangles, attributes)));
        crossed
    };
    report.note(&subject, materials.text());
    if crossed.0 > 0 {
        report.approximated(&subject, crossing(crossed.0, &format!("is face {}", crossed.1)));
    }
    if meshes.iter().all(|(_, (_, triangles, _))| triangles.is_empty()) {
        report.note(&subject, "it has no faces; points alone are not rendered");
    }
    for (desc, (positions, triangles, attributes)) in meshes {
        let material = builder.material(desc);
        builder.mesh_with(name.as_str(), positions, triangles, attributes, material);
    }
    Ok((builder, report))
}

/// Says what of a file is not read.
fn unread(subject: &str, header: &Header, body: &Body, report: &mut LoadReport) {
    for element in header.elements.iter().filter(|element| element.count > 0) {
        let unread = Layout::of(element).unread(element);
        if !matches!(element.name.as_str(), "vertex" | "face" | "tristrips") {
            report.left_out(subject, format!("{} elements '{}'", element.count, element.name));
        } else if !unread.is_empty() {
            let text = format!("properties of its elements '{}': {}", element.name, unread.join(", "));
            report.left_out(subject, text);
        }
    }
    if body.small.0 > 0 {
        let text = format!("{} faces of fewer than three corners, the first is face {}", body.small.0, body.small.1);
        report.left_out(subject, text);
    }
    if body.unmatched > 0 {
        let text = format!("the texture coordinates of {} faces: they are not two for each corner", body.unmatched);
        report.left_out(subject, text);
    }
    if !body.uvs.is_empty() && !body.corner_uvs.is_empty() {
        report.left_out(subject, "the texture coordinates of its faces, since its vertices have some");
    }
    // Points that were not measured have no normal either.
    let measured =
        body.normals.iter().zip(&body.positions).filter(|(_, position)| position.iter().all(|part| part.is_finite()));
    let lost = measured.filter(|(normal, _)| !normal.iter().all(|part| part.is_finite())).count();
    if lost > 0 {
        let text = format!("{lost} of its normals are not finite; triangles have their own normal there");
        report.approximated(subject, text);
    }
    let lost = body.uvs.iter().chain(&body.corner_uvs).filter(|uv| !(uv[0].is_finite() && uv[1].is_finite())).count();
    if lost > 0 && !header.textures.is_empty() {
        report.approximated(subject, format!("{lost} of its texture coordinates are not finite; 0 is taken"));
    }
    if body.rest > 0 {
        let kind = if header.encoding == Encoding::Text { "numbers" } else { "bytes" };
        report.left_out(subject, format!("{} {kind} behind the last element", body.rest));
    }
}

/// The images of a file with texture coordinates.
fn usable_images<'a>(subject: &str, header: &'a Header, body: &Body, report: &mut LoadReport) -> &'a [String] {
    let has_uvs = !body.uvs.is_empty() || !body.corner_uvs.is_empty();
    let images = header.textures.as_slice();
    if has_uvs && images.is_empty() {
        report.note(subject, "it has texture coordinates, but no image (comment TextureFile)");
    }
    if !has_uvs && !images.is_empty() {
        let text = format!("its textures {}, since it has no texture coordinates", images.join(", "));
        report.left_out(subject, text);
        return &[];
    }
    images
}

/// The materials of a file.
struct Materials<'a> {
    images: &'a [String],
    textures: Vec<Option<TextureRef>>,
    has_colors: bool,
    is_clear: bool,
}

impl Materials<'_> {
    /// The one with that image; 'default' is the name of the first.
    fn desc(&self, image: usize) -> MaterialDesc {
        let texture = self.textures.get(image).copied().flatten();
        let mut desc = if self.has_colors || texture.is_some() { white_material() } else { default_material() };
        desc.textures.base_color = texture;
        if self.is_clear {
            desc.alpha_mode = AlphaMode::Blend;
        }
        if let Some(name) = self.images.get(image).filter(|_| image > 0) {
            desc.name.clone_from(name);
        }
        desc
    }

    fn text(&self) -> String {
        let kind = match (self.has_colors, self.images.is_empty()) {
            (true, true) => "diffuse, with its colours as albedo,",
            (_, false) => "diffuse, with its images and colours as albedo,",
            (false, true) => "a diffuse grey of 0.5",
        };
        format!("it has no material, which this format does not define; it is made {kind} named 'default'")
    }
}

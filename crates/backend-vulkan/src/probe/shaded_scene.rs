//! A scene of triangles with vertex attributes and textures, for probes of functions that read them.

use std::sync::LazyLock;

use photon_core::glam::Vec3;
use photon_core::{
    Anisotropy, ClearcoatNormal, DiffuseTransmission, Filter, Light, Material, MaterialKind, MaterialTextures,
    OwnedShadingTables, PartialTransmission, Primitive, SceneView, ShadingTables, SheenLayer, TexelFormat, Texture,
    TextureUse, Wrap, octahedral, sampling,
};
use photon_scene::CompressedTree;

use super::draw::Draw;

/// Number of triangles.
pub(super) const TRIANGLES: u32 = 40;

/// Number of materials, without the glass that some of them are partly.
const MATERIALS: u32 = 12;

/// Number of lights, the first triangles.
pub(super) const LIGHTS: u32 = 8;

/// The tables of the scene.
#[derive(Debug, Default)]
pub(super) struct ShadedScene {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) primitives: Vec<Primitive>,
    pub(super) materials: Vec<Material>,
    pub(super) lights: Vec<Light>,
    light_cdf: Vec<u32>,
    pub(super) shading: OwnedShadingTables,
    /// The position of each triangle in BVH order.
    pub(super) slots: Vec<u32>,
}

pub(super) static SHADED: LazyLock<ShadedScene> = LazyLock::new(|| {
    let mut scene = ShadedScene::default();
    let mut d = Draw::of(0, 3);
    scene.add_textures(&mut d);
    scene.add_materials(&mut d);
    for index in 0..TRIANGLES {
        scene.add_triangle(&mut d, index);
    }
    scene.shading.uvs = (0..2 * TRIANGLES).map(|_| [[(); 2]; 3].map(|uv| uv.map(|()| d.between(-2.0, 2.0)))).collect();
    let tree = CompressedTree::build(&scene.positions, &scene.triangles).unwrap();
    let slot = |id: u32| tree.order.iter().position(|&other| other == id).unwrap() as u32;
    scene.slots = (0..TRIANGLES).map(slot).collect();
    scene
});

impl ShadedScene {
    pub(super) fn view(&self) -> SceneView<'_> {
        SceneView {
            positions: &self.positions,
            triangles: &self.triangles,
            primitives: &self.primitives,
            materials: &self.materials,
            lights: &self.lights,
            light_cdf: &self.light_cdf,
            shading: self.shading.view(),
            ..SceneView::default()
        }
    }

    /// All formats, wrap modes and filters, in several sizes; then three normal maps, with a use of each texture.
    fn add_textures(&mut self, d: &mut Draw) {
        let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
        for format in TexelFormat::ALL {
            for filter in [Filter::Linear, Filter::Nearest] {
                for wrap in wraps.iter().flat_map(|&u| wraps.map(|v| [u, v])) {
                    let (width, height) = d.pick(&[(7, 5), (4, 4), (1, 1), (3, 1), (2, 8)]);
                    let count = (width * height) as usize * format.words();
                    let texel = |_| match format {
                        TexelFormat::Float32 if d.now_and_then() => d.pick(&[0.0, 1e20_f32, 1e-20]).to_bits(),
                        TexelFormat::Float32 => d.magnitude(-10, 10).to_bits(),
                        _ => d.word(),
                    };
                    let texels = (0..count).map(texel).collect();
                    self.shading.textures.push(Texture { texels, width, height, format, wrap, filter });
                }
            }
        }
        // Normals up to 40 degrees from the vertical.
        for wrap in wraps {
            let mut byte = |least: u32, most: u32| least + d.word() % (most - least + 1);
            let texels =
                (0..12).map(|_| u32::from_le_bytes([byte(77, 178), byte(77, 178), byte(217, 255), 0].map(|b| b as u8)));
            let (format, filter) = (TexelFormat::Linear8, Filter::Linear);
            let texels = texels.collect();
            self.shading.textures.push(Texture { texels, width: 4, height: 3, format, wrap: [wrap; 2], filter });
        }
        // Directions within 70 degrees of the tangent, of all strengths.
        let mut of_anisotropy = Draw::of(0, 5);
        let texels = (0..12).map(|_| of_anisotropy.word() | 0xC0);
        let (format, filter, wrap) = (TexelFormat::Linear8, Filter::Linear, [Wrap::Repeat; 2]);
        let anisotropic = Texture { texels: texels.collect(), width: 3, height: 4, format, wrap, filter };
        for texture_index in 0..self.shading.textures.len() as u32 {
            let transform = [[(); 3]; 2].map(|row| row.map(|()| d.between(-1.5, 1.5)));
            self.shading.uses.push(TextureUse { transform, texture_index, uv_set: d.word() % 2 });
        }
        self.shading.uses.push(TextureUse::new(self.shading.textures.len() as u32));
        self.shading.textures.push(anisotropic);
        for texture in [MaterialTextures::NONE, self.shading.uses.len() as u32 - 1] {
            let direction = [0.6, if texture == MaterialTextures::NONE { 0.8 } else { -0.8 }];
            self.shading.anisotropies.push(Anisotropy { strength: 0.7, direction, texture });
        }
    }

    /// Materials with and without textures.
    fn add_materials(&mut self, d: &mut Draw) {
        let none = MaterialTextures::NONE;
        let images = self.shading.textures.len() as u32 - 4;
        let (mut of_specular, mut of_leaves, mut of_cloth) = (Draw::of(0, 4), Draw::of(0, 6), Draw::of(0, 7));
        let (mut of_glass, mut panes) = (Draw::of(0, 8), Vec::new());
        for index in 0..MATERIALS {
            let mut image = || if d.now_and_then() { none } else { d.word() % images };
            let (base_color, emission, metallic_roughness) = (image(), image(), image());
            let normal = if d.now_and_then() { none } else { images + d.word() % 3 };
            let normal_scale = d.pick(&[1.0, 0.5, -0.8]);
            let alpha = if d.now_and_then() { none } else { d.word() % images };
            let entry = MaterialTextures {
                base_color,
                emission,
                normal,
                normal_scale,
                metallic_roughness,
                alpha,
                specular: if of_specular.now_and_then() { none } else { of_specular.word() % images },
                specular_color: if of_specular.now_and_then() { none } else { of_specular.word() % images },
                clearcoat: if of_specular.now_and_then() { none } else { of_specular.word() % images },
                clearcoat_roughness: if of_specular.now_and_then() { none } else { of_specular.word() % images },
                clearcoat_factor: of_specular.pick(&[0.0, 0.5, 1.0]),
                clearcoat_roughness_factor: of_specular.unit(),
                anisotropy: if index % 3 == 0 { none } else { index % 3 - 1 },
                specular_color_factor: [(); 3].map(|()| of_specular.between(0.5, 3.0)),
            };
            self.shading.material_textures.push(entry);
            let mut used = || if of_leaves.now_and_then() { none } else { of_leaves.word() % images };
            let (color_texture, factor_texture) = (used(), used());
            let color = [(); 3].map(|()| of_leaves.unit());
            let factor = if index % 4 == 3 { of_leaves.between(0.1, 1.0) } else { 0.0 };
            let leaf =
                DiffuseTransmission { color, factor, color_texture, factor_texture, ..DiffuseTransmission::NONE };
            // Vertex normals, and normal maps.
            let texture = if index % 4 == 1 { images + index % 3 } else { none };
            let coat = ClearcoatNormal { is_own: index % 2, texture, scale: 0.7, reserved: 0 };
            self.shading.clearcoat_normals.push(coat);
            let mut used = || if of_cloth.now_and_then() { none } else { of_cloth.word() % images };
            let (color_texture, roughness_texture) = (used(), used());
            let color = [(); 3].map(|()| of_cloth.unit());
            let roughness = of_cloth.unit();
            let cloth = SheenLayer { color, roughness, color_texture, roughness_texture, ..SheenLayer::NONE };
            self.shading.sheens.push(if index % 3 == 2 { SheenLayer::NONE } else { cloth });
            // Those without any are not read.
            self.shading.diffuse_transmissions.push(if factor > 0.0 { leaf } else { DiffuseTransmission::NONE });
            let factor_texture = if of_glass.now_and_then() { none } else { of_glass.word() % images };
            let (factor, glass) = (of_glass.between(0.1, 1.0), MATERIALS + panes.len() as u32);
            let pane = PartialTransmission { factor, factor_texture, glass, reserved: 0 };
            let is_partly_glass = index % 3 == 1;
            self.shading.partial_transmissions.push(if is_partly_glass { pane } else { PartialTransmission::NONE });
            let albedo = [d.between(0.1, 1.0), d.between(0.1, 1.0), d.between(0.1, 1.0)];
            let emission = [d.between(0.5, 9.0), d.between(0.5, 9.0), d.between(0.5, 9.0)];
            let textures = if index == 0 { 0 } else { index + 1 };
            // Two of three have alpha: probabilities, and a cutoff.
            let (flags, alpha_cutoff) = [(0, 0.0), (Material::ALPHA, 0.0), (Material::ALPHA, 0.2)][index as usize % 3];
            let alpha = d.between(0.5, 1.0);
            let entry = (textures as usize).checked_sub(1).and_then(|at| self.shading.diffuse_transmissions.get(at));
            let transmits = entry.is_some_and(|entry| entry.factor > 0.0);
            let flags = if transmits { flags | Material::DIFFUSE_TRANSMISSION } else { flags };
            let flags = if is_partly_glass { flags | Material::PARTIAL_TRANSMISSION } else { flags };
            let kind = if index % 2 == 0 { MaterialKind::Lambert } else { MaterialKind::Glossy };
            let (metallic, roughness, specular) = (d.unit(), d.unit(), of_specular.between(0.5, 1.0));
            let surface =
                Material { kind: kind as u32, metallic, roughness, specular, ior: 1.5, ..Material::default() };
            let material = Material { albedo, emission, textures, flags, alpha, alpha_cutoff, ..surface };
            self.materials.push(material);
            if is_partly_glass {
                panes.push(Material { kind: MaterialKind::Thin as u32, flags: 0, roughness: 0.0, ..material });
            }
        }
        self.materials.extend(panes);
    }

    /// A triangle with vertex normals within 25 degrees of its own, every fifth without, and tangents to match.
    fn add_triangle(&mut self, d: &mut Draw, index: u32) {
        let corners = [d.point(), d.point(), d.point()];
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let normal = cross.normalize_or(Vec3::Z);
        let first = self.positions.len() as u32;
        self.positions.extend(corners.map(|corner| corner.to_array()));
        self.triangles.push([first, first + 1, first + 2]);
        self.primitives.push(Primitive { normal: normal.to_array(), material: d.word() % MATERIALS });
        let mut tilted = |axis: Vec3| octahedral::pack((axis + d.direction() * 0.4).normalize());
        let mut normals = [normal; 3].map(&mut tilted);
        if index % 5 == 4 {
            normals[0] = ShadingTables::FLAT;
        }
        self.shading.normals.push(normals);
        let tangents = [sampling::basis(normal).0; 3].map(&mut tilted);
        let sign = index % 2;
        self.shading.tangents.push(tangents.map(|word| word & !1 | sign));
        self.shading.colors.push([[(); 2]; 3].map(|color| color.map(|()| d.word())));
        if index < LIGHTS {
            let power = [d.between(0.1, 1.0), d.pick(&[0.0, 0.2]), d.between(0.1, 1.0)];
            let area = 0.5 * cross.length();
            self.lights.push(Light { primitive: index, power, area, flags: index % 2, ..Light::default() });
            self.light_cdf.push(index * (u32::MAX / LIGHTS));
        }
    }
}

#[test]
fn the_scene_has_what_is_read() {
    use photon_core::Features;
    let view = SHADED.view();
    view.validate().unwrap();
    let read = Features::SHADED.without(Features::ROUGH_GLASS);
    assert!(Features::of(&view).contains(
        read.union(Features::TEXTURED_LIGHTS).union(Features::COATED_LIGHTS).union(Features::RANDOM_SURFACES)
    ));
    let mut slots = SHADED.slots.clone();
    slots.sort_unstable();
    assert!(slots.iter().copied().eq(0..TRIANGLES) && slots != SHADED.slots, "{slots:?}");
}

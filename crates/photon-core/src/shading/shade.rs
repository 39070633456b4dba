//! Evaluates vertex attributes and textures at a hit.

use glam::Vec3;

use crate::scene::caster::Hit;
use crate::scene::light::Light;
use crate::scene::material::Material;
use crate::scene::texture::{Anisotropy, MaterialTextures, ShadingTables};
use crate::shading::alpha;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::layers::Layers;
use crate::shading::octahedral;
use crate::shading::partial_transmission;
use crate::shading::shading_normal::bend;
use crate::shading::texture::{ByteValues, lookup, transform};

/// A surface's material and normal at one point.
// Exhaustive: backends write it as a literal.
#[derive(Clone, Copy, Debug)]
pub struct Shaded {
    /// The material, with colours from textures and vertices.
    pub material: Material,
    /// Unit shading normal on the side that the ray came from, with a cosine of at least 0.001 to the geometric one.
    pub normal: Vec3,
    /// What glossy surfaces have beyond it.
    pub layers: Layers,
}

/// The tables of a scene that shading reads, with those that decode texels.
// Exhaustive: backends write it as a literal.
#[derive(Clone, Copy, Debug)]
pub struct Shading<'a> {
    /// The scene's.
    pub tables: ShadingTables<'a>,
    /// From [`crate::texture::byte_values`].
    pub values: &'a ByteValues,
    /// Number of triangles.
    pub triangles: usize,
}

impl Shading<'_> {
    /// Material and normal at `hit`, where `surface` has the material `material`.
    #[inline]
    #[must_use]
    pub fn shade(&self, surface: &SurfaceInteraction, hit: &Hit, material: &Material) -> Shaded {
        self.shade_as::<false>(surface, hit, material)
    }

    /// The same, if no material of the scene has more than a base colour, emission and a normal map:
    /// [`crate::Features::MATTE`].
    #[inline]
    #[must_use]
    pub fn shade_matte(&self, surface: &SurfaceInteraction, hit: &Hit, material: &Material) -> Shaded {
        self.shade_as::<true>(surface, hit, material)
    }

    #[inline(always)]
    fn shade_as<const MATTE: bool>(&self, surface: &SurfaceInteraction, hit: &Hit, material: &Material) -> Shaded {
        let corners = Corners::of(hit);
        let mut shaded = *material;
        let mut layers = Layers::NONE;
        if let Some(colors) = self.tables.colors.get(corners.triangle) {
            let color = interpolate(colors.map(unpack_color), corners.weights);
            shaded.albedo = (Vec3::from(shaded.albedo) * color).to_array();
        }
        let front = if surface.front { surface.normal } else { -surface.normal };
        let mut normal = self.vertex_normal(&corners, front);
        if let Some(textures) = self.textures_of(material) {
            if let Some(color) = self.sample(textures.base_color, &corners) {
                shaded.albedo = (Vec3::from(shaded.albedo) * color).to_array();
            }
            if let Some(color) = self.sample(textures.emission, &corners) {
                shaded.emission = (Vec3::from(shaded.emission) * color).to_array();
            }
            if !MATTE {
                self.shade_layers((&mut shaded, &mut layers), (material, textures), &corners, (surface, front, normal));
            }
            if let Some(texel) = self.sample(textures.normal, &corners) {
                normal = self.mapped_normal(&corners, normal, texel, textures.normal_scale);
            }
        }
        let normal = bend(normal, front);
        Shaded { material: shaded, normal: if surface.front { normal } else { -normal }, layers }
    }

    /// What glossy surfaces and sheets have beyond a base colour: adapts `shaded` and `layers`. `front` is the geometric normal
    /// on the front, `normal` the vertex normal.
    #[inline]
    fn shade_layers(
        &self,
        (shaded, layers): (&mut Material, &mut Layers),
        (material, textures): (&Material, &MaterialTextures),
        corners: &Corners,
        (surface, front, normal): (&SurfaceInteraction, Vec3, Vec3),
    ) {
        if let Some(color) = self.sample(textures.metallic_roughness, corners) {
            shaded.roughness *= color.y;
            shaded.metallic *= color.z;
        }
        if material.has_partial_transmission() {
            let share = self.glass_share_at(corners, material);
            shaded.metallic = partial_transmission::opaque_metallic(shaded.metallic, share);
        }
        if let Some([.., alpha]) = self.texel(textures.specular, corners) {
            shaded.specular *= alpha;
        }
        if textures.has_specular_color() {
            layers.specular_color = textures.specular_color_factor.into();
            if let Some(color) = self.sample(textures.specular_color, corners) {
                layers.specular_color *= color;
            }
        }
        if textures.clearcoat_factor > 0.0 {
            (layers.clearcoat, layers.clearcoat_roughness) = self.clearcoat(textures, corners);
        }
        if let Some(anisotropy) = self.tables.anisotropies.get(textures.anisotropy as usize) {
            let texel = self.sample(anisotropy.texture, corners);
            let (strength, direction) = direction(anisotropy, texel);
            *layers = layers.with_anisotropy(strength, self.tangent(corners, normal, direction));
        }
        let index = (material.textures as usize).wrapping_sub(1);
        let coat = self.tables.clearcoat_normals.get(index).filter(|coat| coat.is_own != 0);
        if let Some(coat) = coat.filter(|_| textures.clearcoat_factor > 0.0) {
            let turned = self
                .sample(coat.texture, corners)
                .map_or(normal, |texel| self.mapped_normal(corners, normal, texel, coat.scale));
            let turned = bend(turned, front);
            *layers = layers.with_coat_normal(if surface.front { turned } else { -turned });
        }
        if let Some(entry) = self.tables.diffuse_transmissions.get(index) {
            let (mut share, mut color) = (entry.factor, Vec3::from(entry.color));
            if let Some([.., alpha]) = self.texel(entry.factor_texture, corners) {
                share *= alpha;
            }
            if let Some(texel) = self.sample(entry.color_texture, corners) {
                color *= texel;
            }
            *layers = layers.with_diffuse_transmission(share, color);
        }
        if let Some(sheen) = self.tables.sheens.get(index) {
            let (mut color, mut roughness) = (Vec3::from(sheen.color), sheen.roughness);
            if let Some(texel) = self.sample(sheen.color_texture, corners) {
                color *= texel;
            }
            if let Some([.., alpha]) = self.texel(sheen.roughness_texture, corners) {
                roughness *= alpha;
            }
            *layers = layers.with_sheen(color, roughness);
        }
    }

    /// The probability with which the surface, whose material is `material`, is there at `hit`: its alpha, or with a
    /// cutoff 0 or 1 (see [`alpha::coverage`]).
    #[inline]
    #[must_use]
    pub fn coverage(&self, hit: &Hit, material: &Material) -> f32 {
        self.coverage_at(hit.primitive as usize, (hit.u, hit.v), material)
    }

    #[inline]
    fn coverage_at(&self, triangle: usize, (u, v): (f32, f32), material: &Material) -> f32 {
        if !material.has_alpha() {
            return 1.0;
        }
        let corners = Corners { triangle, weights: [1.0 - u - v, u, v] };
        let mut found = material.alpha;
        if let Some(colors) = self.tables.colors.get(triangle) {
            let ([a, b, c], weights) = (colors.map(unpack_alpha), corners.weights);
            found *= a * weights[0] + b * weights[1] + c * weights[2];
        }
        if let Some([.., texel]) = self.textures_of(material).and_then(|used| self.texel(used.alpha, &corners)) {
            found *= texel;
        }
        alpha::coverage(found, material.alpha_cutoff)
    }

    /// Radiance that `material` emits at barycentric coordinates (u, v) of `triangle`, without regard to alpha.
    #[inline]
    #[must_use]
    pub fn emission(&self, triangle: usize, (u, v): (f32, f32), material: &Material) -> Vec3 {
        let emission = Vec3::from(material.emission);
        let corners = Corners { triangle, weights: [1.0 - u - v, u, v] };
        let used = self.textures_of(material).map_or(MaterialTextures::NONE, |textures| textures.emission);
        self.sample(used, &corners).map_or(emission, |color| emission * color)
    }

    /// Ratio of the radiance that the triangle of `light` emits at barycentric coordinates (u, v) to its mean, where
    /// `material` is the triangle's; 0 in a channel that it does not emit. Alpha multiplies it, but not the mean.
    #[inline]
    #[must_use]
    pub fn emission_ratio(&self, light: &Light, (u, v): (f32, f32), material: &Material) -> Vec3 {
        let sides = if light.flags & Light::BOTH_SIDES != 0 { 2.0 } else { 1.0 };
        let triangle = light.primitive as usize;
        let mut emission = self.emission(triangle, (u, v), material);
        if material.has_alpha() {
            emission *= self.coverage_at(triangle, (u, v), material);
        }
        let flux = emission * (sides * std::f32::consts::PI * light.area);
        let power = Vec3::from(light.power);
        Vec3::select(power.cmpgt(Vec3::ZERO), flux / power, Vec3::ZERO)
    }

    /// Weight and roughness of the clearcoat of a material with one.
    #[inline]
    pub(super) fn clearcoat(&self, textures: &MaterialTextures, corners: &Corners) -> (f32, f32) {
        let (mut weight, mut roughness) = (textures.clearcoat_factor, textures.clearcoat_roughness_factor);
        if let Some(color) = self.sample(textures.clearcoat, corners) {
            weight *= color.x;
        }
        if let Some(color) = self.sample(textures.clearcoat_roughness, corners) {
            roughness *= color.y;
        }
        (weight, roughness)
    }

    #[inline]
    pub(super) fn textures_of(&self, material: &Material) -> Option<&MaterialTextures> {
        self.tables.material_textures.get((material.textures as usize).wrapping_sub(1))
    }

    /// Red, green and blue of the texture of a use; `None` for [`MaterialTextures::NONE`].
    #[inline]
    pub(super) fn sample(&self, index: u32, corners: &Corners) -> Option<Vec3> {
        self.texel(index, corners).map(|[red, green, blue, _]| Vec3::new(red, green, blue))
    }

    /// The texture of a use; `None` for [`MaterialTextures::NONE`].
    #[inline]
    fn texel(&self, index: u32, corners: &Corners) -> Option<[f32; 4]> {
        let used = self.tables.uses.get(index as usize)?;
        let uvs = self.tables.uvs.get(used.uv_set as usize * self.triangles + corners.triangle)?;
        let [a, b, c] = corners.weights;
        let uv = std::array::from_fn(|axis| uvs[0][axis] * a + uvs[1][axis] * b + uvs[2][axis] * c);
        Some(lookup(&self.tables.textures[used.texture_index as usize], self.values, transform(used, uv)))
    }

    /// The interpolated vertex normal on the front; the geometric one, `front`, without vertex normals.
    #[inline]
    pub(super) fn vertex_normal(&self, corners: &Corners, front: Vec3) -> Vec3 {
        match self.tables.normals.get(corners.triangle) {
            Some(&[ShadingTables::FLAT, ..]) | None => front,
            Some(packed) => interpolate(packed.map(octahedral::unpack), corners.weights).normalize_or(front),
        }
    }

    /// The normals at the vertices of the triangle at `hit`, on its front; `None` if it has none.
    #[inline]
    #[must_use]
    pub fn vertex_normals(&self, hit: &Hit) -> Option<[Vec3; 3]> {
        match self.tables.normals.get(hit.primitive as usize) {
            Some(&[ShadingTables::FLAT, ..]) | None => None,
            Some(packed) => Some(packed.map(octahedral::unpack)),
        }
    }

    /// The tangent of this direction in the frame of the vertex tangents.
    #[inline]
    fn tangent(&self, corners: &Corners, normal: Vec3, direction: [f32; 2]) -> Vec3 {
        let Some(packed) = self.tables.tangents.get(corners.triangle) else { return Vec3::ZERO };
        let tangent = interpolate(packed.map(octahedral::unpack), corners.weights);
        turned_tangent(tangent, if packed[0] & 1 == 1 { -1.0 } else { 1.0 }, normal, direction)
    }

    /// `normal` turned by a texel of a normal map, in the frame of the vertex tangents.
    #[inline]
    pub(super) fn mapped_normal(&self, corners: &Corners, normal: Vec3, texel: Vec3, scale: f32) -> Vec3 {
        let Some(packed) = self.tables.tangents.get(corners.triangle) else { return normal };
        let tangent = interpolate(packed.map(octahedral::unpack), corners.weights);
        turned(tangent, if packed[0] & 1 == 1 { -1.0 } else { 1.0 }, normal, texel, scale)
    }
}

/// A point of a triangle: its barycentric coordinates.
pub(super) struct Corners {
    pub(super) triangle: usize,
    pub(super) weights: [f32; 3],
}

impl Corners {
    #[inline]
    pub(super) fn of(hit: &Hit) -> Self {
        Self { triangle: hit.primitive as usize, weights: [1.0 - hit.u - hit.v, hit.u, hit.v] }
    }
}

/// The sum of the values at three vertices, weighted.
#[inline]
#[must_use]
pub fn interpolate([a, b, c]: [Vec3; 3], weights: [f32; 3]) -> Vec3 {
    a * weights[0] + b * weights[1] + c * weights[2]
}

/// The unit vector `normal` turned by a texel of a normal map (glTF 2.0, section 3.9.3): `tangent` is made perpendicular
/// to it, `sign` is 1 or -1 for the direction of the bitangent, and `scale` multiplies x and y of the texel. `normal`
/// itself where `tangent` is parallel to it or the result is 0.
#[inline]
#[must_use]
pub fn turned(tangent: Vec3, sign: f32, normal: Vec3, texel: Vec3, scale: f32) -> Vec3 {
    let tangent = (tangent - normal * normal.dot(tangent)).normalize_or(Vec3::ZERO);
    if tangent == Vec3::ZERO {
        return normal;
    }
    let bitangent = normal.cross(tangent) * sign;
    let [x, y, z] = (texel * 2.0 - Vec3::ONE).to_array();
    (tangent * (x * scale) + bitangent * (y * scale) + normal * z).normalize_or(normal)
}

/// Strength and direction of an anisotropy with a texel of its texture, if it has one.
#[inline]
#[must_use]
pub fn direction(anisotropy: &Anisotropy, texel: Option<Vec3>) -> (f32, [f32; 2]) {
    let [cos, sin] = anisotropy.direction;
    let Some(texel) = texel else { return (anisotropy.strength, anisotropy.direction) };
    let (x, y) = (texel.x * 2.0 - 1.0, texel.y * 2.0 - 1.0);
    (anisotropy.strength * texel.z, [cos * x - sin * y, sin * x + cos * y])
}

/// The unit vector of this direction in the frame of `tangent` and `normal`, as that of [`turned`]; 0 where the tangent is
/// parallel to the normal or 0, and the tangent for the direction 0.
#[inline]
#[must_use]
pub fn turned_tangent(tangent: Vec3, sign: f32, normal: Vec3, [x, y]: [f32; 2]) -> Vec3 {
    let tangent = (tangent - normal * normal.dot(tangent)).normalize_or(Vec3::ZERO);
    let bitangent = normal.cross(tangent) * sign;
    (tangent * x + bitangent * y).normalize_or(tangent)
}

/// Of 16 bits.
const STEP: f32 = 1.0 / 65_535.0;

/// Alpha of a vertex colour, an entry of [`ShadingTables::colors`].
#[inline]
#[must_use]
pub fn unpack_alpha([_, blue_alpha]: [u32; 2]) -> f32 {
    (blue_alpha >> 16) as f32 * STEP
}

/// Red, green and blue of a vertex colour, an entry of [`ShadingTables::colors`].
#[inline]
#[must_use]
pub fn unpack_color([red_green, blue_alpha]: [u32; 2]) -> Vec3 {
    Vec3::new((red_green & 0xFFFF) as f32, (red_green >> 16) as f32, (blue_alpha & 0xFFFF) as f32) * STEP
}

#[cfg(test)]
mod tests;

//! Light that a surface with a clearcoat emits; `coated_light.glsl` is the twin.
//!
//! A clearcoat of weight c dims the emission L of the surface below it: `L (1 − c E(cos))` leaves in a direction with this
//! cosine to the normal of the clearcoat, where E is its directional albedo (`KHR_materials_clearcoat` of glTF 2.0, with the
//! albedo in place of Fresnel's factor, so that a white furnace keeps its radiance). Camera paths, shadow rays and photons
//! all use [`Shading::emission_through`]: light that is found by any of them is the same.

use glam::Vec3;

use crate::scene::material::Material;
use crate::shading::clearcoat::Clearcoat;
use crate::shading::shade::{Corners, Shading};
use crate::shading::shading_normal::bend;

impl Shading<'_> {
    /// The share of the radiance emitted at barycentric coordinates (u, v) of `triangle` that leaves through its clearcoat
    /// in `direction`, in `[0, 1]`; 1 without one. `front` is the geometric normal of the triangle, and `material` its own.
    #[inline]
    #[must_use]
    pub fn emission_through(
        &self,
        triangle: usize,
        (u, v): (f32, f32),
        material: &Material,
        front: Vec3,
        direction: Vec3,
    ) -> f32 {
        let Some(textures) = self.textures_of(material).filter(|textures| textures.clearcoat_factor > 0.0) else {
            return 1.0;
        };
        let corners = Corners { triangle, weights: [1.0 - u - v, u, v] };
        let (weight, roughness) = self.clearcoat(textures, &corners);
        let index = (material.textures as usize).wrapping_sub(1);
        let own = self.tables.clearcoat_normals.get(index).filter(|coat| coat.is_own != 0);
        let (map, scale) = own.map_or((textures.normal, textures.normal_scale), |coat| (coat.texture, coat.scale));
        let mut normal = self.vertex_normal(&corners, front);
        if let Some(texel) = self.sample(map, &corners) {
            normal = self.mapped_normal(&corners, normal, texel, scale);
        }
        let cosine = direction.dot(bend(normal, front));
        let side = if direction.dot(front) < 0.0 { -cosine } else { cosine };
        Clearcoat { weight, roughness }.through(side)
    }
}

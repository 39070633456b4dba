//! [`ReflectionLobe::weight`] for several photons at a time.

use glam::Vec3;

use super::ReflectionLobe;
use crate::shading::albedo_table::AlbedoTable;
use crate::shading::{ggx, shading_normal};

/// Vectors, one array for each coordinate.
pub type Vectors<const N: usize> = [[f32; N]; 3];

#[inline(always)]
pub(crate) fn vector<const N: usize>(of: &Vectors<N>, lane: usize) -> Vec3 {
    Vec3::new(of[0][lane], of[1][lane], of[2][lane])
}

impl ReflectionLobe {
    /// [`Self::weight`] for `N` photons, with the same bits. Loops over arrays of fixed length, which the compiler vectorizes for
    /// the instruction set of the surrounding function.
    #[inline(always)]
    #[must_use]
    pub fn weights<const N: usize>(&self, wi: &Vectors<N>, geometric: &Vectors<N>) -> Vectors<N> {
        let mut weights = [[0.0; N]; 3];
        if self.sheen.is_some() || self.anisotropic.is_some() {
            for lane in 0..N {
                let weight = self.weight(vector(wi, lane), vector(geometric, lane));
                (0..3).for_each(|c| weights[c][lane] = weight[c]);
            }
            return weights;
        }
        let [tangent, bitangent, normal] = self.frame;
        let o = self.wo;
        let (mut ratios, mut singles, mut grazings, mut cosines) = ([0.0; N], [0.0; N], [0.0; N], [0.0; N]);
        for lane in 0..N {
            let wi = vector(wi, lane);
            let ratio = shading_normal::cosine_ratio(wi, vector(geometric, lane), normal);
            let i = Vec3::new(wi.dot(tangent), wi.dot(bitangent), wi.dot(normal));
            let half = o + i;
            let length = half.length();
            let is_reflected = (ratio > 0.0) & (o.z > 0.0) & (i.z > 0.0) & (length > 0.0);
            let h = half / length;
            let across = (1.0 - o.dot(h)).clamp(0.0, 1.0);
            let square = across * across;
            grazings[lane] = square * square * across;
            singles[lane] = ggx::distribution(self.alpha, h) * ggx::visibility(self.alpha, o.z, i.z);
            cosines[lane] = i.z.clamp(0.0, 1.0);
            // What is not reflected may not be a number here.
            ratios[lane] = if is_reflected { ratio } else { 0.0 };
        }
        let mut losses = [0.0; N];
        let row = AlbedoTable::get().row(self.roughness);
        for lane in 0..N {
            let albedo = row.directional(cosines[lane]);
            losses[lane] = (1.0 - (albedo.x + albedo.y)).max(0.0);
        }
        for c in 0..3 {
            let (f0, multiple) = (self.f0[c], self.multiple[c]);
            for lane in 0..N {
                let fresnel = f0 * (1.0 - grazings[lane]) + self.f90 * grazings[lane];
                let value = fresnel * singles[lane] + multiple * (losses[lane] * std::f32::consts::FRAC_1_PI);
                weights[c][lane] = if ratios[lane] > 0.0 { value * ratios[lane] } else { 0.0 };
            }
        }
        weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{SplitMix64, unit_f32};
    use crate::scene::material::{Material, MaterialKind};
    use crate::shading::layers::Layers;
    use crate::shading::{anisotropy, sampling};

    fn lobes(normal: Vec3, wo: Vec3) -> Vec<ReflectionLobe> {
        let material = |metallic, roughness| Material {
            kind: MaterialKind::Glossy as u32,
            albedo: [0.9, 0.5, 0.1],
            metallic,
            roughness,
            specular: 1.0,
            ior: 1.5,
            ..Material::default()
        };
        let all = [(0.0, 0.0), (1.0, 1e-3), (0.3, 0.4), (1.0, 1.0)].map(|(metallic, roughness)| {
            ReflectionLobe::new(ReflectionLobe::pack(&material(metallic, roughness), &Layers::NONE).0, wo, normal)
        });
        let words = ReflectionLobe::pack(&material(1.0, 0.5), &Layers::NONE).0;
        let layers = Layers { anisotropy: 0.8, tangent: sampling::basis(normal).0, ..Layers::NONE };
        let anisotropy = anisotropy::pack(&layers, normal);
        let sheen = ReflectionLobe::pack_sheen(&Layers { sheen_roughness: 0.5, ..Layers::NONE });
        let others =
            [ReflectionLobe::with_anisotropy(words, anisotropy, wo, normal), ReflectionLobe::new(sheen, wo, normal)];
        assert!(others[0].anisotropic.is_some() && others[1].sheen.is_some());
        all.into_iter().chain(others).collect()
    }

    /// Directions all around, towards the viewer's reflection, opposite to the viewer and along the normal.
    #[test]
    fn weights_have_the_bits_of_single_ones() {
        const N: usize = 16;
        let normal = Vec3::new(0.48, 0.6, -0.64);
        let mut numbers = SplitMix64(5);
        let mut direction = || {
            let mut number = || unit_f32(numbers.word() as u32);
            sampling::about(normal, 2.0 * number() - 1.0, number())
        };
        for wo in [normal, direction(), -normal, sampling::about(normal, 1e-3, 0.3)] {
            for lobe in lobes(normal, wo) {
                for round in 0..40 {
                    let mirrored = normal * (2.0 * wo.dot(normal)) - wo;
                    let special = [mirrored, -wo, normal, wo];
                    let (mut wi, mut geometric) = ([[0.0; N]; 3], [[0.0; N]; 3]);
                    for lane in 0..N {
                        let toward = if lane < 4 { special[lane] } else { direction() };
                        let tilted = if round % 2 == 0 { normal } else { direction() };
                        (0..3).for_each(|c| (wi[c][lane], geometric[c][lane]) = (toward[c], tilted[c]));
                    }
                    let found = lobe.weights(&wi, &geometric);
                    for lane in 0..N {
                        let expected = lobe.weight(vector(&wi, lane), vector(&geometric, lane));
                        let bits = |v: Vec3| v.to_array().map(f32::to_bits);
                        assert_eq!(bits(vector(&found, lane)), bits(expected), "{lobe:?} {lane}");
                    }
                }
            }
        }
    }
}

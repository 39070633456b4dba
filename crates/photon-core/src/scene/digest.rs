//! A digest of a scene, by which stored films recognise it.

use bytemuck::NoUninit;

use crate::scene::SceneView;
use crate::scene::environment::EnvironmentMap;
use crate::scene::texture::{ShadingTables, Texture};
use crate::scene::units::Units;

/// FNV-1a with 128 bits (Fowler, Noll, Vo; RFC 9923). Not for adversaries: it detects mistakes.
struct Digest(u128);

impl Digest {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;

    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(Self::PRIME);
        }
    }

    /// A table, with its length, so that elements do not move unnoticed from one table to the next.
    fn table<T: NoUninit>(&mut self, table: &[T]) {
        self.bytes(&(table.len() as u64).to_le_bytes());
        self.bytes(bytemuck::cast_slice(table));
    }
}

impl SceneView<'_> {
    /// Digest of all tables and units: the same for the same scene in every run and on every little-endian platform, and
    /// for no other scene that is likely to be met.
    #[must_use]
    pub fn digest(&self) -> u128 {
        // Every member by name: a new one is an error here until it is part of the digest.
        let Self {
            positions,
            triangles,
            primitives,
            materials,
            boundaries,
            media,
            grids,
            lights,
            light_cdf,
            environment,
            portals,
            shading,
            radius,
            units: Units { center, scale, power },
        } = *self;
        let ShadingTables {
            normals,
            tangents,
            colors,
            uvs,
            material_textures,
            anisotropies,
            diffuse_transmissions,
            clearcoat_normals,
            sheens,
            partial_transmissions,
            uses,
            textures,
        } = shading;
        let mut digest = Digest(Digest::BASIS);
        digest.table(positions);
        digest.table(triangles);
        digest.table(primitives);
        digest.table(materials);
        if !boundaries.is_empty() {
            digest.table(boundaries.positions);
            digest.table(boundaries.triangles);
            digest.table(boundaries.media);
            digest.table(&[boundaries.scale]);
        }
        digest.table(media);
        digest.table(lights);
        digest.table(light_cdf);
        digest.table(normals);
        digest.table(tangents);
        digest.table(colors);
        digest.table(uvs);
        digest.table(material_textures);
        digest.table(anisotropies);
        // Scenes without these keep the digest that they had before.
        if !grids.grids.is_empty() {
            digest.table(grids.grids);
            digest.table(grids.bricks);
            digest.table(grids.densities);
        }
        if !diffuse_transmissions.is_empty() {
            digest.table(diffuse_transmissions);
        }
        if !clearcoat_normals.is_empty() {
            digest.table(clearcoat_normals);
        }
        if !sheens.is_empty() {
            digest.table(sheens);
        }
        if !partial_transmissions.is_empty() {
            digest.table(partial_transmissions);
        }
        digest.table(uses);
        digest.table(&[textures.len() as u64]);
        for Texture { texels, width, height, format, wrap, filter } in textures {
            digest.table(&[*width, *height, *format as u32, wrap[0] as u32, wrap[1] as u32, *filter as u32]);
            digest.table(texels);
        }
        if let Some(environment) = environment {
            digest.environment(environment);
        }
        if !portals.is_empty() {
            digest.table(portals);
        }
        digest.table(&[radius]);
        digest.table(&[center[0], center[1], center[2], scale, power]);
        digest.0
    }
}

impl Digest {
    /// All else of an environment follows from this.
    fn environment(&mut self, environment: &EnvironmentMap) {
        self.table(&[environment.width(), environment.height(), environment.rotation().to_bits()]);
        self.table(environment.texels());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::material::Material;
    use crate::scene::portal::Portal;

    /// Test vectors of RFC 9923.
    #[test]
    fn known_digests() {
        for (text, expected) in [
            ("", 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d_u128),
            ("a", 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964),
            ("foobar", 0x343e_1662_793c_64bf_6f0d_3597_ba44_6f18),
        ] {
            let mut digest = Digest(Digest::BASIS);
            digest.bytes(text.as_bytes());
            assert_eq!(digest.0, expected, "{text}");
        }
    }

    #[test]
    fn every_change_shows() {
        let map = |radiance| EnvironmentMap::constant([radiance; 3]).unwrap();
        let (one, two) = (map(1.0), map(2.0));
        let texture = Texture {
            texels: [1, 2].into(),
            width: 1,
            height: 2,
            format: crate::TexelFormat::default(),
            wrap: [crate::Wrap::default(); 2],
            filter: crate::Filter::default(),
        };
        let portal = [Portal::new([[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]])];
        let (tall, wide) = ([texture.clone()], [Texture { width: 2, height: 1, ..texture }]);
        let textured = |textures| SceneView {
            shading: ShadingTables { textures, ..ShadingTables::default() },
            ..SceneView::default()
        };
        let views = [
            SceneView::default(),
            SceneView { positions: &[[0.0; 3]], ..SceneView::default() },
            SceneView { positions: &[[0.0, 0.0, 1e-30]], ..SceneView::default() },
            SceneView { triangles: &[[0; 3]], ..SceneView::default() },
            SceneView { materials: &[Material::default()], ..SceneView::default() },
            SceneView { radius: 2.0, ..SceneView::default() },
            SceneView { units: Units { power: 2.0, ..Units::default() }, ..SceneView::default() },
            SceneView { environment: Some(&one), ..SceneView::default() },
            SceneView { environment: Some(&two), ..SceneView::default() },
            SceneView { portals: &portal, ..SceneView::default() },
            textured(&tall),
            textured(&wide),
        ];
        let digests: Vec<u128> = views.iter().map(SceneView::digest).collect();
        for (index, digest) in digests.iter().enumerate() {
            assert_eq!(views[index].digest(), *digest);
            assert!(!digests[..index].contains(digest), "{index}");
        }
    }
}

//! Clearcoats against closed forms and quadratures.

use photon_core::glam::DVec3;
use photon_core::{Direct, EnvironmentMap, Filter, Settings};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, TextureDesc, TextureRef, TexturesDesc};

use crate::gloss_caustics::through_a_pane;
use crate::gloss_reference::{Reference, albedo, schlick, single};
use crate::harness::{InFull, TestBackend, direct_settings, means_per_pass};
use crate::stats::{agrees, assert_agrees, moments, standard_error};
use crate::stripes::{self, VIEW};
use photon_scene::VertexAttributes;

/// A clearcoat in double precision: normal +y.
struct Clearcoat {
    weight: f64,
    alpha: f64,
}

impl Clearcoat {
    fn through(&self, cosine: f64) -> f64 {
        1.0 - self.weight * albedo(self.alpha, cosine, 0.04)
    }

    /// The BSDF over a surface whose reflection has the BSDF `below`, and whose base the albedo `base`.
    fn f(&self, o: DVec3, i: DVec3, below: f64, base: f64) -> f64 {
        let n = 64;
        let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
        let mean = (0..n).map(|k| self.through(at(k)) * 2.0 * at(k)).sum::<f64>() / f64::from(n);
        let (to, ti) = (self.through(o.y), self.through(i.y));
        let h = (o + i).normalize_or_zero();
        self.weight * schlick(0.04, o.dot(h)) * single(self.alpha, o, i)
            + below * to.min(ti)
            + base / std::f64::consts::PI * to * ti / mean
    }
}

const SUN: DVec3 = DVec3::new(-0.2, 1.0, -0.3);

/// Stripes under an even sky, or under a sun that with a pane only photons find.
fn scene(descs: Vec<(u32, MaterialDesc)>, mut builder: SceneBuilder, light: Option<bool>) -> Scene {
    stripes::add(&mut builder, descs, light == Some(true));
    if light.is_some() {
        builder.light("sun", LightDesc::Directional { direction: (-SUN).to_array(), irradiance: [2.0; 3] });
    } else {
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
    }
    builder.build().unwrap()
}

/// The mean of each column in each pass, of red.
pub(crate) fn columns<T: TestBackend>(scene: &Scene, settings: &Settings, passes: u32) -> [Vec<f64>; 8] {
    let mean = |beauty: &[[f32; 3]], column: usize| {
        (0..8).map(|row| f64::from(beauty[row * 8 + column][0])).sum::<f64>() / 8.0
    };
    let means = |beauty: &[[f32; 3]]| (0..8).map(|column| mean(beauty, column)).collect();
    means_per_pass::<T>(scene, settings, (passes, 8), means).try_into().expect("eight columns")
}

/// White diffuse surfaces with a clearcoat show an even sky's radiance of 1, white metals at least .947 of it.
pub fn white_furnace<T: TestBackend>() {
    let descs = vec![
        (1, MaterialDesc::lambert("diffuse", [1.0; 3]).with_clearcoat(1.0, 0.1)),
        (1, MaterialDesc::lambert("diffuse", [1.0; 3]).with_clearcoat(0.6, 0.7)),
        (1, MaterialDesc::lambert("diffuse", [1.0; 3])),
        (1, MaterialDesc::metal("metal", [1.0; 3], 0.2).with_clearcoat(1.0, 0.3)),
        (1, MaterialDesc::metal("metal", [1.0; 3], 0.8).with_clearcoat(1.0, 1.0)),
        (1, MaterialDesc::mirror("mirror", [1.0; 3]).with_clearcoat(1.0, 0.0)),
        (1, MaterialDesc::plastic("plastic", [1.0; 3], 0.4).with_clearcoat(1.0, 0.2)),
        (1, MaterialDesc::plastic("plastic", [1.0; 3], 0.4)),
    ];
    let scene = scene(descs, SceneBuilder::new(), None);
    let found = columns::<T>(&scene, &direct_settings(Direct::Nee, 0.1), 16);
    for (column, values) in found.iter().enumerate() {
        let (mean, error) = (moments(values).0, standard_error(values));
        let what = format!("column {column}: {mean} ± {error}");
        let least = [1.0, 1.0, 1.0, 0.947, 0.947, 0.947, 0.99, 1.0][column];
        let allowed = 4.5 * error + 3e-3;
        assert!(mean > least - allowed && mean < 1.0 + allowed, "{what}");
    }
}

/// A sun on coated surfaces: the BSDF by shadow rays, and by photons where only these find it, on the base and in the
/// reflections. A textured clearcoat looks like two materials.
pub fn sunlit_surfaces<T: TestBackend>() {
    let (o, i) = (VIEW.normalize_or_zero(), SUN.normalize_or_zero());
    let whole = Clearcoat { weight: 1.0, alpha: 0.4 * 0.4 };
    let part = Clearcoat { weight: 0.6, alpha: 0.8 * 0.8 };
    let metal = Reference::new(0.25, 1.0, 0.7);
    let diffuse = || MaterialDesc::lambert("diffuse", [0.5; 3]);
    let black = || MaterialDesc::lambert("black", [0.0; 3]);
    let make = |pane: bool| {
        let mut builder = SceneBuilder::new();
        // Weights 1 and .6, roughnesses .4 and .8.
        let texels = [[255, 102, 0, 255], [153, 204, 0, 255]];
        let image = builder.texture(TextureDesc::linear8("halves", 2, 1, &texels).filtered(Filter::Nearest));
        let image = TextureRef::new(image);
        let textures = TexturesDesc::default().with_clearcoat(image).with_clearcoat_roughness(image);
        let mut descs = vec![
            (2, diffuse().with_clearcoat(1.0, 1.0).with_textures(textures)),
            (1, diffuse().with_clearcoat(1.0, 0.4)),
            (1, diffuse().with_clearcoat(0.6, 0.8)),
            (1, black().with_clearcoat(1.0, 0.4)),
            (1, metal.material().with_clearcoat(1.0, 0.4)),
            (1, metal.material().with_clearcoat(0.6, 0.8)),
            (1, diffuse()),
        ];
        if pane {
            // Photons on bases beside each other have different factors: one base, whose edges are not looked at.
            descs.splice(0..3, [(4, diffuse().with_clearcoat(1.0, 0.4))]);
        }
        scene(descs, builder, Some(pane))
    };
    let shown = |f: f64| f * 2.0 * i.y;
    let expected = [
        whole.f(o, i, 0.0, 0.5),
        part.f(o, i, 0.0, 0.5),
        whole.f(o, i, 0.0, 0.5),
        part.f(o, i, 0.0, 0.5),
        whole.f(o, i, 0.0, 0.0),
        whole.f(o, i, metal.f(o, i), 0.0),
        part.f(o, i, metal.f(o, i), 0.0),
        0.5 / std::f64::consts::PI,
    ]
    .map(shown);
    let open = columns::<T>(&make(false), &direct_settings(Direct::Nee, 0.1), 1).map(|values| values[0]);
    for (column, (found, expected)) in open.into_iter().zip(expected).enumerate() {
        assert_agrees(&format!("column {column}"), found, expected, 0.0, 4e-3 * expected);
        let other = if column == 7 { 0.0 } else { expected - shown(metal.f(o, i)).min(0.02) };
        assert!(!agrees(found, other, 0.0, 4e-3 * expected), "column {column}: {found} {other}");
    }
    for (textured, even) in [(0, 2), (1, 3)] {
        assert!((open[textured] / open[even] - 1.0).abs() < 1e-5, "{open:?}");
    }
    assert!((open[0] / open[1] - 1.0).abs() > 0.02, "{open:?}");

    // By photons that pass a pane, on the base and for the reflections.
    let behind = columns::<T>(&make(true), &direct_settings(Direct::Nee, 0.1), 16);
    for (column, like) in [(1, 2), (2, 2), (4, 4), (5, 5), (6, 6)] {
        let (values, truth) = (&behind[column], through_a_pane(i.y) * expected[like]);
        assert_agrees(&format!("pane, {column}"), moments(values).0, truth, standard_error(values), 6e-3 * truth);
    }
}

/// Clearcoats with normals of their own in a sun: those of a normal map, and the vertex normals where only the surface below
/// has one. By shadow rays, and behind a pane by photons.
pub fn own_normals<T: TestBackend>() {
    let (o, i) = (VIEW.normalize_or_zero(), SUN.normalize_or_zero());
    let (texel, scale) = ([166, 128, 238, 255], 0.7);
    let mut builder = SceneBuilder::new();
    let image = TextureRef::new(builder.texture(TextureDesc::linear8("tilted", 1, 1, &[texel])));
    let coat = TexturesDesc::default().with_clearcoat_normal(image, scale);
    let base = TexturesDesc::default().with_normal(image).with_normal_scale(scale);
    let both = base.with_clearcoat_normal(image, scale);
    let all = [(0.0, both), (0.0, base), (0.02, coat), (0.0, coat), (0.0, coat), (0.0, coat), (0.0, base), (0.0, coat)];
    let descs = all.map(|(albedo, textures)| {
        let desc = MaterialDesc::lambert("coated", [albedo; 3]).with_clearcoat(1.0, 0.4).with_textures(textures);
        let uvs = vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        (1, desc, VertexAttributes::default().with_uvs(vec![uvs]))
    });
    stripes::add_with(&mut builder, descs, false);
    // Between the sun and the upper half of x.
    let glass = builder.material(MaterialDesc::thin("pane", 1.5));
    let edge = 2.5 * SUN.x;
    builder.quad("pane", [[edge, 2.5, 3.0], [3.0, 2.5, 3.0], [3.0, 2.5, -3.0], [edge, 2.5, -3.0]], glass);
    builder.light("sun", LightDesc::Directional { direction: (-SUN).to_array(), irradiance: [2.0; 3] });
    let scene = builder.build().unwrap();

    // The tangent is +x, the bitangent −z.
    let [x, y, z] = [texel[0], texel[1], texel[2]].map(|byte| 2.0 * f64::from(byte) / 255.0 - 1.0);
    let tilted = DVec3::new(x * scale, z, -y * scale).normalize_or_zero();
    let across = tilted.any_orthonormal_vector();
    // A surface whose normal is +y.
    let turned = |w: DVec3| DVec3::new(w.dot(across), w.dot(tilted), w.dot(tilted.cross(across)));
    let clearcoat = Clearcoat { weight: 1.0, alpha: 0.4 * 0.4 };
    let even = clearcoat.f(o, i, 0.0, 0.0) * 2.0 * i.y;
    let bumpy = clearcoat.f(turned(o), turned(i), 0.0, 0.0) * 2.0 * i.dot(tilted);
    let below = (clearcoat.f(o, i, 0.0, 0.02) - clearcoat.f(o, i, 0.0, 0.0)) * 2.0 * i.y;
    assert!((bumpy / even - 1.0).abs() > 0.2, "{bumpy} {even}");
    let expected = [bumpy, even, bumpy + below, bumpy, bumpy, bumpy, even, bumpy];
    let (r, w) = (0.1, 0.25);
    let found = columns::<InFull<T>>(&scene, &direct_settings(Direct::Nee, r), 48);
    // Kernels of radius r move light across the edge of the pane's shadow and past the end of the surface: with the density
    // 2/(π r²) (1 − d²/r²) on a disc, ½ E|x| = 8 r/(15 π) per length of the edge, of columns of the width w.
    let edge = 8.0 * r / (15.0 * std::f64::consts::PI * w);
    for (column, (values, expected)) in found.iter().zip(expected).enumerate() {
        let (part, bound) = match column {
            ..3 => (1.0, 6e-3),
            3 => (1.0 + edge * through_a_pane(i.y), 6e-3),
            4 | 7 => (through_a_pane(i.y) * (1.0 - edge), 1.5e-2),
            _ => (through_a_pane(i.y), 1.5e-2),
        };
        let truth = part * expected;
        let what = format!("column {column}");
        assert_agrees(&what, moments(values).0, truth, standard_error(values), bound * truth);
    }
}

//! Sheen against quadratures in double precision.

use std::f64::consts::PI;

use photon_core::glam::DVec3;
use photon_core::{Direct, EnvironmentMap, Features, Filter, Settings};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, TextureDesc, TextureRef, TexturesDesc};

use crate::clearcoat::columns;
use crate::closed_room;
use crate::gloss_caustics::through_a_pane;
use crate::gloss_reference::{albedo, schlick, single};
use crate::harness::{TestBackend, direct_settings, look_at_point, per_pass};
use crate::stats::{agrees, assert_agrees, moments, standard_error};
use crate::stripes::{self, VIEW};

/// The layer of module `photon_core::sheen` in double precision: normal +y.
struct Sheen {
    color: f64,
    alpha: f64,
}

impl Sheen {
    fn new(color: f64, roughness: f64) -> Self {
        Self { color, alpha: roughness * roughness }
    }

    /// Estevez and Kulla 2017, table 1: the fit between α = 0 and 1.
    fn exponent(&self, x: f64) -> f64 {
        let t = (1.0 - self.alpha).powi(2);
        let mix = |one: f64, zero: f64| one * (1.0 - t) + zero * t;
        let (a, b, c) = (mix(21.5473, 25.3245), mix(3.82987, 3.32435), mix(0.19823, 0.16801));
        a / (1.0 + b * x.powf(c)) + mix(-1.97760, -1.27393) * x + mix(-4.32054, -4.85967)
    }

    fn lambda(&self, cosine: f64) -> f64 {
        if cosine < 0.5 {
            self.exponent(cosine).exp()
        } else {
            (2.0 * self.exponent(0.5) - self.exponent(1.0 - cosine)).exp()
        }
    }

    /// D V, without the limit at grazing angles.
    fn lobe(&self, o: DVec3, i: DVec3) -> f64 {
        let h = (o + i).normalize_or_zero();
        let inverse = 1.0 / self.alpha;
        let distribution = (2.0 + inverse) * (1.0 - h.y * h.y).max(0.0).powf(0.5 * inverse) / (2.0 * PI);
        distribution / ((1.0 + self.lambda(o.y) + self.lambda(i.y)) * 4.0 * o.y * i.y)
    }

    /// ∫ D V cos dω on a grid.
    fn albedo(&self, cosine: f64) -> f64 {
        let o = DVec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0);
        let (across, around) = (300, 48);
        let mut sum = 0.0;
        for k in 0..across * around {
            let root = (f64::from(k % across) + 0.5) / f64::from(across);
            let (y, phi) = (root * root, PI * (f64::from(k / across) + 0.5) / f64::from(around));
            let sine = (1.0 - y * y).sqrt();
            let i = DVec3::new(sine * phi.cos(), y, sine * phi.sin());
            sum += self.lobe(o, i) * y * 2.0 * root;
        }
        sum * 2.0 * PI / f64::from(across * around)
    }

    fn through(&self, cosine: f64) -> f64 {
        1.0 - self.color * self.albedo(cosine).min(1.0)
    }
}

/// A base of albedo `base` under `through`, of which the mean is taken by a quadrature.
fn base(base: f64, o: f64, i: f64, through: impl Fn(f64) -> f64) -> f64 {
    let at = |k: i32| (f64::from(k) + 0.5) / 128.0;
    let mean = (0..128).map(|k| through(at(k)) * 2.0 * at(k)).sum::<f64>() / 128.0;
    base / PI * through(o) * through(i) / mean
}

/// From the stripes towards a low sun on the camera's side: where a sheen is strongest.
const SUN: DVec3 = DVec3::new(0.3, 0.5, 1.0);

fn scene(descs: Vec<(u32, MaterialDesc)>, mut builder: SceneBuilder, light: Option<bool>) -> Scene {
    stripes::add(&mut builder, descs, false);
    if light == Some(true) {
        // Between the sun and all of the stripes.
        let glass = builder.material(MaterialDesc::thin("pane", 1.5));
        let [x, z] = [SUN.x, SUN.z].map(|part| 2.5 * part / SUN.y);
        let corner = |dx: f64, dz: f64| [x + 1.5 * dx, 2.5, z + 2.0 * dz];
        builder.quad("pane", [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)], glass);
    }
    if light.is_some() {
        builder.light("sun", LightDesc::Directional { direction: (-SUN).to_array(), irradiance: [2.0; 3] });
    } else {
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
    }
    builder.build().unwrap()
}

fn cloth(albedo: f64, color: f64, roughness: f64) -> MaterialDesc {
    MaterialDesc::lambert("cloth", [albedo; 3]).with_sheen([color; 3], roughness)
}

/// A sun on sheen: the BSDF by shadow rays, and by photons behind a pane, over a diffuse base, a plastic, a metal, and under a
/// clearcoat. A textured sheen looks like two materials.
pub fn sunlit_surfaces<T: TestBackend>() {
    let (o, i) = (VIEW.normalize_or_zero(), SUN.normalize_or_zero());
    let (strong, soft) = (Sheen::new(1.0, 0.5), Sheen::new(0.6, 0.8));
    let make = |pane: bool| {
        let mut builder = SceneBuilder::new();
        // Colours 1 and .6 (sRGB 203), roughnesses .5 and .8.
        let texels = [[255, 255, 255, 128], [203, 203, 203, 204]];
        let image = builder.texture(TextureDesc::srgb8("halves", 2, 1, &texels).filtered(Filter::Nearest));
        let image = TextureRef::new(image);
        let textures = TexturesDesc::default().with_sheen_color(image).with_sheen_roughness(image);
        let mut descs = vec![
            (2, cloth(0.5, 1.0, 1.0).with_textures(textures)),
            (1, cloth(0.5, 1.0, 128.0 / 255.0)),
            (1, cloth(0.5, SRGB_203, 0.8)),
            (1, cloth(0.0, 1.0, 0.5)),
            (1, MaterialDesc::plastic("plastic", [0.5; 3], 0.6).with_sheen([1.0; 3], 0.5)),
            (1, MaterialDesc::metal("metal", [0.0; 3], 0.6).with_sheen([0.6; 3], 0.8).with_clearcoat(1.0, 0.7)),
            (1, MaterialDesc::lambert("plain", [0.5; 3])),
        ];
        if pane {
            // Photons on bases beside each other have different factors: one base, whose edges are not looked at.
            descs.splice(0..4, [(5, cloth(0.5, 1.0, 0.5))]);
        }
        scene(descs, builder, Some(pane))
    };
    let shown = |f: f64| f * 2.0 * i.y;
    let alpha = 0.36;
    let h = (o + i).normalize_or_zero();
    let on_base =
        |sheen: &Sheen, albedo: f64| sheen.color * sheen.lobe(o, i) + base(albedo, o.y, i.y, |c| sheen.through(c));
    let coat = |c: f64| 1.0 - albedo(alpha, c, 0.04);
    let on_plastic = strong.lobe(o, i)
        + base(0.5, o.y, i.y, |c| coat(c) * strong.through(c))
        + schlick(0.04, o.dot(h)) * single(alpha, o, i) * strong.through(o.y).min(strong.through(i.y));
    let clear = |c: f64| 1.0 - albedo(0.49, c, 0.04);
    // The metal has F0 = 0 and F90 = 1.
    let on_metal = schlick(0.0, o.dot(h)) * single(alpha, o, i) * soft.through(o.y).min(soft.through(i.y));
    let varnished =
        (0.6 * soft.lobe(o, i) + on_metal) * clear(o.y).min(clear(i.y)) + schlick(0.04, o.dot(h)) * single(0.49, o, i);
    let textured = Sheen::new(SRGB_203, 0.8);
    let expected = [
        on_base(&Sheen::new(1.0, 128.0 / 255.0), 0.5),
        on_base(&textured, 0.5),
        on_base(&Sheen::new(1.0, 128.0 / 255.0), 0.5),
        on_base(&textured, 0.5),
        strong.lobe(o, i),
        on_plastic,
        varnished,
        0.5 / PI,
    ]
    .map(shown);
    let open_scene = make(false);
    assert!(Features::of(&open_scene.view()).contains(Features::SHEEN));
    let open = columns::<T>(&open_scene, &direct_settings(Direct::Nee, 0.1), 1).map(|values| values[0]);
    for (column, (found, expected)) in open.into_iter().zip(expected).enumerate() {
        assert_agrees(&format!("column {column}"), found, expected, 0.0, 5e-3 * expected);
    }
    // Far from the same without sheen.
    for (column, bare) in [(0, 0.5 / PI), (1, 0.5 / PI), (4, 0.0)] {
        assert!(!agrees(open[column], shown(bare), 0.0, 5e-3 * expected[column]), "{column}: {}", open[column]);
    }
    for (textured, even) in [(0, 2), (1, 3)] {
        assert!((open[textured] / open[even] - 1.0).abs() < 2e-3, "{open:?}");
    }

    // By photons that pass a pane: on the base, and for the sheen. What the sheen lets through to a reflection below is that
    // for the direction of view there.
    let behind = columns::<T>(&make(true), &direct_settings(Direct::Nee, 0.1), 24);
    let even = shown(on_base(&strong, 0.5));
    for (column, truth) in [(1, even), (2, even), (3, even)] {
        let (values, truth) = (&behind[column], through_a_pane(i.y) * truth);
        assert_agrees(&format!("pane, {column}"), moments(values).0, truth, standard_error(values), 1e-2 * truth);
    }
}

/// Linear value of the sRGB byte 203.
const SRGB_203: f64 = 0.597_201_788_3;

/// White surfaces under sheen show an even sky's radiance of 1: diffuse ones all of it, metals as much as the layer and the
/// narrower of both directions leave; never more.
pub fn white_furnace<T: TestBackend>() {
    let white = |roughness: f64| cloth(1.0, 1.0, roughness);
    let descs = vec![
        (1, white(0.3)),
        (1, white(1.0)),
        (1, cloth(1.0, 0.5, 0.6)),
        (1, MaterialDesc::plastic("plastic", [1.0; 3], 0.5).with_sheen([0.8; 3], 0.5)),
        (1, white(0.7).with_clearcoat(1.0, 0.4)),
        (1, MaterialDesc::metal("metal", [1.0; 3], 0.5).with_sheen([0.5; 3], 0.5)),
        (1, white(0.0)),
        (
            1,
            MaterialDesc::lambert("white", [1.0; 3]).with_diffuse_transmission(0.5, [1.0; 3]).with_sheen([1.0; 3], 0.5),
        ),
    ];
    let scene = scene(descs, SceneBuilder::new(), None);
    let settings = Settings { shadow_rays: 64, ..direct_settings(Direct::Nee, 0.1) };
    let found = columns::<T>(&scene, &settings, 64);
    for (column, values) in found.iter().enumerate() {
        let (mean, error) = (moments(values).0, standard_error(values));
        // Of a metal, what one direction loses more than the other.
        let least = if column == 5 { 0.85 } else { 1.0 };
        let allowed = 4.5 * error + 4e-3;
        assert!(mean > least - allowed && mean < 1.0 + allowed, "column {column}: {mean} ± {error}");
        assert!(error < 0.015, "column {column}: {error}");
    }
}

/// At grazing angles, where the albedo of narrow lobes exceeds 1: a white floor under an even sky shows at most 1, and at
/// least what the limit leaves.
pub fn furnace_at_grazing_angles<T: TestBackend>() {
    for (roughness, least) in [(0.1, 0.9), (0.2, 0.97), (0.5, 1.0), (1.0, 1.0)] {
        let mut builder = SceneBuilder::new();
        let white = builder.material(cloth(1.0, 1.0, roughness));
        builder.quad("floor", [[-9.0, 0.0, 9.0], [9.0, 0.0, 9.0], [9.0, 0.0, -9.0], [-9.0, 0.0, -9.0]], white);
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        // A cosine of .05.
        look_at_point(&mut builder, [0.0; 3], [0.998_749_217_8, 0.05, 0.0], 1.0, 0.01);
        let settings = Settings { shadow_rays: 16, ..direct_settings(Direct::Nee, 0.1) };
        let values = per_pass::<T>(&builder.build().unwrap(), &settings, 96, 8);
        let (mean, error) = (moments(&values).0, standard_error(&values));
        let allowed = 4.5 * error + 4e-3;
        assert!(mean > least - allowed && mean < 1.0 + allowed, "{roughness}: {mean} ± {error}");
        assert!(error < 0.025, "{roughness}: {error}");
    }
}

/// G5: in a closed room with e = 1 and ρ = ½, white surfaces under sheen change nothing: radiosity is 2 on the wall and on
/// them, with shadow rays, photons and final gathering. Photons that the sheen reflects are among those.
pub fn g5_closed_room<T: TestBackend>() {
    closed_room::assert_unchanged::<T>([(0.0, 0.7, cloth(1.0, 0.9, 0.6))], ([0.6, 0.8, 0.0], 0.3), 5e-3);
}

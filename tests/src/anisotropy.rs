//! Anisotropic reflection against quadratures in double precision.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use photon_core::glam::DVec3;
use photon_core::{Direct, EnvironmentMap, Filter};
use photon_scene::{
    LightDesc, MaterialDesc, Scene, SceneBuilder, Surface, TextureDesc, TextureRef, TexturesDesc, VertexAttributes,
};

use crate::clearcoat::columns;
use crate::gloss_caustics::through_a_pane;
use crate::gloss_reference::{albedo, schlick};
use crate::harness::{TestBackend, direct_settings};
use crate::stats::{agrees, assert_agrees, moments, standard_error};
use crate::stripes::{self, VIEW};

const SUN: DVec3 = DVec3::new(-0.2, 1.0, -0.3);
const ROUGHNESS: f64 = 0.4;

/// A metal, or a coat over a black base, in double precision: normal +y, wider along `tangent`.
struct Brushed {
    widths: [f64; 2],
    tangent: DVec3,
    is_metal: bool,
    color: f64,
}

impl Brushed {
    /// Direction: the angle from +x towards −z.
    fn new(strength: f64, angle: f64, is_metal: bool, color: f64) -> Self {
        let across = ROUGHNESS * ROUGHNESS;
        let along = across + (1.0 - across) * strength * strength;
        let tangent = DVec3::new(angle.cos(), 0.0, -angle.sin());
        Self { widths: [along, across], tangent, is_metal, color }
    }

    /// The albedo of single scattering by the equivalent width.
    fn equivalent(&self, cosine: f64) -> f64 {
        let [x, y] = self.widths;
        albedo((0.5 * (x * x + y * y)).sqrt(), cosine, if self.is_metal { 1.0 } else { 0.04 })
    }

    fn fresnel(&self, cosine: f64) -> f64 {
        schlick(if self.is_metal { self.color } else { 0.04 }, cosine)
    }

    /// Multiple scattering: Kulla and Conty 2017.
    fn multiple(&self, o: DVec3, i: DVec3) -> f64 {
        if !self.is_metal {
            return 0.0;
        }
        let at = |k: i32| (f64::from(k) + 0.5) / 32.0;
        let mean = (0..32).map(|k| self.equivalent(at(k)) * 2.0 * at(k)).sum::<f64>() / 32.0;
        let average = self.color + (1.0 - self.color) / 21.0;
        let repeated = average * average * mean / (1.0 - average * (1.0 - mean));
        repeated * (1.0 - self.equivalent(o.y)) * (1.0 - self.equivalent(i.y)) / (PI * (1.0 - mean))
    }

    /// In the frame of tangent, bitangent and normal.
    fn local(&self, w: DVec3) -> DVec3 {
        DVec3::new(w.dot(self.tangent), w.dot(DVec3::Y.cross(self.tangent)), w.y)
    }

    /// Of microfacet normals: Heitz 2014, section 5.4.
    fn density(&self, h: DVec3) -> f64 {
        let ([x, y], h) = (self.widths, self.local(h));
        1.0 / (PI * x * y * ((h.x / x).powi(2) + (h.y / y).powi(2) + h.z * h.z).powi(2))
    }

    /// `D G2 / (4 cos_o cos_i)`.
    fn single(&self, o: DVec3, i: DVec3) -> f64 {
        let lambda = |w: DVec3| {
            let ([x, y], w) = (self.widths, self.local(w));
            0.5 * ((1.0 + ((x * w.x).powi(2) + (y * w.y).powi(2)) / (w.z * w.z)).sqrt() - 1.0)
        };
        self.density((o + i).normalize_or_zero()) / (1.0 + lambda(o) + lambda(i)) / (4.0 * o.y * i.y)
    }

    fn f(&self, o: DVec3, i: DVec3) -> f64 {
        let h = (o + i).normalize_or_zero();
        self.fresnel(o.dot(h)) * self.single(o, i) + self.multiple(o, i)
    }

    /// ∫ single scattering cos dω over half vectors whose density is D cos.
    fn albedo(&self, o: DVec3) -> f64 {
        let n = 200;
        let part = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
        let bitangent = DVec3::Y.cross(self.tangent);
        let weight = |k: i32| {
            let (u, phi) = (part(k / n), TAU * part(k % n));
            let (radius, [x, y]) = ((u / (1.0 - u)).sqrt(), self.widths);
            let slope = self.tangent * (x * radius * phi.cos()) + bitangent * (y * radius * phi.sin());
            let h = (slope + DVec3::Y).normalize_or_zero();
            let across = o.dot(h);
            let i = h * (2.0 * across) - o;
            if across <= 0.0 || i.y <= 0.0 {
                return 0.0;
            }
            self.fresnel(across) * self.single(o, i) * i.y * 4.0 * across / (self.density(h) * h.y)
        };
        (0..n * n).map(weight).sum::<f64>() / f64::from(n * n)
    }
}

fn surface(is_metal: bool, color: f64) -> MaterialDesc {
    let (base_color, metallic, roughness) = ([color; 3], f64::from(u8::from(is_metal)), ROUGHNESS);
    MaterialDesc::new("plate", Surface::Glossy { base_color, metallic, roughness, specular: 1.0, ior: 1.5 })
}

/// Texture coordinates: along x, and downwards along +z; or mirrored. A given tangent: [`GIVEN`].
#[derive(Clone, Copy, PartialEq)]
enum Frame {
    Plain,
    Mirrored,
    Tangents,
}

const GIVEN: [f64; 4] = [0.6, 0.0, 0.8, 1.0];

impl Frame {
    fn attributes(self) -> VertexAttributes {
        let (near, far) = if self == Self::Mirrored { (0.0, 1.0) } else { (1.0, 0.0) };
        let uvs = vec![[0.0, near], [1.0, near], [1.0, far], [0.0, far]];
        let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
        if self == Self::Tangents { attributes.with_tangents(vec![GIVEN; 4]) } else { attributes }
    }
}

/// White surfaces in an even sky show its radiance of 1, but for the difference of their albedo and that of the equivalent
/// roughness: here within 10 %.
fn check_furnace<T: TestBackend>() {
    let all = [(true, 0.8, 0.0), (true, 0.8, FRAC_PI_2), (true, 1.0, 0.0), (false, 0.8, FRAC_PI_2)];
    let descs = all.map(|(is_metal, strength, angle)| {
        (2, surface(is_metal, 1.0).with_anisotropy(strength, angle), Frame::Plain.attributes())
    });
    let mut builder = SceneBuilder::new();
    stripes::add_with(&mut builder, descs, false);
    builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
    let found = columns::<T>(&builder.build().unwrap(), &direct_settings(Direct::Nee, 0.1), 16);
    let o = VIEW.normalize_or_zero();
    for (index, (is_metal, strength, angle)) in all.into_iter().enumerate() {
        let brushed = Brushed::new(strength, angle, is_metal, 1.0);
        let expected = 1.0 + brushed.albedo(o) - brushed.equivalent(o.y);
        assert!((expected - 1.0).abs() < 0.1, "plate {index}: {expected}");
        let values: Vec<f64> = found[2 * index].iter().zip(&found[2 * index + 1]).map(|(a, b)| 0.5 * (a + b)).collect();
        let what = format!("plate {index} in a furnace");
        assert_agrees(&what, moments(&values).0, expected, standard_error(&values), 4e-3);
    }
}

/// Brushed plates: in a furnace, and in a sun, whose light is found by shadow rays, or where a pane prevents that, by
/// photons. Directions are from texture coordinates, tangents and a texture.
pub fn brushed_plates<T: TestBackend>() {
    check_furnace::<T>();
    let (o, i) = (VIEW.normalize_or_zero(), SUN.normalize_or_zero());
    // Opposite sides of the tangent; of full and of 60 % strength.
    let texels = [[230, 51, 255, 255], [204, 240, 153, 255]];
    let make = |pane: bool| -> Scene {
        let mut builder = SceneBuilder::new();
        let image = builder.texture(TextureDesc::linear8("brushed", 2, 1, &texels).filtered(Filter::Nearest));
        let textures = TexturesDesc::default().with_anisotropy(TextureRef::new(image));
        let metal = |angle: f64| surface(true, 0.7).with_anisotropy(0.8, angle);
        let descs = vec![
            (1, metal(0.0), Frame::Plain),
            (1, metal(FRAC_PI_2), Frame::Plain),
            (1, metal(0.6), Frame::Plain),
            (1, metal(0.6), Frame::Mirrored),
            (1, metal(0.0), Frame::Tangents),
            (1, surface(false, 0.0).with_anisotropy(0.8, 0.6), Frame::Plain),
            (2, metal(0.2).with_textures(textures), Frame::Plain),
        ];
        let descs = descs.into_iter().map(|(columns, desc, frame)| (columns, desc, frame.attributes()));
        stripes::add_with(&mut builder, descs, pane);
        builder.light("sun", LightDesc::Directional { direction: (-SUN).to_array(), irradiance: [2.0; 3] });
        builder.build().unwrap()
    };
    let textured = texels.map(|[r, g, b, _]| {
        let [x, y] = [r, g].map(|byte: u8| 2.0 * f64::from(byte) / 255.0 - 1.0);
        (0.8 * f64::from(b) / 255.0, 0.2 + y.atan2(x), true, 0.7)
    });
    let given = f64::atan2(-GIVEN[2], GIVEN[0]);
    let metal = |angle: f64| (0.8, angle, true, 0.7);
    let all = [metal(0.0), metal(FRAC_PI_2), metal(0.6), metal(-0.6), metal(given), (0.8, 0.6, false, 0.0)];
    let of = |(strength, angle, is_metal, color)| Brushed::new(strength, angle, is_metal, color).f(o, i) * 2.0 * i.y;
    let expected: Vec<f64> = all.into_iter().chain(textured).map(of).collect();
    let open = columns::<T>(&make(false), &direct_settings(Direct::Nee, 0.1), 1).map(|values| values[0]);
    for (column, (&found, &expected)) in open.iter().zip(&expected).enumerate() {
        assert_agrees(&format!("plate {column}"), found, expected, 0.0, 4e-3 * expected);
    }
    // Other directions and strengths do not agree.
    for (column, other) in [(0, 1), (1, 0), (2, 3), (3, 2), (4, 0), (6, 7), (7, 6)] {
        assert!(!agrees(open[column], expected[other], 0.0, 4e-2 * expected[other]), "{column} {other}: {open:?}");
    }
    let behind = columns::<T>(&make(true), &direct_settings(Direct::Nee, 0.1), 16);
    for (column, (values, expected)) in behind.iter().zip(&expected).enumerate() {
        let truth = through_a_pane(i.y) * expected;
        let what = format!("plate {column} behind a pane");
        assert_agrees(&what, moments(values).0, truth, standard_error(values), 6e-3 * truth);
    }
}

//! Diffuse transmission of sheets against closed forms.

use std::f64::consts::PI;

use photon_core::glam::DVec3;
use photon_core::{Direct, Features, Filter, MapKind};
use photon_scene::{
    LightDesc, MaterialDesc, Scene, SceneBuilder, TextureDesc, TextureRef, TexturesDesc, VertexAttributes,
};

use crate::alpha::{FAINT, sheet};
use crate::clearcoat::columns;
use crate::closed_room;
use crate::gloss_caustics::through_a_pane;
use crate::gloss_reference::albedo;
use crate::harness::{TestBackend, direct_settings, trace};
use crate::stats::{agrees, assert_agrees, moments, standard_error};
use crate::stripes::{self, VIEW};

/// From the stripes towards a sun below them.
const BELOW: DVec3 = DVec3::new(0.3, -1.0, -0.2);

/// A vertex normal on the upper side, tilted by 20 degrees.
const TILTED: DVec3 = DVec3::new(-0.342_020_143, 0.939_692_621, 0.0);

fn leaf(albedo: f64, share: f64, color: f64) -> MaterialDesc {
    MaterialDesc::lambert("leaf", [albedo; 3]).with_diffuse_transmission(share, [color; 3])
}

/// `(1 − S_o)(1 − S_i) / (1 − S̄)` of layers with these albedos, which multiply `1 − S`.
fn coats(o: f64, i: f64, through: impl Fn(f64) -> f64) -> f64 {
    let at = |k: i32| (f64::from(k) + 0.5) / 64.0;
    let mean = (0..64).map(|k| through(at(k)) * 2.0 * at(k)).sum::<f64>() / 64.0;
    through(o) * through(i) / mean
}

/// Sheets in a sun that is below them, seen from above: `f τ/π` times the irradiance on the other side, by shadow rays,
/// by photons, and as a caustic behind a pane. Coats, textures, vertex normals; nothing without transmission.
pub fn sunlit_from_behind<T: TestBackend>() {
    let (o, i) = (VIEW.normalize_or_zero().y, BELOW.normalize_or_zero());
    let make = |direct: bool| -> Scene {
        let mut builder = SceneBuilder::new();
        // Shares 1 and .4 in alpha, colours 1 and .2 of sRGB bytes 255 and 124.
        let texels = [[255, 255, 255, 102], [124, 124, 124, 255]];
        let image = builder.texture(TextureDesc::srgb8("halves", 2, 1, &texels).filtered(Filter::Nearest));
        let image = TextureRef::new(image);
        let textures = TexturesDesc::default().with_diffuse_transmission(image).with_diffuse_transmission_color(image);
        let uvs = vec![[0.0, 0.5], [1.0, 0.5], [1.0, 0.5], [0.0, 0.5]];
        let plain = VertexAttributes::default().with_uvs(vec![uvs]);
        let tilted = VertexAttributes::default().with_normals(vec![TILTED.to_array(); 4]);
        let descs = vec![
            (1, leaf(0.0, 1.0, 0.6), plain.clone()),
            (1, leaf(0.8, 0.4, 0.5), plain.clone()),
            (1, leaf(0.8, 0.0, 0.5), plain.clone()),
            (1, MaterialDesc::plastic("coated", [0.9; 3], 0.5).with_diffuse_transmission(0.5, [0.8; 3]), plain.clone()),
            (1, leaf(0.8, 0.4, 0.5).with_clearcoat(1.0, 0.5), plain.clone()),
            (2, leaf(0.3, 1.0, 0.9).with_textures(textures), plain),
            (1, leaf(0.8, 0.4, 0.5), tilted),
        ];
        stripes::add_with(&mut builder, descs, false);
        if !direct {
            let glass = builder.material(MaterialDesc::thin("pane", 1.5));
            builder.quad("pane", [[-3.0, -2.5, 3.0], [3.0, -2.5, 3.0], [3.0, -2.5, -3.0], [-3.0, -2.5, -3.0]], glass);
        }
        builder.light("sun", LightDesc::Directional { direction: (-BELOW).to_array(), irradiance: [PI; 3] });
        builder.build().unwrap()
    };
    let open = make(true);
    assert!(Features::of(&open.view()).contains(Features::DIFFUSE_TRANSMISSION));
    let coat = |f0: f64| coats(o, -i.y, |cosine| 1.0 - albedo(0.25, cosine, f0));
    let dark = ((124.0_f64 / 255.0 + 0.055) / 1.055).powf(2.4);
    let even = -i.y;
    let expected = [
        0.6 * even,
        0.4 * 0.5 * even,
        0.0,
        0.5 * 0.8 * even * coat(0.04),
        0.4 * 0.5 * even * coat(0.04),
        0.4 * 0.9 * even,
        0.9 * dark * even,
        0.4 * 0.5 * -i.dot(TILTED),
    ];
    // A coat of α = .25 at these angles is far from none.
    assert!((coat(0.04) - 1.0).abs() > 0.01, "{}", coat(0.04));
    for (direct, passes) in [(Direct::Nee, 1), (Direct::Photons, 16)] {
        let found = columns::<T>(&open, &direct_settings(direct, 0.08), passes);
        for (column, (values, truth)) in found.iter().zip(expected).enumerate() {
            // By photons, edges to stripes with other coats are blurred: these are of one factor within 3 %.
            let (error, bound) = if passes == 1 { (0.0, 4e-3) } else { (standard_error(values), 2e-2) };
            let mean = values.iter().sum::<f64>() / f64::from(passes);
            assert_agrees(&format!("{direct:?} {column}"), mean, truth, error, bound * truth);
            assert!(
                truth == 0.0 || passes > 1 || !agrees(mean, truth * 0.97, error, bound * truth),
                "{column}: {mean}"
            );
        }
    }
    let behind = columns::<T>(&make(false), &direct_settings(Direct::Nee, 0.08), 16);
    for (column, (values, expected)) in behind.iter().zip(expected).enumerate() {
        let truth = through_a_pane(-i.y) * expected;
        assert_agrees(&format!("pane, {column}"), moments(values).0, truth, standard_error(values), 2e-2 * truth);
    }
}

/// Sheets that absorb nothing show the radiance 1 of an even environment, also behind panes, where paths no longer split.
pub fn white_furnace<T: TestBackend>() {
    let make = |panes: bool| {
        let builder = SceneBuilder::new();
        let white = |share: f64| leaf(1.0, share, 1.0);
        let coated = MaterialDesc::plastic("coated", [1.0; 3], 0.4).with_diffuse_transmission(0.5, [1.0; 3]);
        let descs = vec![
            (1, white(0.3)),
            (1, white(1.0)),
            (1, white(0.5).with_clearcoat(1.0, 0.3)),
            (2, coated.clone()),
            (2, coated.with_clearcoat(0.7, 0.2)),
            (1, leaf(0.0, 0.25, 1.0)),
        ];
        stripes::in_even_light(builder, descs, panes)
    };
    for panes in [false, true] {
        let found = columns::<T>(&make(panes), &direct_settings(Direct::Nee, 0.1), 32);
        // Panes reflect the environment, so that what is not white is not dark there.
        for (column, values) in found.iter().enumerate().filter(|&(column, _)| column < 7 || !panes) {
            let truth = if column == 7 { 0.25 } else { 1.0 };
            let least = if (5..7).contains(&column) { 1e-2 } else { 3e-3 };
            let what = format!("column {column}, panes: {panes}");
            assert_agrees(&what, moments(values).0, truth, standard_error(values), least * truth);
        }
    }
}

/// G5: in a closed room with e = 1 and ρ = ½, sheets that absorb nothing change nothing: radiosity is 2 on the wall and on
/// the sheets, with shadow rays, photons and final gathering.
pub fn g5_closed_room<T: TestBackend>() {
    let coated = MaterialDesc::plastic("coated", [1.0; 3], 0.5).with_diffuse_transmission(0.4, [1.0; 3]);
    let squares = [(0.0, 0.7, leaf(1.0, 0.5, 1.0)), (0.4, 0.6, leaf(0.3, 1.0, 1.0)), (-0.4, 0.6, coated)];
    closed_room::assert_unchanged::<T>(squares, ([0.0, 1.0, 0.0], 0.3), 0.0);
}

/// The share of parallel light that passes a sheet, by the photons on a floor just below it, and the share that leaves by
/// the photons on a ceiling just above.
pub fn photons_leave_on_both_sides<T: TestBackend>() {
    let (share, albedo, color) = (0.6, 0.5, 0.75);
    let mut builder = SceneBuilder::new();
    sheet(&mut builder, 0.0, leaf(albedo, share, color));
    for y in [-1e-3, 1e-3] {
        sheet(&mut builder, y, MaterialDesc::lambert("black", [FAINT; 3]));
    }
    // A light between the sheet and the floor: half of it arrives there first.
    builder.light("point", LightDesc::Point { position: [0.0, -5e-4, 0.0], intensity: [1.0; 3] });
    let scene = builder.build().unwrap();
    let (photons, tally) = trace::<T>(2, &scene, &direct_settings(Direct::Photons, 0.1), &[40_000]);
    let count = |kind: MapKind, least: f32, most: f32| -> f64 {
        let here = photons[kind].iter().filter(|photon| (least..most).contains(&photon.position[1]));
        here.map(|photon| f64::from(photon.power[0])).sum()
    };
    let scale = scene.units().scale;
    let middle = (5e-4 / scale) as f32;
    let offset = -(scene.units().center[1] / scale) as f32;
    let arrives = count(MapKind::Direct, offset - middle, offset + middle);
    // Of the light that arrives from below, the transmitted part meets the upper sheet, and the reflected part the lower.
    let (above, below) = (
        count(MapKind::Global, offset + middle, f32::INFINITY) / arrives,
        count(MapKind::Global, f32::NEG_INFINITY, offset - middle) / arrives,
    );
    let error = |p: f64| (p * (1.0 - p) / (0.5 * 40_000.0)).sqrt();
    let (through, back) = (share * color, (1.0 - share) * albedo);
    assert_agrees("transmitted", above, through, error(through), 2e-3);
    assert_agrees("reflected", below, back, error(back), 2e-3);
    assert_eq!(tally.emitted, 40_000);
}

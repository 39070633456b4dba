//! Alpha coverage: what sheets that are there with a probability, and masks, let through.

use std::f64::consts::PI;

use photon_core::{Direct, Features, Film, Filter, Settings};
use photon_scene::{
    AlphaMode, CameraDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, TextureDesc, TextureRef, TexturesDesc,
    VertexAttributes,
};

use crate::harness::{InFull, TestBackend, direct_settings, film, per_pass, trace};
use crate::stats::{agrees, assert_agrees, moments, standard_error};

/// An albedo that is not seen, of surfaces that must not be black: pictures of black surfaces alone are refused.
pub(crate) const FAINT: f64 = 1e-9;

pub(crate) fn direct_light(direct: Direct) -> Settings {
    direct_settings(direct, 0.05)
}

/// A square of half side 2 at height `y`, facing up; texture coordinates run from 0 to 4 across it.
pub(crate) fn sheet(builder: &mut SceneBuilder, y: f64, material: MaterialDesc) {
    let material = builder.material(material);
    let positions = vec![[-2.0, y, -2.0], [2.0, y, -2.0], [2.0, y, 2.0], [-2.0, y, 2.0]];
    let uvs = positions.iter().map(|p: &[f64; 3]| [p[0] + 2.0, p[2] + 2.0]).collect();
    let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
    builder.mesh_with("sheet", positions, vec![[0, 2, 1], [0, 3, 2]], attributes, material);
}

/// A camera at height `y` that looks down at a square of half side `half` about the origin.
pub(crate) fn look_down(builder: &mut SceneBuilder, y: f64, half_height: f64) {
    let projection = Projection::Orthographic { half_height };
    builder.camera("above", CameraDesc::new([0.0, y, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0], projection));
}

pub(crate) fn sun(builder: &mut SceneBuilder) {
    builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [PI; 3] });
}

fn black(alpha: f64) -> MaterialDesc {
    MaterialDesc::lambert("sheet", [0.0; 3]).with_alpha(AlphaMode::Blend, alpha)
}

/// A chessboard of 8 squares per unit: half of it is there.
pub(crate) fn chequered(builder: &mut SceneBuilder, material: MaterialDesc, mode: AlphaMode) -> MaterialDesc {
    let texels: Vec<[u8; 4]> = (0..64).map(|i| [255, 255, 255, if (i / 8 + i) % 2 == 0 { 255 } else { 0 }]).collect();
    let image = builder.texture(TextureDesc::srgb8("board", 8, 8, &texels).filtered(Filter::Nearest));
    let textures = TexturesDesc::default().with_alpha(TextureRef::new(image));
    material.with_textures(textures).with_alpha(mode, 1.0)
}

pub(crate) fn mean_red(film: &Film) -> f64 {
    let beauty = film.beauty();
    beauty.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / beauty.len() as f64
}

/// The light that arrives below `sheets`, as a share of what there is without them: of a sun by shadow rays and by
/// photons, seen from below them; and of a glowing floor that is seen through them.
fn check_transmitted<T: TestBackend>(what: &str, truth: f64, passes: u32, sheets: impl Fn(&mut SceneBuilder)) {
    let size = 8;
    // Independent rays that arrive or not: √(p(1 − p)/N).
    let count = f64::from(passes * size * size);
    let error = (truth * (1.0 - truth) / count).sqrt().max(1.0 / count);
    for direct in [Direct::Nee, Direct::Photons] {
        let mut builder = SceneBuilder::new();
        sheets(&mut builder);
        sheet(&mut builder, 0.0, MaterialDesc::lambert("floor", [1.0; 3]));
        sun(&mut builder);
        look_down(&mut builder, 0.05, 0.5);
        let scene = builder.build().unwrap();
        assert!(Features::of(&scene.view()).contains(Features::ALPHA));
        if direct == Direct::Nee {
            let found = mean_red(&film::<T>(&scene, &direct_light(direct), passes, size));
            assert_agrees(&format!("{what}, shadow rays"), found, truth, error, 1e-6);
            assert!(!agrees(found, 0.95 * truth - 0.1 * (1.0 - truth), error, 1e-6), "{what}: the error is too large");
        } else {
            let settings = Settings { photons: 400 * passes, ..direct_light(direct) };
            let values = per_pass::<InFull<T>>(&scene, &settings, 16, 4);
            assert_agrees(&format!("{what}, photons"), moments(&values).0, truth, standard_error(&values), 1e-6);
        }
    }
    let mut builder = SceneBuilder::new();
    sheets(&mut builder);
    sheet(&mut builder, 0.0, MaterialDesc::emissive("floor", [FAINT; 3], [1.0; 3]));
    look_down(&mut builder, 1.0, 0.5);
    let found = mean_red(&film::<T>(&builder.build().unwrap(), &direct_light(Direct::Nee), passes, size));
    assert_agrees(&format!("{what}, camera"), found, truth, error, 1e-6);
}

/// G12: n sheets of alpha a transmit (1 − a)ⁿ.
pub fn g12_sheets_transmit<T: TestBackend>() {
    for (alpha, count) in [(0.3, 5), (0.5, 1)] {
        let truth = (1.0_f64 - alpha).powi(count);
        check_transmitted::<T>(&format!("{count} of {alpha}"), truth, 32, |builder| {
            (0..count).for_each(|i| sheet(builder, 0.1 + 0.1 * f64::from(i), black(alpha)));
        });
    }
}

/// G12: a chequered mask transmits one half, and a sheet whose probability is 0 or 1 in the same squares too. The mean is
/// over whole squares, so that the noise is at most that of independent rays.
pub fn g12_masks_transmit<T: TestBackend>() {
    for mode in [AlphaMode::Mask { cutoff: 0.5 }, AlphaMode::Blend] {
        check_transmitted::<T>(&format!("{mode:?}"), 0.5, 32, |builder| {
            let material = chequered(builder, MaterialDesc::lambert("sheet", [0.0; 3]), mode);
            sheet(builder, 0.1, material);
        });
    }
    // Vertex colours count too: from 0 at the left edge to 1 at the right one.
    check_transmitted::<T>("vertex colours", 0.5, 32, |builder| {
        let material = builder.material(black(1.0));
        let positions = vec![[-2.0, 0.1, -2.0], [2.0, 0.1, -2.0], [2.0, 0.1, 2.0], [-2.0, 0.1, 2.0]];
        let colors = positions.iter().map(|p: &[f64; 3]| [1.0, 1.0, 1.0, 0.25 * p[0] + 0.5]).collect();
        let attributes = VertexAttributes::default().with_colors(colors);
        builder.mesh_with("sheet", positions, vec![[0, 2, 1], [0, 3, 2]], attributes, material);
    });
}

/// V15: 1000 sheets at the same place, of the smallest and the largest alpha that a byte can have short of 0 and 1.
pub fn v15_a_thousand_sheets<T: TestBackend>() {
    let alpha = 1.0 / 255.0;
    check_transmitted::<T>("1000 thin sheets", (1.0_f64 - alpha).powi(1000), 8, |builder| {
        (0..1000).for_each(|_| sheet(builder, 0.1, black(alpha)));
    });
    let mut builder = SceneBuilder::new();
    (0..1000).for_each(|_| sheet(&mut builder, 0.1, black(254.0 / 255.0)));
    sheet(&mut builder, 0.0, MaterialDesc::lambert("floor", [1.0; 3]));
    sun(&mut builder);
    look_down(&mut builder, 0.05, 0.5);
    let scene = builder.build().unwrap();
    for direct in [Direct::Nee, Direct::Photons] {
        let settings = Settings { photons: 1000, ..direct_light(direct) };
        assert_eq!(mean_red(&film::<T>(&scene, &settings, 2, 8)), 0.0, "{direct:?}");
    }
    let (_, tally) = trace::<T>(2, &scene, &direct_light(Direct::Photons), &[1000]);
    assert!(tally.balances() && tally.emitted == 1000, "{tally:?}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use photon_core::{Hit, Ray, RayCaster};
    use photon_scene::Accel;

    /// A caller's own caster, which only finds the nearest hit.
    struct Foreign(Accel);

    impl RayCaster for Foreign {
        fn nearest(&self, ray: &Ray) -> Option<Hit> {
            self.0.nearest(ray)
        }
    }

    struct OnForeign;

    impl TestBackend for OnForeign {
        type On = backend_cpu::Cpu;

        fn make(threads: usize) -> backend_cpu::Cpu {
            backend_cpu::Cpu::with_threads(threads)
                .unwrap()
                .with_caster(|view| Ok(Box::new(Foreign(Accel::build(view.positions, view.triangles).unwrap()))))
        }
    }

    /// G12 with a caller's own caster.
    #[test]
    fn own_casters_need_nothing_more() {
        g12_sheets_transmit::<OnForeign>();
        g12_masks_transmit::<OnForeign>();
    }

    /// Beyond the limit of skipped surfaces photons end, and are counted; shadow rays count as occluded.
    #[test]
    fn the_limit_of_own_casters_is_counted() {
        let mut builder = SceneBuilder::new();
        // Each pair is hit once or twice: 100 are beyond the limit of 64 either way.
        (0..100).for_each(|i| sheet(&mut builder, 0.1 + 1e-3 * f64::from(i), black(1e-6)));
        sheet(&mut builder, 0.0, MaterialDesc::lambert("floor", [1.0; 3]));
        sun(&mut builder);
        look_down(&mut builder, 0.05, 0.5);
        let scene = builder.build().unwrap();
        let (_, tally) = trace::<OnForeign>(2, &scene, &direct_light(Direct::Photons), &[1000]);
        assert!(tally.balances() && tally.truncated > 500, "{tally:?}");
        assert_eq!(mean_red(&film::<OnForeign>(&scene, &direct_light(Direct::Nee), 1, 4)), 0.0);
        let (_, tally) = trace::<crate::backends::OnCpu>(2, &scene, &direct_light(Direct::Photons), &[1000]);
        assert!(tally.balances() && tally.truncated == 0, "{tally:?}");
    }
}

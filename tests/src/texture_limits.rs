//! G8 under an even sky, and V11: textures with extreme transforms.

use photon_core::{Direct, EnvironmentMap, Film, Filter, Settings};
use photon_scene::{
    CameraDesc, MaterialDesc, Projection, Scene, SceneBuilder, TextureDesc, TextureRef, TexturesDesc, VertexAttributes,
};

use crate::harness::{TestBackend, direct_settings, film};
use crate::stats::{agrees, assert_agrees, moments, standard_error};

const GREYS: [u8; 16] = [20, 64, 128, 255, 255, 40, 200, 30, 90, 180, 45, 220, 50, 250, 125, 60];

/// A floor with 4 × 4 texels, each of which one pixel of the camera shows, under an even sky of radiance 1.
fn floor(filter: Filter, transform: [[f64; 3]; 2]) -> Scene {
    let mut builder = SceneBuilder::new();
    let texels: Vec<[u8; 4]> = GREYS.iter().map(|&grey| [grey, grey, grey, 255]).collect();
    let image = builder.texture(TextureDesc::linear8("checks", 4, 4, &texels).filtered(filter));
    let textures = TexturesDesc::default().with_base_color(TextureRef::new(image).with_transform(transform));
    let material = builder.material(MaterialDesc::lambert("floor", [1.0; 3]).with_textures(textures));
    let positions = vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
    let uvs = positions.iter().map(|p: &[f64; 3]| [0.5 * p[0] + 0.5, 0.5 * p[2] + 0.5]).collect();
    let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
    builder.mesh_with("floor", positions, vec![[0, 2, 1], [0, 3, 2]], attributes, material);
    let projection = Projection::Orthographic { half_height: 1.0 };
    builder.camera("above", CameraDesc::new([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0], projection));
    builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
    builder.build().unwrap()
}

const PLAIN: [[f64; 3]; 2] = TextureRef::IDENTITY;

fn texel(x: i64, y: i64) -> f64 {
    f64::from(GREYS[(4 * y.rem_euclid(4) + x.rem_euclid(4)) as usize]) / 255.0
}

/// G8: under an even sky of radiance 1 each pixel shows the mean of the texture there: a texel, or with the linear filter
/// `(1, 6, 1)/8` of it and its neighbours in each direction.
pub fn g8_textured_floor_under_an_even_sky<T: TestBackend>() {
    for (filter, direct) in [(Filter::Linear, Direct::Nee), (Filter::Nearest, Direct::Photons)] {
        let settings = Settings { errors: true, photons: 4000, ..direct_settings(direct, 0.1) };
        let film = film::<T>(&floor(filter, PLAIN), &settings, 128, 4);
        // Its standard errors are those of independent passes.
        for (pixel, interval) in film.confidence_intervals().unwrap().iter().enumerate() {
            let (x, y) = ((pixel % 4) as i64, (pixel / 4) as i64);
            let weights = if filter == Filter::Nearest { [0.0, 1.0, 0.0] } else { [0.125, 0.75, 0.125] };
            let truth: f64 = (0..9_usize)
                .map(|k| weights[k % 3] * weights[k / 3] * texel(x + (k % 3) as i64 - 1, y + (k / 3) as i64 - 1))
                .sum();
            // Discs beside the edge of the floor reach beyond it.
            if direct == Direct::Nee || ((1..3).contains(&x) && (1..3).contains(&y)) {
                let what = format!("{filter:?} {direct:?} {pixel}");
                let (found, error) = (interval.value, interval.standard_error);
                assert_agrees(&what, found, truth, error, 1e-4);
                assert!(!agrees(found, 1.5 * truth, error, 1e-4), "{what}: {error}");
            }
        }
    }
}

fn red(film: &Film) -> Vec<f64> {
    film.beauty().iter().map(|pixel| f64::from(pixel[0])).collect()
}

/// V11: scales of 0, ±10⁹, 10⁻⁹ and 10³⁰ and offsets to 10³⁰ give pictures without a pixel that is black, not finite or
/// brighter than noise makes a white one; a scale of 0 shows the texel of the offset. Rotations are those of files (`load/gltf/slot.rs`).
pub fn v11_extreme_transforms<T: TestBackend>() {
    let settings = direct_settings(Direct::Nee, 0.1);
    let seen = |transform, passes| red(&film::<T>(&floor(Filter::Nearest, transform), &settings, passes, 4));
    for (scale, offset) in [(0.0, 1e9 + 0.5), (1e9, 0.0), (-1e9, 1e9 + 0.5), (1e-9, -1e30), (1e30, -1e30)] {
        let picture = seen([[scale, 0.0, offset], [0.0, scale, offset]], 8);
        // Single pixels of a few passes of an even sky are noisy.
        let most = picture.iter().fold(0.0_f64, |most, &value| most.max(value));
        assert!(picture.iter().all(|value| value.is_finite() && *value > 0.0) && most < 4.0, "{scale:e} {offset:e}");
    }
    // The texel at (¾, ¼) of the image, everywhere.
    let still = seen([[0.0, 0.0, 1e6 + 0.8], [0.0, 0.0, 0.3]], 64);
    let (found, truth) = (moments(&still).0, texel(3, 1));
    assert_agrees("a scale of 0", found, truth, standard_error(&still), 1e-4);
}

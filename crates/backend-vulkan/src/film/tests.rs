//! The film compared with sums in f64.

use photon_core::random::{philox4x32, unit_f32};
use photon_core::{Backend, Display, DisplayImage, Error, Estimate, Film, FilmBackend, Layer, Query, ToneMap, Units};

use super::{FIRST_HITS, VulkanFilm, abandon_pass, accumulate, accumulate_values, end_pass, read};
use crate::Vulkan;

const WIDTH: u32 = 19;
const HEIGHT: u32 = 7;

/// Up to three queries per pixel, none for some, in pixel order; weights are 1.
fn queries() -> Vec<Query> {
    let pixels = (0..WIDTH * HEIGHT).flat_map(|pixel| std::iter::repeat_n(pixel, (pixel % 4) as usize));
    pixels.map(|pixel| Query { pixel, throughput: [1.0; 3], radius: 1.0, ..Query::default() }).collect()
}

/// Positive numbers over six orders of magnitude.
fn number(counter: [u32; 4]) -> [f32; 3] {
    let [a, b, c, exponent] = philox4x32(counter, [7, 7]);
    [a, b, c].map(|word| (unit_f32(word) + 0.1) * 10.0_f32.powi((exponent % 7) as i32 - 3))
}

/// Largest error relative to the sum.
fn worst(film: &Film, layer: Layer, expected: &[[f64; 3]]) -> f64 {
    let mut worst = 0.0_f64;
    for (pixel, expected) in film.pixels.iter().zip(expected) {
        for (sum, &truth) in pixel.layers[layer as usize].iter().zip(expected) {
            let error = (sum - truth).abs();
            worst = worst.max(if truth > 0.0 { error / truth } else { error });
        }
    }
    worst
}

/// Thousands of passes of known values. An addition loses up to 2⁻⁴⁸ of the sum; 3000 random rounding errors
/// add up to some 55 times as much, which is 2⁻⁴². Sums in f32 are less precise.
#[test]
fn sums_over_passes_lose_nothing() {
    const PASSES: u32 = 3000;
    let Some(mut on) = Vulkan::for_tests() else { return };
    let queries = queries();
    let there = on.upload("queries", &queries).unwrap();
    let mut film = VulkanFilm::new(&mut on, WIDTH, HEIGHT, Units::default()).unwrap();
    let pixels = (WIDTH * HEIGHT) as usize;
    let (mut sums, mut squares) = (vec![[0.0_f64; 3]; pixels], vec![0.0_f64; pixels]);
    let mut coarse = vec![[0.0_f32; 3]; pixels];
    for pass in 0..PASSES {
        let values: Vec<[f32; 3]> = (0..queries.len() as u32).map(|i| number([i, pass, 0, 0])).collect();
        film.values_address(&mut on, there.capacity()).unwrap();
        on.write(film.values.as_ref().unwrap(), 0, bytemuck::cast_slice(&values)).unwrap();
        let direct = film.layer_address(&mut on, Layer::Direct).unwrap();
        accumulate_values(&mut on, &mut film, direct, &there, 1).unwrap();
        end_pass(&mut on, &mut film).unwrap();
        // Within a pass, f32 in order of the queries, as the device does.
        let mut pass = vec![[0.0_f32; 3]; pixels];
        for (query, value) in queries.iter().zip(values) {
            for c in 0..3 {
                pass[query.pixel as usize][c] += value[c];
            }
        }
        for (i, pass) in pass.iter().enumerate() {
            for c in 0..3 {
                sums[i][c] += f64::from(pass[c]);
                coarse[i][c] += pass[c];
            }
            squares[i] += (pass.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0).powi(2);
        }
    }
    let picture = read(&mut on, &film).unwrap();
    assert_eq!(picture.passes, PASSES);
    let error = worst(&picture, Layer::Direct, &sums);
    assert!(error < 2.0_f64.powi(-42), "{error:e}");
    for (pixel, &square) in picture.pixels.iter().zip(&squares) {
        assert!((pixel.square - square).abs() <= square * 2.0_f64.powi(-40), "{} {square}", pixel.square);
    }
    // Lower precision is detected.
    let coarse: Vec<[f64; 3]> = coarse.iter().map(|sum| sum.map(f64::from)).collect();
    assert!(worst(&picture, Layer::Direct, &coarse) > 2.0_f64.powi(-30));
    // A layer that was never written is not allocated.
    assert!(film.layers[Layer::Caustic as usize].is_none());
}

/// Estimates are accumulated as irradiance times weight, and an abandoned pass leaves no trace.
#[test]
fn estimates_fold_and_abandoned_passes_vanish() {
    const PATHS: u64 = 12_345;
    let Some(mut on) = Vulkan::for_tests() else { return };
    let mut queries = queries();
    for (i, query) in queries.iter_mut().enumerate() {
        query.throughput = number([i as u32, 1, 1, 1]);
    }
    let mut estimates: Vec<Estimate> = (0..queries.len() as u32)
        .map(|i| Estimate {
            flux: number([i, 2, 2, 2]),
            radius_squared: number([i, 3, 3, 3])[0] * 1e-4,
            photons: i % 5,
            ..Estimate::default()
        })
        .collect();
    // An estimate without photons counts as 0, whatever else the record contains.
    estimates[3].photons = 0;
    let (there, found) = (on.upload("queries", &queries).unwrap(), on.upload("estimates", &estimates).unwrap());
    let mut film = VulkanFilm::new(&mut on, WIDTH, HEIGHT, Units::default()).unwrap();
    let mut expected = vec![[0.0_f64; 3]; (WIDTH * HEIGHT) as usize];
    for (query, estimate) in queries.iter().zip(&estimates) {
        let irradiance = estimate.irradiance(PATHS);
        for c in 0..3 {
            expected[query.pixel as usize][c] += f64::from(query.throughput[c]) * irradiance[c];
        }
    }
    accumulate(&mut on, &mut film, Layer::Caustic, &there, &found, PATHS).unwrap();
    end_pass(&mut on, &mut film).unwrap();
    let once = read(&mut on, &film).unwrap();
    let error = worst(&once, Layer::Caustic, &expected);
    // Two divisions of 2.5 ulp, four products, two sums.
    assert!(error < 1e-6, "{error:e}");
    // A wrong number of paths would be detected.
    let off: Vec<[f64; 3]> = expected.iter().map(|sum| sum.map(|x| x * (1.0 + 1.0 / PATHS as f64))).collect();
    assert!(worst(&once, Layer::Caustic, &off) > 1e-5);

    accumulate(&mut on, &mut film, Layer::Caustic, &there, &found, PATHS).unwrap();
    abandon_pass(&mut on, &mut film).unwrap();
    assert_eq!(read(&mut on, &film).unwrap(), once);
    end_pass(&mut on, &mut film).unwrap();
    let mut empty = read(&mut on, &film).unwrap();
    empty.passes = 1;
    assert_eq!(empty, once);
}

/// The picture as it is shown against the one made of the film, for each curve: bytes differ by 1 at most, since powers and
/// logarithms of devices have errors of some ulps.
#[test]
fn the_shown_picture_is_that_of_the_film() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let units = Units { power: 3.0, ..Units::default() };
    let mut film = VulkanFilm::new(&mut on, WIDTH, HEIGHT, units).unwrap();
    let queries = queries();
    let there = on.upload("queries", &queries).unwrap();
    let passes = [Layer::Direct, Layer::Indirect, Layer::Direct, Layer::Emission, Layer::Caustic];
    for (pass, layer) in passes.into_iter().enumerate().map(|(pass, layer)| (pass as u32, layer)) {
        let mut values: Vec<[f32; 3]> = (0..queries.len() as u32).map(|i| number([i, pass, 9, 9])).collect();
        values[5] = [f32::NAN, 1e30, 0.5];
        values[9] = [f32::INFINITY, -1.0, 0.0];
        film.values_address(&mut on, there.capacity()).unwrap();
        on.write(film.values.as_ref().unwrap(), 0, bytemuck::cast_slice(&values)).unwrap();
        let plane = film.layer_address(&mut on, layer).unwrap();
        accumulate_values(&mut on, &mut film, plane, &there, 1).unwrap();
        end_pass(&mut on, &mut film).unwrap();
    }
    // Some pixels were hit in some of the passes.
    let hits: Vec<u32> = (0..WIDTH * HEIGHT).map(|pixel| pixel % 4).collect();
    let plane = u64::from(FIRST_HITS) * u64::from(WIDTH * HEIGHT) * 4;
    on.write(&film.first_sum, plane, bytemuck::cast_slice(&hits)).unwrap();
    let picture = read(&mut on, &film).unwrap();
    assert!(film.shown.is_none());
    let furthest = |a: &DisplayImage, b: &DisplayImage| {
        assert_eq!((a.width, a.height, a.passes), (b.width, b.height, b.passes));
        let bytes = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
        bytes.map(|(&a, &b)| a.abs_diff(b)).max().unwrap()
    };
    for tone_map in ToneMap::ALL {
        for (exposure, transparent, clamp) in
            [(0.0, false, false), (-3.5, true, false), (2.0, false, true), (-0.5, true, true), (-140.0, false, false)]
        {
            let display = Display { exposure, tone_map, transparent };
            let there = on.read_display(&mut film, &display, clamp).unwrap();
            let here = picture.display_clamped(&display, clamp);
            assert!(furthest(&there, &here) <= 1, "{display:?} {clamp}");
            // A quarter of a stop would be seen.
            let other = picture.display_clamped(&Display { exposure: exposure + 0.25, ..display }, clamp);
            assert!(exposure < -100.0 || furthest(&there, &other) > 1, "{display:?} {clamp}");
        }
    }
    let nonsense = Display { exposure: f32::NAN, ..Display::default() };
    assert!(matches!(
        on.read_display(&mut film, &nonsense, false),
        Err(Error::InvalidSetting { name: "exposure", .. })
    ));
}

//! The film compared with sums in f64.

use photon_core::random::{philox4x32, unit_f32};
use photon_core::{Backend, Estimate, Film, Layer, Query, Units};

use super::{VulkanFilm, abandon_pass, accumulate, accumulate_values, end_pass, read};
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
        accumulate_values(&mut on, &mut film, Layer::Direct, &there).unwrap();
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

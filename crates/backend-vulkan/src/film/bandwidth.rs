//! Radii of pixels, updated on the device from the sums that are there. Twin of photon-core's `PixelRadii`, in f32.

use photon_core::{Layer, MapKind, PerMap, RadiusUpdate, Result};

use super::{GROUP, VulkanFilm, zeroed};
use crate::device::ComputePipeline;
use crate::device::buffer::VulkanBuffer;
use crate::shaders;
use crate::vulkan::Vulkan;

/// Planes of `Push::radii`.
const PLANES: u64 = 7;

parameters! {
    struct Push => FILM_BANDWIDTH_BIAS FILM_BANDWIDTH_CHANGE FILM_BANDWIDTH_FACTOR {
        /// Sums of all layers, and of the layer of each map.
        sums: [u64; 4],
        lights: [u64; MapKind::COUNT],
        photon_moments: [u64; MapKind::COUNT],
        errors: u64,
        radii: u64,
        factors: u64,
        pixels: u32,
        width: u32,
        passes: f32,
        since: f32,
        bias: f32,
        noise: f32,
    }
}

specialized!(bandwidth_constants: BandwidthConstants => FILM_BANDWIDTH_CHANGE, 2 layers: u32, 3 maps: u32);

/// Updates `factors`, or begins with 1 in all pixels. Returns whether the film has error statistics.
pub(super) fn update(
    on: &mut Vulkan,
    film: &mut VulkanFilm,
    update: &RadiusUpdate,
    factors: &mut Option<VulkanBuffer<u32>>,
) -> Result<bool> {
    let pixels = film.pixels();
    if film.errors.is_none() {
        return Ok(false);
    }
    if film.radii.is_none() {
        film.radii = Some(zeroed(on, pixels * 4 * PLANES)?);
        film.note(on);
    }
    if factors.is_none() {
        let mut made = VulkanBuffer::new(on, "radii of pixels", pixels)?;
        on.fill_words(&made.data, 0, pixels * 4, 1.0_f32.to_bits())?;
        on.set_length(&mut made, pixels)?;
        *factors = Some(made);
    }
    let (Some(errors), Some(radii), Some(factors)) = (&film.errors, &film.radii, factors) else { return Ok(false) };
    let sum = |layer: usize| film.layers[layer].as_ref().map_or(0, |plane| plane.sum.address());
    let lights = MapKind::ALL.map(|kind| sum(kind.layer() as usize));
    let photon_moments = MapKind::ALL.map(|kind| errors.photon_moments_address(kind));
    let maps = lights.iter().zip(&photon_moments).enumerate();
    let maps =
        maps.filter(|(_, (light, moments))| **light != 0 && **moments != 0).fold(0, |bits, (i, _)| bits | 1 << i);
    let push = Push {
        sums: std::array::from_fn(sum),
        lights,
        photon_moments,
        errors: errors.sum_address(),
        radii: radii.address(),
        factors: factors.data_address(),
        pixels: pixels as u32,
        width: film.width,
        passes: update.passes as f32,
        since: update.since as f32,
        bias: update.bias as f32,
        noise: update.noise as f32,
    };
    let kernels = kernels(on, film.layer_bits(), maps);
    for kernel in &kernels {
        on.dispatch(kernel, &push, pixels.div_ceil(u64::from(GROUP)))?;
    }
    Ok(true)
}

/// The kernels, for a film with these layers and moments of these maps.
fn kernels(on: &mut Vulkan, layers: u32, maps: u32) -> [ComputePipeline; 3] {
    [
        on.kernel(&shaders::FILM_BANDWIDTH_BIAS, GROUP, &()),
        on.kernel(&shaders::FILM_BANDWIDTH_CHANGE, GROUP, &BandwidthConstants { layers, maps }),
        on.kernel(&shaders::FILM_BANDWIDTH_FACTOR, GROUP, &()),
    ]
}

/// Requests the kernels for a film with these layers and moments of these maps.
pub(crate) fn announce(on: &mut Vulkan, layers: &[Layer], maps: PerMap<bool>) {
    kernels(on, layers.iter().fold(0, |bits, &layer| bits | 1 << layer as u32), maps.bits());
}

#[cfg(test)]
mod tests {
    use photon_core::random::{philox4x32, unit_f32};
    use photon_core::{
        Backend, ErrorMoments, Estimate, Film, FilmBackend, Layer, MapKind, PhotonMoments, PixelRadii, Query,
        RadiusUpdate, Units,
    };

    use super::super::VulkanFilm;
    use crate::Vulkan;

    const WIDTH: u32 = 53;
    const HEIGHT: u32 = 31;
    const PATHS: u64 = 10_000;

    fn uniform(counter: [u32; 4]) -> [f32; 4] {
        philox4x32(counter, [3, 9]).map(unit_f32)
    }

    /// A pass: light of two maps with other noise, bias and distribution of photons in each block of 4 × 4 pixels, and
    /// direct light.
    fn pass(on: &mut Vulkan, film: &mut VulkanFilm, index: u32) {
        let pixels = WIDTH * HEIGHT;
        let queries: Vec<Query> =
            (0..pixels).map(|pixel| Query { pixel, throughput: [0.5; 3], radius: 0.1, ..Query::default() }).collect();
        let queries = on.upload("queries", &queries).unwrap();
        for kind in [MapKind::Caustic, MapKind::Global] {
            let made = (0..pixels).map(|pixel| {
                let block = pixel / WIDTH / 4 * WIDTH + pixel % WIDTH / 4;
                let [bias, noise, off, shape] = uniform([block, kind as u32, 1, 0]);
                let [less, stray, few, _] = uniform([block, kind as u32, 2, 0]);
                let [a, b, c, d] = uniform([pixel, kind as u32, 3, index]);
                let photons = if few < 0.2 { 1 } else { 2 + (8.0 * few) as u32 };
                let power = photons as f32;
                let flux = 0.3 * power * (1.0 + noise * (a - 0.5));
                let bias = 0.4 * (bias - 0.6).max(0.0);
                let wide = 2.0 * flux * (1.0 + bias + noise * (b - 0.5));
                let narrow = 0.5 * flux * (1.0 - 0.5 * bias * (0.5 + less) + noise * (c - 0.5));
                let estimate = Estimate { flux: [flux; 3], radius_squared: 0.01, photons, ..Estimate::default() };
                let moments = ErrorMoments {
                    wide: [wide; 3],
                    narrow: [narrow; 3],
                    power,
                    power_squared: power * (1.0 + a),
                    slope: [0.6 * power * (off - 0.5), 0.2 * power * (d - 0.5)],
                    quadrupole: [0.3 * power * (shape - 0.5), 0.2 * power * (d - 0.5)],
                    stray: if stray < 0.3 { 0.1 * stray * power } else { 0.0 },
                    photons,
                    ..ErrorMoments::default()
                };
                (estimate, moments)
            });
            let (estimates, moments): (Vec<Estimate>, Vec<ErrorMoments>) = made.unzip();
            let estimates = on.upload("estimates", &estimates).unwrap();
            let moments = on.upload("moments", &moments).unwrap();
            // In some films caustics are faint beside other light.
            let paths = if kind == MapKind::Caustic { 4 * PATHS } else { PATHS };
            on.accumulate(film, kind.layer(), &queries, &estimates, paths).unwrap();
            on.accumulate_errors(film, kind, &queries, &estimates, &moments, paths).unwrap();
            if kind == MapKind::Global {
                on.accumulate(film, Layer::Direct, &queries, &estimates, PATHS / 4).unwrap();
            }
        }
        on.end_pass(film).unwrap();
    }

    /// The largest relative difference of factors on radii.
    fn worst(one: &[u32], other: &[u32]) -> f32 {
        assert_eq!(one.len(), other.len());
        let both = one.iter().zip(other).map(|(a, b)| (f32::from_bits(*a), f32::from_bits(*b)));
        both.map(|(a, b)| (a / b - 1.0).abs()).max_by(f32::total_cmp).unwrap_or(f32::NAN)
    }

    /// Two updates on the device against those on the host, from the same film. What rounding of f32 changes is amplified
    /// where bias is near its noise, by up to twenty times.
    #[test]
    fn radii_are_those_of_the_host() {
        let Some(mut on) = Vulkan::for_tests() else { return };
        let mut film = VulkanFilm::new(&mut on, WIDTH, HEIGHT, Units::default()).unwrap();
        let update = RadiusUpdate::new(8, 8, [0.9, 0.7]);
        let mut factors = None;
        assert!(!on.update_radii(&mut film, &update, &mut factors).unwrap() && factors.is_none());
        on.keep_errors(&mut film).unwrap();
        let mut expected = PixelRadii::new((WIDTH * HEIGHT) as usize);
        let mut evenly = expected.clone();
        let without_edges = |mut film: Film| {
            for error in film.errors.iter_mut().flatten() {
                let even = |power| PhotonMoments { power, power_squared: 0.1 * power, ..PhotonMoments::default() };
                error.photon_moments.iter_mut().for_each(|(_, moments)| *moments = even(moments.power));
            }
            film
        };
        for (passes, since, outlook) in [(8, 8, [0.9, 0.7]), (16, 8, [0.8, 0.5])] {
            (0..since).for_each(|index| pass(&mut on, &mut film, passes + index));
            let update = RadiusUpdate::new(passes, since, outlook);
            assert!(on.update_radii(&mut film, &update, &mut factors).unwrap());
            let mut found = vec![0; (WIDTH * HEIGHT) as usize];
            let factors = factors.as_ref().unwrap();
            on.read(&factors.data, 0, bytemuck::cast_slice_mut(&mut found)).unwrap();
            let picture = on.read_film(&film).unwrap();
            expected.learn(&picture, &update);
            let error = worst(&found, &expected.bits());
            assert!(error < 1e-4, "{passes}: {error:e}");
            // Edges matter in this film.
            evenly.learn(&without_edges(picture), &update);
            assert!(worst(&evenly.bits(), &expected.bits()) > 0.01);
            let share = |is_meant: fn(f32) -> bool| {
                found.iter().filter(|bits| is_meant(f32::from_bits(**bits))).count() as f64 / found.len() as f64
            };
            assert!(share(|factor| factor > 1.05) > 0.1 && share(|factor| factor < 0.95) > 0.1);
        }
    }
}

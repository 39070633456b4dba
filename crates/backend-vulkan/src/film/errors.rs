//! Error statistics on the device: twin of photon-core's `ErrorPixel`. The current pass is stored in f32, sums
//! over passes as sums of two floats; statistics of a map are allocated when the map is first read.

use bytemuck::Zeroable;
use bytemuck::allocation::try_zeroed_vec;
use photon_core::{Error, ErrorMoments, ErrorPixel, Estimate, Film, MapKind, PerMap, PhotonMoments, Query, Result};

use super::{GROUP, VulkanFilm, read_back, zeroed};
use crate::constants::{
    ERROR_BIAS, ERROR_BIAS_SQUARE, ERROR_LOW, ERROR_NARROW, ERROR_NARROW_SQUARE, MOMENTS_LOW, MOMENTS_POWER,
    MOMENTS_POWER_SQUARED, MOMENTS_QUADRUPOLE, MOMENTS_SLOPE, MOMENTS_STRAY,
};
use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

/// Number of sums, each with a high and a low plane.
const SUMS: usize = ERROR_LOW as usize;
const MOMENTS: usize = MOMENTS_LOW as usize;

/// Source of an accumulation: [`AccumulateConstants::from`].
const FROM_MOMENTS: u32 = 0;
const FROM_GATHERED: u32 = 1;

#[derive(Debug)]
pub(super) struct Errors {
    /// Planes of the bias and narrow estimates.
    pass: Memory,
    sum: Memory,
    /// For each map that was read: the current pass, and the sums.
    photon_moments: PerMap<Option<(Memory, Memory)>>,
}

parameters! {
    struct AccumulatePush => FILM_ERRORS {
        queries: u64,
        query_count: u64,
        estimates: u64,
        error_moments: u64,
        found_count: u64,
        pass: u64,
        map_moments: u64,
        pixels: u32,
        scale: f32,
    }
}

parameters! {
    struct EndPush => FILM_END_ERRORS {
        pass: u64,
        sum: u64,
        pass_shapes: [u64; MapKind::COUNT],
        sum_shapes: [u64; MapKind::COUNT],
        pixels: u32,
        padding: u32,
    }
}

specialized!(accumulate_constants: AccumulateConstants => FILM_ERRORS, 2 from: u32);

specialized!(end_constants: EndConstants => FILM_END_ERRORS, 2 maps: u32);

impl Errors {
    fn new(on: &mut Vulkan, pixels: u64) -> Result<Self> {
        let (pass, sum) = (zeroed(on, pixels * 8)?, zeroed(on, pixels * 8 * SUMS as u64)?);
        Ok(Self { pass, sum, photon_moments: PerMap::default() })
    }

    pub(super) fn bytes(&self) -> u64 {
        let photon_moments = self.photon_moments.values().flatten().map(|(pass, sum)| pass.bytes() + sum.bytes());
        self.pass.bytes() + self.sum.bytes() + photon_moments.sum::<u64>()
    }

    /// Address of the sums of bias and narrow estimates.
    pub(super) fn sum_address(&self) -> u64 {
        self.sum.address()
    }

    /// Address of the sums of a map's photon moments; 0 if it was not read.
    pub(super) fn photon_moments_address(&self, kind: MapKind) -> u64 {
        self.photon_moments[kind].as_ref().map_or(0, |(_, sum)| sum.address())
    }

    /// Buffers of the sums.
    fn sums(&self) -> impl Iterator<Item = &Memory> {
        std::iter::once(&self.sum).chain(self.photon_moments.values().flatten().map(|(_, sum)| sum))
    }

    /// Buffers of the current pass.
    fn passes(&self) -> impl Iterator<Item = &Memory> {
        std::iter::once(&self.pass).chain(self.photon_moments.values().flatten().map(|(pass, _)| pass))
    }
}

/// From now on the film stores error statistics.
pub(crate) fn keep(on: &mut Vulkan, film: &mut VulkanFilm) -> Result<()> {
    film.errors = Some(Errors::new(on, film.pixels())?);
    film.note(on);
    Ok(())
}

/// Adds the `error_moments` of `estimates` to each query's pixel.
pub(crate) fn accumulate(
    on: &mut Vulkan,
    film: &mut VulkanFilm,
    kind: MapKind,
    queries: &VulkanBuffer<Query>,
    estimates: &VulkanBuffer<Estimate>,
    error_moments: &VulkanBuffer<ErrorMoments>,
    paths: u64,
) -> Result<()> {
    if paths == 0 {
        return Ok(());
    }
    let scale = (1.0 / (3.0 * std::f64::consts::PI * paths as f64)) as f32;
    let push = AccumulatePush {
        estimates: estimates.data_address(),
        error_moments: error_moments.data_address(),
        found_count: estimates.count_address(),
        scale,
        ..AccumulatePush::zeroed()
    };
    dispatch(on, film, kind, queries, FROM_MOMENTS, push)
}

/// Adds the error moments of final-gather rays, one record per query.
pub(crate) fn accumulate_gathered(
    on: &mut Vulkan,
    film: &mut VulkanFilm,
    queries: &VulkanBuffer<Query>,
    gathered: &VulkanBuffer<ErrorMoments>,
) -> Result<()> {
    let push = AccumulatePush {
        error_moments: gathered.data_address(),
        found_count: queries.count_address(),
        scale: 1.0 / 3.0,
        ..AccumulatePush::zeroed()
    };
    dispatch(on, film, MapKind::Global, queries, FROM_GATHERED, push)
}

fn dispatch(
    on: &mut Vulkan,
    film: &mut VulkanFilm,
    kind: MapKind,
    queries: &VulkanBuffer<Query>,
    from: u32,
    push: AccumulatePush,
) -> Result<()> {
    let pixels = film.pixels();
    let Some(errors) = &mut film.errors else { return Ok(()) };
    if errors.photon_moments[kind].is_none() {
        let pass = zeroed(on, pixels * 4 * MOMENTS as u64)?;
        errors.photon_moments[kind] = Some((pass, zeroed(on, pixels * 8 * MOMENTS as u64)?));
    }
    let push = AccumulatePush {
        queries: queries.data_address(),
        query_count: queries.count_address(),
        pass: errors.pass.address(),
        map_moments: errors.photon_moments[kind].as_ref().map_or(0, |(pass, _)| pass.address()),
        pixels: pixels as u32,
        ..push
    };
    film.note(on);
    let length = on.length(queries)?;
    let kernel = accumulate_kernel(on, from);
    on.dispatch(&kernel, &push, length.div_ceil(u64::from(GROUP)))
}

fn accumulate_kernel(on: &mut Vulkan, from: u32) -> ComputePipeline {
    on.kernel(&shaders::FILM_ERRORS, GROUP, &AccumulateConstants { from })
}

fn end_kernel(on: &mut Vulkan, maps: u32) -> ComputePipeline {
    on.kernel(&shaders::FILM_END_ERRORS, GROUP, &EndConstants { maps })
}

/// Requests the kernels for errors of estimates from the `shown` maps, and of what is gathered.
pub(crate) fn announce(on: &mut Vulkan, shown: PerMap<bool>, gathers: bool) {
    if shown.any() {
        accumulate_kernel(on, FROM_MOMENTS);
    }
    let mut maps = shown;
    if gathers {
        accumulate_kernel(on, FROM_GATHERED);
        maps[MapKind::Global] = true;
    }
    end_kernel(on, maps.bits());
}

/// Adds the current pass to the sums and starts the next one.
pub(super) fn end_pass(on: &mut Vulkan, film: &VulkanFilm) -> Result<()> {
    let Some(errors) = &film.errors else { return Ok(()) };
    let address = |of: fn(&(Memory, Memory)) -> &Memory| {
        errors
            .photon_moments
            .each_ref()
            .map(|map_moments| map_moments.as_ref().map_or(0, |map_moments| of(map_moments).address()))
            .into_array()
    };
    let push = EndPush {
        pass: errors.pass.address(),
        sum: errors.sum.address(),
        pass_shapes: address(|(pass, _)| pass),
        sum_shapes: address(|(_, sum)| sum),
        pixels: film.pixels() as u32,
        padding: 0,
    };
    let maps = errors.photon_moments.each_ref().map(Option::is_some).bits();
    let kernel = end_kernel(on, maps);
    on.dispatch(&kernel, &push, film.pixels().div_ceil(u64::from(GROUP)))
}

/// Discards the current pass.
pub(super) fn abandon_pass(on: &mut Vulkan, film: &VulkanFilm) -> Result<()> {
    film.errors.iter().flat_map(Errors::passes).try_for_each(|memory| on.fill_words(memory, 0, memory.bytes(), 0))
}

/// Empties the sums.
pub(super) fn clear_sums(on: &mut Vulkan, film: &VulkanFilm) -> Result<()> {
    film.errors.iter().flat_map(Errors::sums).try_for_each(|memory| on.fill_words(memory, 0, memory.bytes(), 0))
}

/// Reads the sums back into `picture`.
pub(super) fn read(on: &mut Vulkan, film: &VulkanFilm, picture: &mut Film) -> Result<()> {
    let Some(errors) = &film.errors else { return Ok(()) };
    // Not written until it is filled, by all cores.
    let mut all = try_zeroed_vec::<ErrorPixel>(picture.pixels.len()).map_err(|()| Error::OutOfMemory {
        label: "film: errors",
        bytes: (picture.pixels.len() as u64).saturating_mul(size_of::<ErrorPixel>() as u64),
    })?;
    let photon_moments =
        errors.photon_moments.values().flatten().flat_map(|(_, sum)| (0..2 * MOMENTS).map(move |i| (sum, i)));
    let planes: Vec<_> = (0..2 * SUMS).map(|i| (&errors.sum, i)).chain(photon_moments).collect();
    read_back::planes(on, &planes, &mut all, |at, pixel| {
        [pixel.bias, pixel.bias_square, pixel.narrow, pixel.narrow_square] =
            [ERROR_BIAS, ERROR_BIAS_SQUARE, ERROR_NARROW, ERROR_NARROW_SQUARE]
                .map(|plane| at.sum(plane as usize, SUMS));
        let mut first = 2 * SUMS;
        for (_, map_moments) in
            pixel.photon_moments.iter_mut().filter(|(kind, _)| errors.photon_moments[*kind].is_some())
        {
            let sum = |plane: u32| at.sum(first + plane as usize, MOMENTS);
            *map_moments = PhotonMoments {
                power: sum(MOMENTS_POWER),
                power_squared: sum(MOMENTS_POWER_SQUARED),
                slope: [sum(MOMENTS_SLOPE), sum(MOMENTS_SLOPE + 1)],
                quadrupole: [sum(MOMENTS_QUADRUPOLE), sum(MOMENTS_QUADRUPOLE + 1)],
                stray: sum(MOMENTS_STRAY),
            };
            first += 2 * MOMENTS;
        }
    })?;
    picture.errors = Some(all);
    Ok(())
}

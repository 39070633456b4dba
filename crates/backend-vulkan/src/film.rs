//! The film on the device.
//!
//! The current pass is stored in f32, separately from the sums over finished passes, which are sums of two
//! floats each: a device need not support f64 or float atomics. A layer is allocated when something is first
//! added to it.

use photon_core::{Error, Estimate, Film, Layer, Query, Result, Units, check_size};

use crate::constants::{FIRST_ALBEDO, FIRST_DEPTH, FIRST_HITS, FIRST_LOW, FIRST_NORMAL, FIRST_SQUARE};
use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

mod backend;
pub(crate) mod bandwidth;
mod display;
pub(crate) mod errors;
mod read_back;
pub(crate) mod samples;
#[cfg(test)]
mod tests;

/// Invocations per workgroup; the work is bound by memory.
const GROUP: u32 = 128;

/// Sums over finished passes, and the current pass.
#[derive(Debug)]
pub struct VulkanFilm {
    width: u32,
    height: u32,
    units: Units,
    passes: u32,
    /// Camera paths of a pixel in each pass.
    camera_samples: u32,
    layers: [Option<Plane>; Layer::ALL.len()],
    /// Places of camera samples that are traced together.
    together: Option<samples::Together>,
    first_pass: Memory,
    first_sum: Memory,
    /// Scratch buffer: one vector per query, for stages that compute values per query.
    values: Option<Memory>,
    errors: Option<errors::Errors>,
    /// What updates of the radii of pixels keep; allocated by the first one.
    radii: Option<Memory>,
    /// Pixels as they are shown, a word each; allocated when they are first asked for.
    shown: Option<Memory>,
}

/// One layer of the film.
#[derive(Debug)]
struct Plane {
    /// Radiance of the current pass: three planes of floats.
    pass: Memory,
    /// Sums over finished passes: three planes of high parts and three of low parts.
    sum: Memory,
}

/// Number of planes of the first-surface sums: high and low parts, and the hits.
const FIRST_PLANES: usize = FIRST_HITS as usize + 1;

/// Bytes per pixel of `FirstPass`.
const FIRST_PASS: u64 = 32;

parameters! {
    struct AccumulatePush => FILM_ACCUMULATE {
        queries: u64,
        query_count: u64,
        estimates: u64,
        values: u64,
        found_count: u64,
        pass: u64,
        pixels: u32,
        scale: f32,
    }
}

parameters! {
    struct EndPush => FILM_END {
        passes: [u64; 4],
        sums: [u64; 4],
        first_pass: u64,
        first_sum: u64,
        pixels: u32,
        padding: u32,
    }
}

parameters! {
    struct AveragePush => FILM_AVERAGE {
        pass: u64,
        numbers: u32,
        samples: f32,
    }
}

specialized!(accumulate_constants: AccumulateConstants => FILM_ACCUMULATE, 2 from: u32);

specialized!(end_constants: EndConstants => FILM_END, 2 layers: u32);

/// Source of an accumulation: [`AccumulateConstants::from`].
const FROM_ESTIMATES: u32 = 0;
const FROM_VALUES: u32 = 1;

impl VulkanFilm {
    /// Allocates an empty film.
    pub(crate) fn new(on: &mut Vulkan, width: u32, height: u32, units: Units) -> Result<Self> {
        check_size(width, height)?;
        let pixels = u64::from(width) * u64::from(height);
        let first_pass = zeroed(on, pixels * FIRST_PASS)?;
        let first_sum = zeroed(on, pixels * 4 * FIRST_PLANES as u64)?;
        let layers = [const { None }; 4];
        let film = Self {
            width,
            height,
            units,
            passes: 0,
            camera_samples: 1,
            layers,
            together: None,
            first_pass,
            first_sum,
            values: None,
            errors: None,
            radii: None,
            shown: None,
        };
        film.note(on);
        Ok(film)
    }

    /// Number of pixels.
    pub(crate) fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Checks that an image of this size matches the film.
    pub(crate) fn check_size(&self, width: u32, height: u32) -> Result<()> {
        if (width, height) == (self.width, self.height) {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "size",
            value: format!("{width}x{height}"),
            hint: "must be the size of the film",
        })
    }

    /// Whether the film stores error statistics.
    pub(crate) fn keeps_errors(&self) -> bool {
        self.errors.is_some()
    }

    /// Address of the current pass of a layer, three planes of floats; allocates the layer if necessary.
    pub(crate) fn layer_address(&mut self, on: &mut Vulkan, layer: Layer) -> Result<u64> {
        if let Some(plane) = &self.layers[layer as usize] {
            return Ok(plane.pass.address());
        }
        let plane = Plane { pass: zeroed(on, self.pixels() * 12)?, sum: zeroed(on, self.pixels() * 24)? };
        let address = plane.pass.address();
        self.layers[layer as usize] = Some(plane);
        self.note(on);
        Ok(address)
    }

    /// Bit mask of the layers that exist.
    fn layer_bits(&self) -> u32 {
        (0..4).filter(|&i| self.layers[i].is_some()).fold(0, |bits, i| bits | 1 << i)
    }

    /// Address of a scratch buffer of three floats for each of `count` queries.
    pub(crate) fn values_address(&mut self, on: &mut Vulkan, count: u64) -> Result<u64> {
        if let Some(values) = self.values.as_ref().filter(|values| values.bytes() >= count * 12) {
            return Ok(values.address());
        }
        self.values = None;
        let values = on.memory("film", count * 12).map_err(label)?;
        let address = values.address();
        self.values = Some(values);
        self.note(on);
        Ok(address)
    }

    /// Clears the scratch values of the first `count` queries.
    pub(crate) fn clear_values(&mut self, on: &mut Vulkan, count: u64) -> Result<()> {
        self.values_address(on, count)?;
        match &self.values {
            Some(values) => on.fill_words(values, 0, count * 12, 0),
            None => Ok(()),
        }
    }

    /// Reports its memory as that of the film.
    fn note(&self, on: &mut Vulkan) {
        let planes = self.layers.iter().flatten().map(|plane| plane.pass.bytes() + plane.sum.bytes());
        let together = self.together.as_ref().map_or(0, samples::Together::bytes);
        let scratch: u64 = [&self.values, &self.shown, &self.radii].into_iter().flatten().map(Memory::bytes).sum();
        on.note_memory(
            "film",
            planes.sum::<u64>() + scratch + together + self.first_pass.bytes() + self.first_sum.bytes(),
        );
        if let Some(errors) = &self.errors {
            on.note_memory("film: errors", errors.bytes());
        }
    }
}

/// Adds `weight × irradiance` of each estimate to `layer` of its query's pixel. The queries of a pixel are
/// consecutive; they are added in order.
pub(crate) fn accumulate(
    on: &mut Vulkan,
    film: &mut VulkanFilm,
    layer: Layer,
    queries: &VulkanBuffer<Query>,
    estimates: &VulkanBuffer<Estimate>,
    paths: u64,
) -> Result<()> {
    if paths == 0 {
        return Ok(());
    }
    let push = AccumulatePush {
        queries: queries.data_address(),
        query_count: queries.count_address(),
        estimates: estimates.data_address(),
        values: 0,
        found_count: estimates.count_address(),
        pass: film.layer_address(on, layer)?,
        pixels: film.pixels() as u32,
        scale: (1.0 / (std::f64::consts::PI * paths as f64)) as f32,
    };
    let length = on.length(queries)?;
    dispatch(on, FROM_ESTIMATES, &push, length)
}

/// Adds `weight × value` of each query to its pixel in the planes `pass` of so many camera samples; the values are in the
/// film's scratch buffer.
pub(crate) fn accumulate_values(
    on: &mut Vulkan,
    film: &mut VulkanFilm,
    pass: u64,
    queries: &VulkanBuffer<Query>,
    samples: u32,
) -> Result<()> {
    let push = AccumulatePush {
        queries: queries.data_address(),
        query_count: queries.count_address(),
        estimates: 0,
        values: film.values_address(on, queries.capacity())?,
        found_count: queries.count_address(),
        pass,
        pixels: film.pixels() as u32 * samples,
        scale: 1.0,
    };
    // The number of queries is not needed on the host: dispatch for the full capacity.
    dispatch(on, FROM_VALUES, &push, queries.capacity())
}

fn accumulate_kernel(on: &mut Vulkan, from: u32) -> ComputePipeline {
    on.kernel(&shaders::FILM_ACCUMULATE, GROUP, &AccumulateConstants { from })
}

fn end_kernel(on: &mut Vulkan, layers: u32) -> ComputePipeline {
    on.kernel(&shaders::FILM_END, GROUP, &EndConstants { layers })
}

/// Requests the kernels that add to these layers, from estimates or from values, and end passes.
pub(crate) fn announce(on: &mut Vulkan, layers: &[Layer], from_estimates: bool, from_values: bool, averages: bool) {
    if averages {
        average_kernel(on);
        samples::kernel(on);
    }
    let wanted = [(FROM_ESTIMATES, from_estimates), (FROM_VALUES, from_values)];
    for (from, _) in wanted.into_iter().filter(|(_, is_wanted)| *is_wanted) {
        accumulate_kernel(on, from);
    }
    end_kernel(on, layers.iter().fold(0, |bits, &layer| bits | 1 << layer as u32));
}

fn dispatch(on: &mut Vulkan, from: u32, push: &AccumulatePush, queries: u64) -> Result<()> {
    let kernel = accumulate_kernel(on, from);
    on.dispatch(&kernel, push, queries.div_ceil(u64::from(GROUP)))
}

fn average_kernel(on: &mut Vulkan) -> ComputePipeline {
    on.kernel(&shaders::FILM_AVERAGE, GROUP, &())
}

/// Divides the current pass of `layers` by its number of camera samples.
pub(crate) fn average_samples(on: &mut Vulkan, film: &mut VulkanFilm, layers: &[Layer], samples: u32) -> Result<()> {
    let kernel = average_kernel(on);
    let numbers = 3 * film.pixels();
    for plane in layers.iter().filter_map(|&layer| film.layers[layer as usize].as_ref()) {
        // A picture of more than 2³² numbers is divided in parts.
        for start in (0..numbers).step_by(1 << 31) {
            let count = (numbers - start).min(1 << 31);
            let pass = plane.pass.address() + 4 * start;
            let push = AveragePush { pass, numbers: count as u32, samples: samples as f32 };
            on.dispatch(&kernel, &push, count.div_ceil(u64::from(GROUP)))?;
        }
    }
    film.camera_samples = samples;
    Ok(())
}

/// Adds the current pass to the sums and starts the next one.
pub(crate) fn end_pass(on: &mut Vulkan, film: &mut VulkanFilm) -> Result<()> {
    let address = |memory: fn(&Plane) -> &Memory| {
        std::array::from_fn(|i| film.layers[i].as_ref().map_or(0, |plane| memory(plane).address()))
    };
    let push = EndPush {
        passes: address(|plane| &plane.pass),
        sums: address(|plane| &plane.sum),
        first_pass: film.first_pass.address(),
        first_sum: film.first_sum.address(),
        pixels: film.pixels() as u32,
        padding: 0,
    };
    let kernel = end_kernel(on, film.layer_bits());
    on.dispatch(&kernel, &push, film.pixels().div_ceil(u64::from(GROUP)))?;
    errors::end_pass(on, film)?;
    film.passes += 1;
    Ok(())
}

/// Discards the current pass.
pub(crate) fn abandon_pass(on: &mut Vulkan, film: &mut VulkanFilm) -> Result<()> {
    film.together = None;
    film.note(on);
    for plane in film.layers.iter().flatten() {
        on.fill_words(&plane.pass, 0, plane.pass.bytes(), 0)?;
    }
    errors::abandon_pass(on, film)?;
    on.fill_words(&film.first_pass, 0, film.first_pass.bytes(), 0)
}

/// Empties sums and current pass.
pub(crate) fn clear(on: &mut Vulkan, film: &mut VulkanFilm) -> Result<()> {
    abandon_pass(on, film)?;
    for plane in film.layers.iter().flatten() {
        on.fill_words(&plane.sum, 0, plane.sum.bytes(), 0)?;
    }
    errors::clear_sums(on, film)?;
    (film.passes, film.camera_samples, film.radii) = (0, 1, None);
    film.note(on);
    on.fill_words(&film.first_sum, 0, film.first_sum.bytes(), 0)
}

/// Reads back the sums.
pub(crate) fn read(on: &mut Vulkan, film: &VulkanFilm) -> Result<Film> {
    let mut picture = Film::new(film.width, film.height, film.units)?;
    (picture.passes, picture.camera_samples) = (film.passes, film.camera_samples);
    let sums = film.layers.iter().flatten().flat_map(|plane| (0..6).map(|i| (&plane.sum, i)));
    let planes: Vec<_> = (0..FIRST_PLANES).map(|i| (&film.first_sum, i)).chain(sums).collect();
    read_back::planes(on, &planes, &mut picture.pixels, |at, pixel| {
        let first = |plane: u32, axis: usize| at.sum(plane as usize + axis, FIRST_LOW as usize);
        pixel.normal = std::array::from_fn(|axis| first(FIRST_NORMAL, axis));
        pixel.albedo = std::array::from_fn(|axis| first(FIRST_ALBEDO, axis));
        pixel.depth = first(FIRST_DEPTH, 0);
        // The device squares the sum of the channels, not their mean.
        pixel.square = first(FIRST_SQUARE, 0) / 9.0;
        pixel.hits = u64::from(at.word(FIRST_HITS as usize));
        let mut plane = FIRST_PLANES;
        for (sum, _) in pixel.layers.iter_mut().zip(&film.layers).filter(|(_, plane)| plane.is_some()) {
            *sum = std::array::from_fn(|channel| at.sum(plane + channel, 3));
            plane += 6;
        }
    })?;
    errors::read(on, film, &mut picture)?;
    Ok(picture)
}

fn zeroed(on: &mut Vulkan, bytes: u64) -> Result<Memory> {
    let memory = on.memory("film", bytes).map_err(label)?;
    on.fill_words(&memory, 0, memory.bytes(), 0)?;
    Ok(memory)
}

fn label(error: Error) -> Error {
    match error {
        Error::OutOfMemory { bytes, .. } => Error::OutOfMemory { label: "film", bytes },
        other => other,
    }
}

//! Camera samples that are traced together: each has places of its own, which are added to the current pass one sample after
//! another, as if these had been traced so.

use photon_core::{Layer, Result};

use super::{FIRST_PASS, GROUP, VulkanFilm, zeroed};
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

/// Light that camera samples add, in its order within a sample.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SampleLight {
    /// [`Layer::Emission`].
    Emission,
    /// [`Layer::Direct`], from segments in media.
    Segments,
    /// [`Layer::Direct`], from surfaces.
    Surfaces,
}

impl SampleLight {
    const ALL: [Self; 3] = [Self::Emission, Self::Segments, Self::Surfaces];

    fn layer(self) -> Layer {
        if matches!(self, Self::Emission) { Layer::Emission } else { Layer::Direct }
    }
}

/// Places of camera samples, which are empty after [`add`].
#[derive(Debug)]
pub(super) struct Together {
    /// Most samples.
    samples: u32,
    /// For each kind of light, three planes of the pixels of all samples.
    light: [Option<Memory>; SampleLight::ALL.len()],
    first: Memory,
}

parameters! {
    struct SamplesPush => FILM_SAMPLES {
        from: [u64; 3],
        to: [u64; 2],
        first_from: u64,
        first_to: u64,
        pixels: u32,
        samples: u32,
        lit: u32,
        padding: u32,
    }
}

impl Together {
    pub(super) fn bytes(&self) -> u64 {
        self.first.bytes() + self.light.iter().flatten().map(Memory::bytes).sum::<u64>()
    }
}

impl VulkanFilm {
    /// Address of light of the current pass, three planes of the pixels of so many camera samples.
    pub(crate) fn places(&mut self, on: &mut Vulkan, light: SampleLight, samples: u32) -> Result<u64> {
        let whole = self.layer_address(on, light.layer())?;
        if samples == 1 {
            return Ok(whole);
        }
        let pixels = self.pixels();
        let together = self.together(on, samples)?;
        if let Some(place) = &together.light[light as usize] {
            return Ok(place.address());
        }
        let place = zeroed(on, pixels * u64::from(together.samples) * 12)?;
        let address = together.light[light as usize].insert(place).address();
        self.note(on);
        Ok(address)
    }

    /// Address of the first surfaces of the current pass, one for each pixel of so many camera samples.
    pub(crate) fn first_places(&mut self, on: &mut Vulkan, samples: u32) -> Result<u64> {
        if samples == 1 { Ok(self.first_pass.address()) } else { Ok(self.together(on, samples)?.first.address()) }
    }

    fn together(&mut self, on: &mut Vulkan, samples: u32) -> Result<&mut Together> {
        let together = match self.together.take().filter(|together| together.samples >= samples) {
            Some(together) => together,
            None => {
                let first = zeroed(on, self.pixels() * u64::from(samples) * FIRST_PASS)?;
                Together { samples, light: [const { None }; SampleLight::ALL.len()], first }
            }
        };
        Ok(self.together.insert(together))
    }
}

/// The kernel of [`add`].
pub(super) fn kernel(on: &mut Vulkan) -> ComputePipeline {
    on.kernel(&shaders::FILM_SAMPLES, GROUP, &())
}

/// Adds the places of so many samples to the current pass, and empties them.
pub(super) fn add(on: &mut Vulkan, film: &mut VulkanFilm, samples: u32) -> Result<()> {
    let Some(together) = &film.together else { return Ok(()) };
    let pass = |layer: Layer| film.layers[layer as usize].as_ref().map_or(0, |plane| plane.pass.address());
    let from = SampleLight::ALL.map(|light| together.light[light as usize].as_ref().map_or(0, Memory::address));
    let push = SamplesPush {
        from,
        to: [Layer::Emission, Layer::Direct].map(pass),
        first_from: together.first.address(),
        first_to: film.first_pass.address(),
        pixels: film.pixels() as u32,
        samples,
        lit: (0..).zip(from).filter(|(_, address)| *address != 0).fold(0, |bits, (kind, _)| bits | 1 << kind),
        padding: 0,
    };
    let kernel = kernel(on);
    on.dispatch(&kernel, &push, film.pixels().div_ceil(u64::from(GROUP)))
}

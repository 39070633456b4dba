//! The film methods that the backend trait requires.

use photon_core::{
    Display, DisplayImage, ErrorMoments, Estimate, Film, FilmBackend, Layer, MapKind, Query, RadiusUpdate, Result,
    Units,
};

use super::VulkanFilm;
use crate::device::buffer::VulkanBuffer;
use crate::vulkan::Vulkan;

impl FilmBackend for Vulkan {
    type Film = VulkanFilm;

    fn film(&mut self, units: Units, width: u32, height: u32) -> Result<VulkanFilm> {
        VulkanFilm::new(self, width, height, units)
    }

    fn accumulate(
        &mut self,
        film: &mut VulkanFilm,
        layer: Layer,
        queries: &VulkanBuffer<Query>,
        estimates: &VulkanBuffer<Estimate>,
        paths: u64,
    ) -> Result<()> {
        super::accumulate(self, film, layer, queries, estimates, paths)
    }

    fn keep_errors(&mut self, film: &mut VulkanFilm) -> Result<()> {
        super::errors::keep(self, film)
    }

    fn accumulate_errors(
        &mut self,
        film: &mut VulkanFilm,
        kind: MapKind,
        queries: &VulkanBuffer<Query>,
        estimates: &VulkanBuffer<Estimate>,
        error_moments: &VulkanBuffer<ErrorMoments>,
        paths: u64,
    ) -> Result<()> {
        super::errors::accumulate(self, film, kind, queries, estimates, error_moments, paths)
    }

    fn add_samples(&mut self, film: &mut VulkanFilm, samples: u32) -> Result<()> {
        super::samples::add(self, film, samples)
    }

    fn average_samples(&mut self, film: &mut VulkanFilm, layers: &[Layer], samples: u32) -> Result<()> {
        super::average_samples(self, film, layers, samples)
    }

    fn end_pass(&mut self, film: &mut VulkanFilm) -> Result<()> {
        super::end_pass(self, film)
    }

    fn abandon_pass(&mut self, film: &mut VulkanFilm) -> Result<()> {
        super::abandon_pass(self, film)
    }

    fn clear_film(&mut self, film: &mut VulkanFilm) -> Result<()> {
        super::clear(self, film)
    }

    fn read_film(&mut self, film: &VulkanFilm) -> Result<Film> {
        super::read(self, film)
    }

    fn update_radii(
        &mut self,
        film: &mut VulkanFilm,
        update: &RadiusUpdate,
        factors: &mut Option<VulkanBuffer<u32>>,
    ) -> Result<bool> {
        super::bandwidth::update(self, film, update, factors)
    }

    fn read_display(&mut self, film: &mut VulkanFilm, display: &Display, clamp: bool) -> Result<DisplayImage> {
        super::display::read(self, film, display, clamp)
    }
}

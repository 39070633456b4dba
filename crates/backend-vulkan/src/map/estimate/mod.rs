//! Irradiance estimates from the photons near a point, on the device. Twin of backend-cpu's estimate.rs.
//!
//! A subgroup processes as many queries at a time as it has invocations, and traverses the tree once for all of
//! them: `shaders-glsl/search/search_walk.glsl`. Queries that are close to each other share memory reads.

pub(crate) mod beam;
mod closest;
mod neighbours;
mod order;
mod pause;
mod search;
#[cfg(test)]
mod tests;

use photon_core::{
    AlbedoTable, Backend, Error, ErrorMoments, Estimate, EstimateParams, Kernel, PhotonFormat, Query,
    RadianceEstimator, Result, Search, SheenTable, neighbour_radius,
};

use crate::device::Memory;
use crate::device::buffer::VulkanBuffer;
use crate::map::VulkanMap;
use crate::vulkan::Vulkan;
use search::{MapSearch, Mode, Question, Weighting};

/// Estimates radiance from photon maps.
#[derive(Debug, Default)]
pub(crate) struct VulkanEstimator {
    search: MapSearch,
    /// Entries of the [`AlbedoTable`], once reflections are estimated, and whether those of the [`SheenTable`] follow.
    albedos: Option<(Memory, bool)>,
}

/// [`crate::low_level::estimator_without_sorting`].
pub(crate) fn estimator_without_sorting() -> Box<dyn RadianceEstimator<Vulkan>> {
    let search = MapSearch { worth_order: u64::MAX, ..MapSearch::default() };
    Box::new(VulkanEstimator { search, albedos: None })
}

impl RadianceEstimator<Vulkan> for VulkanEstimator {
    fn estimate(
        &mut self,
        on: &mut Vulkan,
        map: &VulkanMap,
        queries: &VulkanBuffer<Query>,
        gather: &EstimateParams,
        estimates: &mut VulkanBuffer<Estimate>,
    ) -> Result<()> {
        gather.validate_for(map.photon_format())?;
        let Some(question) = question(gather, self.weighting(on, gather)?) else {
            let order = self.search.order(on, map, queries)?;
            closest::ask(on, map, queries, gather, order, estimates)?;
            estimates.touch();
            return Ok(());
        };
        let (address, capacity) = (estimates.data_address(), estimates.capacity());
        let result = (address, estimates.count_address(), capacity);
        let order = self.search.order(on, map, queries)?;
        self.search.ask(on, map, (queries, 0..queries.capacity()), &question, order, result)?;
        estimates.touch();
        Ok(())
    }

    fn estimate_with_moments(
        &mut self,
        on: &mut Vulkan,
        map: &VulkanMap,
        queries: &VulkanBuffer<Query>,
        gather: &EstimateParams,
        estimates: &mut VulkanBuffer<Estimate>,
        error_moments: &mut VulkanBuffer<ErrorMoments>,
    ) -> Result<()> {
        gather.validate_moments()?;
        gather.validate_for(map.photon_format())?;
        let shading = self.weighting(on, gather)?;
        let question = Question { error_moments: error_moments.data_address(), ..radius_question(gather, shading) };
        let capacity = estimates.capacity().min(error_moments.capacity());
        let result = (estimates.data_address(), estimates.count_address(), capacity);
        let order = self.search.order(on, map, queries)?;
        self.search.ask(on, map, (queries, 0..queries.capacity()), &question, order, result)?;
        estimates.touch();
        let count = on.length(queries)?.min(error_moments.capacity());
        on.set_length(error_moments, count)
    }

    fn neighbour_radius(
        &mut self,
        on: &mut Vulkan,
        map: &VulkanMap,
        neighbours: u32,
        min_normal_cosine: f32,
    ) -> Result<Option<f32>> {
        if map.length <= neighbours {
            return Ok(None);
        }
        let count = map.length.min(neighbour_radius::SAMPLE);
        let mut queries = VulkanBuffer::<Query>::new(on, "queries", u64::from(count))?;
        search::sample(on, map, &queries, count, neighbour_radius::MAX_RADIUS)?;
        on.set_length(&mut queries, u64::from(count))?;
        let mut estimates = VulkanBuffer::<Estimate>::new(on, "estimates", u64::from(count))?;
        // The nearest photon is the query's own.
        let k = neighbours + 1;
        let gather = neighbours_of(k, min_normal_cosine);
        self.estimate(on, map, &queries, &gather, &mut estimates)?;
        let mut found = Vec::new();
        on.download(&estimates, &mut found)?;
        let squares = found.iter().filter(|e| e.photons == k).map(|e| e.radius_squared).collect();
        Ok(Some(neighbour_radius::median(squares, count)))
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }

    fn weighs_reflections(&self) -> bool {
        true
    }
}

impl VulkanEstimator {
    fn weighting(&mut self, on: &mut Vulkan, gather: &EstimateParams) -> Result<Weighting> {
        if !gather.reflection {
            return Ok(weighting(gather, 0));
        }
        let albedos = match self.albedos.take().filter(|(_, has_sheen)| *has_sheen || !gather.sheen) {
            Some(albedos) => albedos,
            None => {
                let mut bytes = bytemuck::cast_slice(AlbedoTable::get().entries()).to_vec();
                if gather.sheen {
                    bytes.extend_from_slice(bytemuck::cast_slice(SheenTable::get().entries()));
                }
                let albedos = on.memory("albedos of glossy surfaces", bytes.len() as u64)?;
                on.write(&albedos, 0, &bytes)?;
                (albedos, gather.sheen)
            }
        };
        let address = self.albedos.insert(albedos).0.address();
        Ok(weighting(gather, address))
    }
}

/// Factors on the power of photons; `albedos` is the address of the table for reflections.
fn weighting(gather: &EstimateParams, albedos: u64) -> Weighting {
    match (gather.reflection, gather.sheen, gather.anisotropy) {
        (false, ..) => {
            if gather.shading_normals {
                Weighting::Cosine
            } else {
                Weighting::Even
            }
        }
        (true, true, _) => Weighting::Sheen(albedos),
        (true, false, true) => Weighting::Anisotropic(albedos),
        (true, false, false) => Weighting::Reflection(albedos),
    }
}

/// The estimate that [`RadianceEstimator::neighbour_radius`] makes.
fn neighbours_of(k: u32, min_normal_cosine: f32) -> EstimateParams {
    EstimateParams { min_normal_cosine, ..EstimateParams::new(Search::KNearest { k }) }
}

/// Requests the kernels of estimates from maps of a format, at this many queries, with or without moments of errors.
pub(crate) fn announce(on: &mut Vulkan, gather: &EstimateParams, format: PhotonFormat, queries: u64, moments: bool) {
    let search = MapSearch::default();
    let ordered = search.is_worth_order(queries);
    if ordered {
        order::kernel(on);
    }
    match question(gather, weighting(gather, 0)) {
        Some(question) => search.kernel(on, &Question { error_moments: moments.into(), ..question }, format, ordered),
        None => closest::kernel(on, format, ordered),
    };
}

/// Requests the kernels of [`RadianceEstimator::neighbour_radius`].
pub(crate) fn announce_neighbours(on: &mut Vulkan, format: PhotonFormat, min_normal_cosine: f32) {
    search::sample_kernel(on, format);
    announce(on, &neighbours_of(1, min_normal_cosine), format, u64::from(neighbour_radius::SAMPLE), false);
}

/// The question of an estimate; `None` for the nearest photon, for which there is another kernel.
fn question(gather: &EstimateParams, shading: Weighting) -> Option<Question> {
    let question = radius_question(gather, shading);
    match gather.search {
        Search::Radius => Some(question),
        Search::KNearest { k } => Some(Question { mode: Mode::Nearest, k, ..question }),
        Search::NearestPhoton => None,
        Search::Paper { max, threshold, factor } => Some(Question {
            mode: Mode::Paper,
            kernel: Kernel::Constant,
            filter: true,
            k: max,
            parameter: factor,
            threshold,
            ..question
        }),
    }
}

/// A search for all photons within the radius.
fn radius_question(gather: &EstimateParams, shading: Weighting) -> Question {
    Question {
        mode: Mode::Radius,
        kernel: gather.kernel,
        filter: gather.min_normal_cosine > -1.0,
        flat: gather.is_flat(),
        shading,
        marked: gather.reflection && gather.marked,
        k: 0,
        radius: gather.radius_scale,
        min_cosine: gather.min_normal_cosine,
        max_plane_distance: gather.max_plane_distance,
        parameter: 0.0,
        threshold: 0,
        error_moments: 0,
    }
}

/// Checks a radius supplied by a caller.
fn check_radius(name: &'static str, radius: f32) -> Result<()> {
    if radius >= 0.0 {
        return Ok(());
    }
    Err(Error::InvalidSetting { name, value: radius.to_string(), hint: "must be at least 0" })
}

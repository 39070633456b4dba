//! Indirect light by final gathering (Jensen 1996).

use photon_core::{
    AreaProbe as _, ErrorMoments, Estimate, EstimateBuffers, Features, FinalGather, Layer, Maps, MediaFeatures, Pass,
    PhotonFormat, Query, RadianceEstimator, Result,
};

use crate::device::ComputePipeline;
use crate::device::buffer::VulkanBuffer;
use crate::film::{self, VulkanFilm};
use crate::scene::{SceneKind, VulkanScene};
use crate::shaders;
use crate::stages::area::VulkanArea;
use crate::stages::truncated::TruncatedPaths;
use crate::vulkan::Vulkan;

/// Invocations per workgroup.
const GROUP: u32 = 128;

/// Traces gather rays from the queries to the surfaces where the maps are read. The hits of the rays are
/// queries of their own, evaluated by the estimator.
pub(crate) struct VulkanGather {
    max_bounces: u32,
    estimator: Box<dyn RadianceEstimator<Vulkan>>,
    /// Divides estimates where rays land by the area on the surface.
    area: Option<VulkanArea>,
    landed: Option<(VulkanBuffer<Query>, VulkanBuffer<Estimate>)>,
    errors: Option<ErrorBuffers>,
    truncated: TruncatedPaths,
}

/// Error moments of each gather ray's hit, and their sums for each query.
struct ErrorBuffers {
    error_moments: VulkanBuffer<ErrorMoments>,
    queries: VulkanBuffer<ErrorMoments>,
}

parameters! {
    struct GatherPush => STAGES_FINAL_GATHER {
        scene: u64,
        queries: u64,
        landings: u64,
        seed: u64,
        pass: u32,
        rays: u32,
        start_ray: u32,
        count_rays: u32,
        start_query: u32,
        count_queries: u32,
        max_bounces: u32,
        padding: u32,
        truncated: u64,
    }
}

parameters! {
    struct GatheredPush => STAGES_FINAL_GATHER_SUM {
        landings: u64,
        estimates: u64,
        values: u64,
        error_moments: u64,
        errors: u64,
        count_rays: u32,
        start_query: u32,
        count_queries: u32,
        scale: f32,
        share: f32,
        padding: u32,
    }
}

specialized!(
    gather_constants: GatherConstants => STAGES_FINAL_GATHER,
    0 features: Features, 2 media: MediaFeatures; default shared_groups
);

specialized!(
    gathered_constants: GatheredConstants => STAGES_FINAL_GATHER_SUM, 2 error_moments: bool, 3 irradiance: bool
);

impl VulkanGather {
    /// Constructs a gatherer for paths of at most `max_bounces` surfaces; `estimator` reads the maps, and with `area` divides by
    /// the area on the surface.
    pub(crate) fn new(
        on: &mut Vulkan,
        max_bounces: u32,
        estimator: Box<dyn RadianceEstimator<Vulkan>>,
        area: Option<VulkanArea>,
    ) -> Result<Self> {
        let truncated = TruncatedPaths::new(on)?;
        Ok(Self { max_bounces, estimator, area, landed: None, errors: None, truncated })
    }
}

impl VulkanGather {
    /// Buffers for error moments, cleared for a pass; `None` if the film does not store errors.
    fn error_buffers(
        &mut self,
        on: &mut Vulkan,
        film: &VulkanFilm,
        landings: u64,
        queries: u64,
    ) -> Result<Option<ErrorBuffers>> {
        if !film.keeps_errors() {
            return Ok(None);
        }
        let fits =
            |errors: &ErrorBuffers| errors.error_moments.capacity() >= landings && errors.queries.capacity() >= queries;
        let errors = match self.errors.take().filter(fits) {
            Some(errors) => errors,
            None => ErrorBuffers {
                error_moments: VulkanBuffer::new(on, "gather spreads", landings)?,
                queries: VulkanBuffer::new(on, "gather errors", queries)?,
            },
        };
        on.fill_words(&errors.queries.data, 0, errors.queries.data.bytes(), 0)?;
        Ok(Some(errors))
    }
}

/// The kernel of the rays.
pub(crate) fn ray_kernel(on: &mut Vulkan, scene: &SceneKind) -> ComputePipeline {
    let constants = GatherConstants { features: scene.features, media: scene.media };
    on.kernel(&shaders::STAGES_FINAL_GATHER, GROUP, &constants)
}

/// The kernel that sums what rays find in a map, or as irradiance at points.
pub(crate) fn sum_kernel(on: &mut Vulkan, error_moments: bool, irradiance: bool) -> ComputePipeline {
    on.kernel(&shaders::STAGES_FINAL_GATHER_SUM, GROUP, &GatheredConstants { error_moments, irradiance })
}

/// Upper bound on the number of gather rays at a time.
pub(crate) fn most_rays(on: &Vulkan, queries: u64, rays: u32) -> u64 {
    u64::from(on.dispatch_limits.gather_rays).min(queries * u64::from(rays.max(1)))
}

impl FinalGather<Vulkan> for VulkanGather {
    fn gather(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        maps: &Maps<'_, Vulkan>,
        pass: Pass,
        queries: &VulkanBuffer<Query>,
        rays: u32,
        film: &mut VulkanFilm,
    ) -> Result<()> {
        let length = on.length(queries)?;
        let rays = rays.max(1);
        let truncated = self.truncated.start(on, scene.kind.features, false)?;
        if length == 0 || maps.paths.values().all(|&paths| paths == 0) {
            return Ok(());
        }
        let dispatch_limits = on.dispatch_limits;
        let room = most_rays(on, length, rays);
        let (mut landings, mut estimates) = match self.landed.take() {
            Some(landed) if landed.0.capacity() >= room => landed,
            _ => (VulkanBuffer::new(on, "gather rays", room)?, VulkanBuffer::new(on, "gather estimates", room)?),
        };
        film.clear_values(on, queries.capacity())?;
        let values = film.values_address(on, queries.capacity())?;
        let mut errors = self.error_buffers(on, film, room, queries.capacity())?;
        let follow = ray_kernel(on, &scene.kind);
        let add = sum_kernel(on, errors.is_some(), false);
        let each = maps.photons.iter();
        let mut asked: Vec<_> =
            each.filter_map(|(kind, map)| map.map(|map| (map, maps.paths[kind], add.clone()))).collect();
        // Points first: rays that find one ask no map.
        if let Some(irradiance) = maps.irradiance {
            asked.insert(0, (irradiance, 1, sum_kernel(on, errors.is_some(), true)));
        }
        // Process whole queries at a time, unless a single query has too many rays.
        let per_query = rays.min(dispatch_limits.gather_rays_of_query);
        let per_chunk = u64::from(dispatch_limits.gather_rays / per_query);
        for start_query in (0..length).step_by(per_chunk as usize) {
            let count_queries = per_chunk.min(length - start_query) as u32;
            for start_ray in (0..rays).step_by(per_query as usize) {
                let count_rays = per_query.min(rays - start_ray);
                let count = u64::from(count_queries) * u64::from(count_rays);
                let push = GatherPush {
                    scene: scene.address(),
                    queries: queries.data_address(),
                    landings: landings.data_address(),
                    seed: pass.seed,
                    pass: pass.index,
                    rays,
                    start_ray,
                    count_rays,
                    start_query: start_query as u32,
                    count_queries,
                    max_bounces: self.max_bounces,
                    padding: 0,
                    truncated,
                };
                on.dispatch(&follow, &push, count.div_ceil(u64::from(GROUP)))?;
                on.set_length(&mut landings, count)?;
                let push = GatheredPush {
                    landings: landings.data_address(),
                    estimates: estimates.data_address(),
                    values,
                    error_moments: errors.as_ref().map_or(0, |errors| errors.error_moments.data_address()),
                    errors: errors.as_ref().map_or(0, |errors| errors.queries.data_address()),
                    count_rays,
                    start_query: start_query as u32,
                    count_queries,
                    scale: 0.0,
                    share: 1.0 / rays as f32,
                    padding: 0,
                };
                for (nth, ((map, gather), paths, add)) in asked.iter().enumerate() {
                    let is_irradiance = nth == 0 && maps.irradiance.is_some();
                    match &mut errors {
                        None => self.estimator.estimate(on, map, &landings, gather, &mut estimates)?,
                        Some(ErrorBuffers { error_moments, .. }) => {
                            self.estimator.estimate_with_moments(
                                on,
                                map,
                                &landings,
                                gather,
                                &mut estimates,
                                error_moments,
                            )?;
                        }
                    }
                    // Points of irradiance have their areas already.
                    if let Some(area) = self.area.as_mut().filter(|_| !is_irradiance) {
                        let error_moments = errors.as_mut().map(|errors| &mut errors.error_moments);
                        let buffers = EstimateBuffers { estimates: &mut estimates, error_moments };
                        area.correct(on, scene, pass, &landings, gather, buffers)?;
                    }
                    let scale = (1.0 / (std::f64::consts::PI * (*paths).max(1) as f64 * f64::from(rays))) as f32;
                    on.dispatch(add, &GatheredPush { scale, ..push }, u64::from(count_queries.div_ceil(GROUP)))?;
                }
            }
        }
        self.landed = Some((landings, estimates));
        if let Some(errors) = errors {
            film::errors::accumulate_gathered(on, film, queries, &errors.queries)?;
            self.errors = Some(errors);
        }
        let pass = film.layer_address(on, Layer::Indirect)?;
        film::accumulate_values(on, film, pass, queries, 1)
    }

    fn truncated(&mut self, on: &mut Vulkan) -> Result<u64> {
        self.truncated.read(on)
    }

    fn required_format(&self) -> PhotonFormat {
        self.estimator.required_format()
    }
}

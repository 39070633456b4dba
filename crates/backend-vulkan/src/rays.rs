//! Ray queries for rays supplied by the caller: nearest hits and occlusion.

use photon_core::{Backend, Hit, Ray, Result, Stage};

use crate::device::{ComputePipeline, Memory};
use crate::scene::VulkanScene;
use crate::shaders;
use crate::vulkan::Vulkan;

/// How the ray kernel distributes rays over invocations. The results do not depend on it.
// Exhaustive: in `low_level`, which is not stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayPlan {
    /// Invocations per workgroup, a power of two.
    pub group: u32,
    /// Entries of each ray's traversal stack (groups of nodes) that are held in shared memory; the others are
    /// stored wherever the compiler puts them.
    pub shared_groups: u32,
    /// 0: one ray per invocation. Otherwise persistent invocations: each traces one ray after another and
    /// fetches a new one when fewer than this many of a subgroup are still tracing.
    pub busy: u32,
    /// Number of workgroups, used if `busy` is not 0.
    pub workgroups: u32,
}

impl RayPlan {
    /// A plan for the given subgroup size. On an NVIDIA H200, replacing finished rays makes tracing 2.2 to 2.5
    /// times as fast, the more the earlier they are replaced; shared memory gains nothing.
    #[must_use]
    pub fn for_subgroups(size: u32) -> Self {
        let busy = if size >= 16 { size / 4 * 3 } else { 0 };
        Self { group: 128, shared_groups: 0, busy, workgroups: 1056 }
    }
}

/// An invocation may take at most this multiple of the mean number of rays.
const MARGIN: u32 = 4;

host_struct! {
    /// `Line` of nearest.comp.
    struct Line {
        origin: [f32; 3],
        t_max: f32,
        direction: [f32; 3],
        reserved: u32,
    }
}

parameters! {
    struct Push => RAYS_NEAREST {
        scene: u64,
        lines: u64,
        hits: u64,
        counter: u64,
        count: u32,
        quota: u32,
    }
}

specialized!(nearest_constants: NearestConstants => RAYS_NEAREST, 2 shadow: bool, 3 busy: u32, 10 shared_groups: u32);

/// Rays on the device, and memory for their hits.
struct Cast {
    lines: Memory,
    hits: Memory,
    counter: Memory,
    count: u32,
}

impl Cast {
    fn new(on: &mut Vulkan, rays: &[Ray]) -> Result<Self> {
        let count = u32::try_from(rays.len()).map_err(|_| photon_core::Error::InvalidInput {
            what: "ray",
            index: rays.len() as u64,
            why: "more than 2^32 - 1 rays: cast them in several calls".to_owned(),
        })?;
        let lines = on.memory("rays", 32 * u64::from(count))?;
        const PART: usize = 1 << 20;
        for (part, rays) in rays.chunks(PART).enumerate() {
            let part_of: Vec<Line> = rays.iter().map(line).collect();
            on.write(&lines, (part * PART * 32) as u64, bytemuck::cast_slice(&part_of))?;
        }
        let (hits, counter) = (on.memory("hits", 16 * u64::from(count))?, on.memory("next ray", 4)?);
        Ok(Self { lines, hits, counter, count })
    }

    fn run(&self, on: &mut Vulkan, kernel: &ComputePipeline, scene: &VulkanScene, plan: RayPlan) -> Result<()> {
        let all = u64::from(self.count.div_ceil(plan.group));
        let workgroups = if plan.busy == 0 { all } else { all.min(u64::from(plan.workgroups.max(1))) };
        let push = Push {
            scene: scene.address(),
            lines: self.lines.address(),
            hits: self.hits.address(),
            counter: self.counter.address(),
            count: self.count,
            quota: MARGIN * (all.div_ceil(workgroups.max(1)) as u32),
        };
        if plan.busy != 0 {
            on.fill_words(&self.counter, 0, 4, 0)?;
        }
        on.dispatch(kernel, &push, workgroups)
    }

    /// Four words per ray: distance, triangle and two barycentric weights; the second word is all ones for a
    /// miss.
    fn read(&self, on: &mut Vulkan) -> Result<Vec<[u32; 4]>> {
        let mut words = vec![[0_u32; 4]; self.count as usize];
        on.read(&self.hits, 0, bytemuck::cast_slice_mut(&mut words))?;
        Ok(words)
    }
}

fn line(ray: &Ray) -> Line {
    Line { origin: ray.origin.into(), t_max: ray.t_max, direction: ray.direction.into(), reserved: 0 }
}

fn kernel(on: &mut Vulkan, shadow: bool, plan: RayPlan) -> ComputePipeline {
    let constants = NearestConstants { shadow, busy: plan.busy, shared_groups: plan.shared_groups };
    on.kernel(&shaders::RAYS_NEAREST, plan.group, &constants)
}

impl Vulkan {
    /// Returns the nearest hit of each ray, on either side of a triangle; of several hits at the same distance,
    /// the one with the lowest triangle index. As [`photon_core::RayCaster::nearest`], except that a ray within
    /// rounding error of the silhouette of a mesh (such as any edge of an isolated triangle) may hit or miss,
    /// depending on the precision of the device's division: see "Rays at edges" in `docs/studies/shaders.md`.
    /// No ray passes between triangles that share an edge.
    ///
    /// # Errors
    /// [`photon_core::Error::OutOfMemory`], [`photon_core::Error::InvalidInput`] for more rays than
    /// 2³² − 1.
    pub fn cast_rays(&mut self, scene: &VulkanScene, rays: &[Ray]) -> Result<Vec<Option<Hit>>> {
        let plan = RayPlan::for_subgroups(self.limits().subgroup_size);
        self.cast_rays_by(scene, rays, plan)
    }

    /// [`crate::low_level::cast_rays`].
    pub(crate) fn cast_rays_by(
        &mut self,
        scene: &VulkanScene,
        rays: &[Ray],
        plan: RayPlan,
    ) -> Result<Vec<Option<Hit>>> {
        let cast = Cast::new(self, rays)?;
        let kernel = kernel(self, false, plan);
        cast.run(self, &kernel, scene, plan)?;
        let float = f32::from_bits;
        let hit = |[t, primitive, u, v]: [u32; 4]| {
            (primitive != u32::MAX).then_some(Hit { t: float(t), primitive, u: float(u), v: float(v) })
        };
        Ok(cast.read(self)?.into_iter().map(hit).collect())
    }

    /// Returns whether each ray hits anything. As [`photon_core::RayCaster::occluded`].
    ///
    /// # Errors
    /// As [`Vulkan::cast_rays`].
    pub fn cast_shadow_rays(&mut self, scene: &VulkanScene, rays: &[Ray]) -> Result<Vec<bool>> {
        let plan = RayPlan::for_subgroups(self.limits().subgroup_size);
        let cast = Cast::new(self, rays)?;
        let kernel = kernel(self, true, plan);
        cast.run(self, &kernel, scene, plan)?;
        Ok(cast.read(self)?.into_iter().map(|[_, primitive, ..]| primitive != u32::MAX).collect())
    }

    /// [`crate::low_level::time_rays`].
    pub(crate) fn time_rays(
        &mut self,
        scene: &VulkanScene,
        rays: &[Ray],
        plans: &[RayPlan],
        rounds: u32,
    ) -> Result<Vec<Vec<f64>>> {
        let cast = Cast::new(self, rays)?;
        let mut seconds = vec![Vec::new(); plans.len()];
        let kernels = plans.iter().map(|&plan| kernel(self, false, plan)).collect::<Vec<_>>();
        // One extra round, a warm-up that is not counted.
        for round in 0..=rounds {
            for ((&plan, kernel), seconds) in plans.iter().zip(&kernels).zip(&mut seconds) {
                self.timings()?;
                self.mark(Some(Stage::Trace));
                cast.run(self, kernel, scene, plan)?;
                self.mark(None);
                let took = self.timings()?.get(Stage::Trace);
                if round > 0 {
                    seconds.push(took);
                }
            }
        }
        Ok(seconds)
    }
}

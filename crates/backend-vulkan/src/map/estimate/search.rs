//! Dispatches the search kernels of `shaders-glsl/search`, in portions.

use std::ops::Range;

use photon_core::{Error, Kernel, MediaFeatures, PhotonFormat, Query, Result};

use super::order::Order;
use super::pause::{PausedSearches, SUBGROUPS};
use crate::device::ComputePipeline;
use crate::device::buffer::VulkanBuffer;
use crate::map::VulkanMap;
use crate::shaders;
use crate::vulkan::Vulkan;

/// Subgroups per workgroup, for which shared memory is allocated. With more of them, all would wait for the
/// slowest.
const TILES: u32 = 1;

/// Maximum number of queries per dispatch, so that none runs for seconds even where every query finds a large
/// part of a million photons.
const PORTION: u64 = 1 << 19;

/// From this number on, queries are sorted: sorting costs less than sharing memory reads among neighbours
/// saves, even for queries in image row order.
const WORTH_ORDER: u64 = 1 << 15;

/// The largest k on a device that ends long loops: the limit at which one workgroup can still sort a row.
const MAX_PAUSING: u32 = 1 << 17;

/// Bins of 16 bits are sufficient up to this k.
const NARROW_BINS: u32 = 60_000;

/// What a kernel computes from the photons found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// An estimate from all photons within a radius.
    Radius,
    /// An estimate from the k nearest photons.
    Nearest,
    /// An estimate from the k nearest photons, as in the paper.
    Paper,
    /// The ids of the k nearest photons, unsorted.
    Rows,
    /// The number of photons within a radius.
    Count,
    /// An estimate from all photons within a radius of a segment.
    Segment,
}

/// What the power of photons is multiplied by: `SHADING` of the kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weighting {
    /// 1.
    Even,
    /// The cosine to the query's shading normal, over that to the geometric one.
    Cosine,
    /// The reflection of the query; the address of the albedo table.
    Reflection(u64),
    /// The same, which may be anisotropic.
    Anisotropic(u64),
    /// The same, which may be that of a sheen; the table of its albedos follows.
    Sheen(u64),
    /// The phase function and the transmittance of a medium; the address of the scene, and features of its media.
    Medium(u64, MediaFeatures),
}

impl Weighting {
    fn number(self) -> u32 {
        match self {
            Self::Even | Self::Medium(..) => 0,
            Self::Cosine => 1,
            Self::Reflection(_) => 2,
            Self::Anisotropic(_) => 3,
            Self::Sheen(_) => 4,
        }
    }

    /// Features of media.
    fn media(self) -> MediaFeatures {
        if let Self::Medium(_, media) = self { media } else { MediaFeatures::NONE }
    }

    /// Address of the table of albedos, or of the scene; 0 without one.
    fn albedos(self) -> u64 {
        match self {
            Self::Even | Self::Cosine => 0,
            Self::Reflection(table) | Self::Anisotropic(table) | Self::Sheen(table) | Self::Medium(table, _) => table,
        }
    }
}

/// Parameters of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Question {
    pub(super) mode: Mode,
    pub(super) kernel: Kernel,
    /// Whether photons are rejected by their normal or direction.
    pub(super) filter: bool,
    /// Whether photons are rejected by their distance from the query's plane.
    pub(super) flat: bool,
    /// Factors on the power of photons.
    pub(super) shading: Weighting,
    /// [`photon_core::EstimateParams::marked`].
    pub(super) marked: bool,
    pub(super) k: u32,
    /// Rows and counts: the radius. Otherwise a factor on every query's radius.
    pub(super) radius: f32,
    pub(super) min_cosine: f32,
    /// As a fraction of the radius.
    pub(super) max_plane_distance: f32,
    /// The cone's slope, or the factor of the paper's filter.
    pub(super) parameter: f32,
    pub(super) threshold: u32,
    /// Address where each estimate's `ErrorMoments` are written; 0: none are computed.
    pub(super) error_moments: u64,
}

parameters! {
    /// Parameters of `search_map.glsl`.
    struct Push => SEARCH_COUNT SEARCH_K_NEAREST SEARCH_RADIUS SEARCH_SEGMENT {
        nodes: u64,
        totals: u64,
        positions: u64,
        power: u64,
        ids: u64,
        error_moments: u64,
        queries: u64,
        query_count: u64,
        results: u64,
        result_count: u64,
        order: u64,
        pauses: u64,
        albedos: u64,
        points: u32,
        first: u32,
        end: u32,
        k: u32,
        radius: f32,
        min_cosine: f32,
        parameter: f32,
        threshold: u32,
        capacity: u32,
        max_plane_distance: f32,
    }
}

parameters! {
    /// Parameters of `search/sample.comp`.
    struct SamplePush => SEARCH_SAMPLE {
        photons: u64,
        queries: u64,
        points: u32,
        count: u32,
        radius: f32,
        reserved: u32,
    }
}

specialized!(
    radius_constants: RadiusConstants => SEARCH_RADIUS,
    2 tiles: u32, 3 ordered: bool, 4 kernel: u32, 5 filter: bool, 6 error_moments: bool, 7 flat: bool, 8 turns: u32,
    9 format: PhotonFormat, 10 shading: u32, 11 marked: bool
);

specialized!(
    nearest_constants: NearestConstants => SEARCH_K_NEAREST,
    2 tiles: u32, 3 ordered: bool, 4 kernel: u32, 5 filter: bool, 6 mode: u32, 7 wide: bool, 8 turns: u32,
    9 format: PhotonFormat, 10 shading: u32, 11 marked: bool
);

specialized!(
    count_constants: CountConstants => SEARCH_COUNT, 2 tiles: u32, 3 ordered: bool, 8 turns: u32; default format
);

specialized!(
    segment_constants: SegmentConstants => SEARCH_SEGMENT,
    2 tiles: u32, 3 ordered: bool, 4 kernel: u32, 5 media: MediaFeatures, 6 error_moments: bool, 8 turns: u32,
    9 format: PhotonFormat;
    default shared_groups
);

specialized!(sample_constants: SampleConstants => SEARCH_SAMPLE, 2 format: PhotonFormat);

/// Runs searches on maps.
#[derive(Debug)]
pub(super) struct MapSearch {
    /// Largest k for which bins have 16 bits.
    pub(super) narrow_bins: u32,
    /// Number of queries from which on they are sorted.
    pub(super) worth_order: u64,
    /// Loop iterations after which a search pauses; 0 for half of what the device allows, if it has a limit.
    pub(super) turns: u32,
    pub(super) order: Option<Order>,
    pub(super) paused: PausedSearches,
}

/// Invocations per workgroup.
fn workgroup(on: &Vulkan) -> u32 {
    (TILES * on.limits().subgroup_size.max(1)).min(on.limits().max_workgroup)
}

impl Default for MapSearch {
    fn default() -> Self {
        Self {
            narrow_bins: NARROW_BINS,
            worth_order: WORTH_ORDER,
            turns: 0,
            order: None,
            paused: PausedSearches::default(),
        }
    }
}

impl MapSearch {
    /// Address of the order in which to process `queries`, for [`MapSearch::ask`]; 0 for their own order.
    pub(super) fn order(&mut self, on: &mut Vulkan, map: &VulkanMap, queries: &VulkanBuffer<Query>) -> Result<u64> {
        if map.node_count == 0 || !self.is_worth_order(queries.capacity()) {
            return Ok(0);
        }
        let order = match &mut self.order {
            Some(order) => order,
            none => none.insert(Order::new(on)?),
        };
        order.of(on, map, queries)
    }

    /// Whether this many queries are processed in an order of their own.
    pub(super) fn is_worth_order(&self, queries: u64) -> bool {
        queries >= self.worth_order
    }

    /// Loop iterations after which a search pauses; 0: never.
    fn turns(&self, on: &Vulkan) -> u32 {
        // The other half is reserved for loops outside of the traversal.
        if self.turns > 0 { self.turns } else { on.limits().loop_turns / 2 }
    }

    /// The kernel for a question to maps of this format; `ordered`: whether queries are processed in an order of their own.
    pub(super) fn kernel(
        &self,
        on: &mut Vulkan,
        question: &Question,
        format: PhotonFormat,
        ordered: bool,
    ) -> ComputePipeline {
        let (workgroup, turns) = (workgroup(on), self.turns(on));
        match question.mode {
            Mode::Radius => {
                let constants = RadiusConstants {
                    tiles: TILES,
                    ordered,
                    kernel: question.kernel.number(),
                    filter: question.filter,
                    error_moments: question.error_moments != 0,
                    flat: question.flat,
                    turns,
                    format,
                    shading: question.shading.number(),
                    marked: question.marked,
                };
                on.kernel(&shaders::SEARCH_RADIUS, workgroup, &constants)
            }
            Mode::Count => {
                on.kernel(&shaders::SEARCH_COUNT, workgroup, &CountConstants { tiles: TILES, ordered: false, turns })
            }
            Mode::Segment => {
                let constants = SegmentConstants {
                    tiles: TILES,
                    ordered: false,
                    kernel: question.kernel.number(),
                    media: question.shading.media(),
                    error_moments: question.error_moments != 0,
                    turns,
                    format,
                };
                on.kernel(&shaders::SEARCH_SEGMENT, workgroup, &constants)
            }
            Mode::Nearest | Mode::Paper | Mode::Rows => {
                let constants = NearestConstants {
                    tiles: TILES,
                    ordered,
                    kernel: question.kernel.number(),
                    filter: question.filter,
                    mode: question.mode as u32 - Mode::Nearest as u32,
                    wide: question.k > self.narrow_bins,
                    turns,
                    format,
                    shading: question.shading.number(),
                    marked: question.marked,
                };
                on.kernel(&shaders::SEARCH_K_NEAREST, workgroup, &constants)
            }
        }
    }

    /// Evaluates the queries in `range`; `results` are the address of the results, the address of their count,
    /// and the capacity. Results are stored at the index of their query, except rows, which are stored in
    /// processing order from the range's start on. `order` is the address of the processing order, or 0 for the
    /// order of the queries.
    pub(super) fn ask(
        &mut self,
        on: &mut Vulkan,
        map: &VulkanMap,
        (queries, range): (&VulkanBuffer<Query>, Range<u64>),
        question: &Question,
        order: u64,
        (results, result_count, capacity): (u64, u64, u64),
    ) -> Result<()> {
        let workgroup = workgroup(on);
        // An empty map must not be traversed.
        let points = if map.node_count == 0 { 0 } else { map.length };
        let ordered = order != 0;
        let turns = self.turns(on);
        if turns > 0 && on.limits().loop_turns > 0 && question.k > MAX_PAUSING {
            let hint = "must be at most 131072 on this device, whose driver limits loop iterations";
            return Err(Error::InvalidSetting { name: "k", value: question.k.to_string(), hint });
        }
        let kernel = self.kernel(on, question, map.photon_format(), ordered);
        let span = u64::from(workgroup);
        let mut push = Push {
            nodes: map.nodes.address(),
            totals: map.totals.address(),
            positions: map.positions.address(),
            power: map.power.address(),
            ids: map.ids.address(),
            error_moments: question.error_moments,
            queries: queries.data_address(),
            query_count: queries.count_address(),
            results,
            result_count,
            order,
            pauses: 0,
            albedos: question.shading.albedos(),
            points,
            first: 0,
            end: 0,
            k: question.k,
            radius: question.radius,
            min_cosine: question.min_cosine,
            parameter: question.parameter,
            threshold: question.threshold,
            capacity: capacity.min(u64::from(u32::MAX)) as u32,
            max_plane_distance: question.max_plane_distance,
        };
        let portion = if turns > 0 { span * (SUBGROUPS / u64::from(TILES)) } else { PORTION / span * span };
        let paused = &mut self.paused;
        let mut all = |on: &mut Vulkan| {
            // Even without queries, a count must be written.
            for first in (range.start..range.end.max(range.start + 1)).step_by(portion as usize) {
                let end = range.end.min(first + portion);
                let groups = (end - first).div_ceil(span).max(1);
                (push.first, push.end) = (first as u32, end as u32);
                if question.mode == Mode::Rows {
                    push.results = results + (first - range.start) * u64::from(question.k) * 8;
                }
                if turns > 0 {
                    push.pauses = paused.room(on, groups * span)?;
                    paused.all(on, |on| on.dispatch(&kernel, &push, groups))?;
                } else {
                    on.dispatch(&kernel, &push, groups)?;
                }
            }
            Ok(())
        };
        if turns > 0 { all(on) } else { on.unordered(all) }
    }
}

/// The kernel of [`sample`].
pub(super) fn sample_kernel(on: &mut Vulkan, format: PhotonFormat) -> ComputePipeline {
    on.kernel(&shaders::SEARCH_SAMPLE, 64, &SampleConstants { format })
}

/// Fills `queries` with the positions of `count` photons, sampled evenly in the order in which they were
/// stored.
pub(super) fn sample(
    on: &mut Vulkan,
    map: &VulkanMap,
    queries: &VulkanBuffer<Query>,
    count: u32,
    radius: f32,
) -> Result<()> {
    let (photons, queries) = (map.photons.data_address(), queries.data_address());
    let kernel = sample_kernel(on, map.photon_format());
    on.dispatch(
        &kernel,
        &SamplePush { photons, queries, points: map.length, count, radius, reserved: 0 },
        u64::from(count.div_ceil(64)),
    )
}

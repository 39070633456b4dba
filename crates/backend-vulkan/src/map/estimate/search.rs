//! Dispatching searches: what the kernels of `shaders-glsl/search` are asked, and in which portions.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use photon_core::{Error, Kernel, Query, Result};

use super::order::Order;
use super::pause::{PausedSearches, SUBGROUPS};
use crate::device::buffer::VulkanBuffer;
use crate::map::VulkanMap;
use crate::shaders;
use crate::vulkan::Vulkan;

/// Subgroups of a workgroup: what shared memory is reserved for. More of them wait for the slowest.
const TILES: u32 = 1;

/// Queries of a dispatch at most, so that none runs for seconds even where every query finds a large
/// part of a million photons.
const PORTION: u64 = 1 << 19;

/// From so many on, queries are taken in an order of our own: sorting them costs less than what tiles of
/// neighbours save, a picture's rows included.
const WORTH_ORDER: u64 = 1 << 15;

/// The largest k on a device that ends long loops: what sorting a row in one workgroup has turns for.
const MAX_PAUSING: u32 = 1 << 17;

/// Bins of 16 bits serve up to here.
const NARROW_BINS: u32 = 60_000;

/// What a kernel makes of the photons found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// An estimate from all within a radius.
    Radius,
    /// An estimate from the k nearest.
    Nearest,
    /// The same as in the paper.
    Paper,
    /// Rows of the k nearest, not in order.
    Rows,
    /// How many there are within a radius.
    Count,
}

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Question {
    pub(super) mode: Mode,
    pub(super) kernel: Kernel,
    /// Whether photons are turned away for their normal or direction.
    pub(super) filter: bool,
    /// Whether they are turned away for their distance from the query's plane.
    pub(super) flat: bool,
    pub(super) k: u32,
    /// Rows and counts: the radius. Otherwise a factor on every query's.
    pub(super) radius: f32,
    pub(super) min_cosine: f32,
    /// In shares of the radius.
    pub(super) max_plane_distance: f32,
    /// The cone's slope, or the paper's factor.
    pub(super) parameter: f32,
    pub(super) threshold: u32,
    /// Where each estimate's `ErrorMoments` goes; 0: none is told.
    pub(super) error_moments: u64,
}

/// The push constants of `search_map.glsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Push {
    nodes: u64,
    totals: u64,
    positions: u64,
    power: u64,
    ids: u64,
    queries: u64,
    query_count: u64,
    results: u64,
    result_count: u64,
    order: u64,
    pauses: u64,
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

pushed!(
    push_layout: Push => SEARCH_COUNT SEARCH_K_NEAREST SEARCH_RADIUS,
    nodes totals positions power ids queries query_count results result_count order pauses points first end k radius
    min_cosine parameter threshold capacity max_plane_distance
);

/// The push constants of `search/sample.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct SamplePush {
    photons: u64,
    queries: u64,
    points: u32,
    count: u32,
    radius: f32,
    reserved: u32,
}

pushed!(sample_push_layout: SamplePush => SEARCH_SAMPLE, photons queries points count radius reserved);

/// Asks maps.
#[derive(Debug)]
pub(super) struct MapSearch {
    /// Up to which k bins have 16 bits.
    pub(super) narrow_bins: u32,
    /// From how many on queries are sorted.
    pub(super) worth_order: u64,
    /// Turns of loops after which a search pauses; 0 for half of what the device allows, if it has a limit.
    pub(super) turns: u32,
    pub(super) order: Option<Order>,
    pub(super) paused: PausedSearches,
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
    /// The order in which to take `queries`, for [`MapSearch::ask`].
    pub(super) fn order(&mut self, on: &mut Vulkan, map: &VulkanMap, queries: &VulkanBuffer<Query>) -> Result<u64> {
        if map.node_count == 0 || queries.capacity() < self.worth_order {
            return Ok(0);
        }
        let order = match &mut self.order {
            Some(order) => order,
            none => none.insert(Order::new(on)?),
        };
        order.of(on, map, queries)
    }

    /// Asks at those of the queries in `range`; `results` are the addresses of what is written and of
    /// its count, and how many fit. Results stand where their queries do, but rows in the order in which
    /// queries are taken, from the range's start on: `order`, or 0 to take them as they stand.
    pub(super) fn ask(
        &mut self,
        on: &mut Vulkan,
        map: &VulkanMap,
        (queries, range): (&VulkanBuffer<Query>, Range<u64>),
        question: &Question,
        order: u64,
        (results, result_count, capacity): (u64, u64, u64),
    ) -> Result<()> {
        let subgroup = u64::from(on.limits().subgroup_size.max(1));
        let workgroup = (TILES * subgroup as u32).min(on.limits().max_workgroup);
        // An empty map has nothing that could be asked.
        let points = if map.node_count == 0 { 0 } else { map.length };
        let ordered = u32::from(order != 0);
        // The rest is for what a search does outside of its walks.
        let turns = if self.turns > 0 { self.turns } else { on.limits().loop_turns / 2 };
        if turns > 0 && on.limits().loop_turns > 0 && question.k > MAX_PAUSING {
            let hint = "must be at most 131072 on this device, whose driver ends long loops";
            return Err(Error::InvalidSetting { name: "k", value: question.k.to_string(), hint });
        }
        let format = map.photon_format().number();
        let kernel = match question.mode {
            Mode::Radius => {
                let filter = u32::from(question.filter);
                let moments = u32::from(question.error_moments != 0);
                let flat = u32::from(question.flat);
                let kernel = question.kernel.number();
                let constants = [0, workgroup, TILES, ordered, kernel, filter, moments, flat, turns, format];
                on.kernel(&shaders::SEARCH_RADIUS, &constants)?
            }
            Mode::Count => on.kernel(&shaders::SEARCH_COUNT, &[0, workgroup, TILES, 0, 0, 0, 0, 0, turns])?,
            Mode::Nearest | Mode::Paper | Mode::Rows => {
                let mode = question.mode as u32 - Mode::Nearest as u32;
                let (filter, wide) = (u32::from(question.filter), u32::from(question.k > self.narrow_bins));
                let constants =
                    [0, workgroup, TILES, ordered, question.kernel.number(), filter, mode, wide, turns, format];
                on.kernel(&shaders::SEARCH_K_NEAREST, &constants)?
            }
        };
        let span = u64::from(workgroup);
        let mut push = Push {
            nodes: map.nodes.address(),
            totals: map.totals.address(),
            positions: map.positions.address(),
            power: map.power.address(),
            ids: if question.error_moments == 0 { map.ids.address() } else { question.error_moments },
            queries: queries.data_address(),
            query_count: queries.count_address(),
            results,
            result_count,
            order,
            pauses: 0,
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
            // Without any query there is still a count to be written.
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

/// Fills `queries` with `count` photons' places, spread evenly over the order in which they were stored.
pub(super) fn sample(
    on: &mut Vulkan,
    map: &VulkanMap,
    queries: &VulkanBuffer<Query>,
    count: u32,
    radius: f32,
) -> Result<()> {
    let (photons, queries) = (map.photons.data_address(), queries.data_address());
    let kernel = on.kernel(&shaders::SEARCH_SAMPLE, &[0, 64, map.photon_format().number()])?;
    on.dispatch(
        &kernel,
        &SamplePush { photons, queries, points: map.length, count, radius, reserved: 0 },
        u64::from(count.div_ceil(64)),
    )
}

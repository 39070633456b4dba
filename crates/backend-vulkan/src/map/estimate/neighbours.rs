//! Neighbour searches, usable without the rest of the pipeline.

use photon_core::{Backend, Kernel, Query, Result};

use super::check_radius;
use super::search::{MapSearch, Mode, Question, Weighting};
use crate::device::buffer::VulkanBuffer;
use crate::map::VulkanMap;
use crate::shaders;
use crate::vulkan::Vulkan;

/// Size in bytes of the rows sorted at a time.
const ROWS: u64 = 256 << 20;

/// Maximum number of keys sorted in shared memory: 16 KiB.
const ROOM: u32 = 2048;

/// Minimum number of keys in shared memory: short rows share a workgroup.
const MIN_ROOM: u32 = 512;

parameters! {
    /// Parameters of `search/order.comp`.
    struct OrderPush => SEARCH_ORDER {
        rows: u64,
        ids: u64,
        order: u64,
        first: u32,
        count: u32,
        k: u32,
        room: u32,
    }
}

specialized!(order_constants: OrderConstants => SEARCH_ORDER, 2 room: u32, 3 ordered: bool);

impl Vulkan {
    /// Finds the `k` nearest photons of every query within `max_radius`, which may be infinite, regardless of
    /// normals. Returns one row per query: photon indices in the order in which the photons were stored,
    /// nearest first, ties by lower index, padded with `u32::MAX` if there are fewer. Only the positions of the
    /// queries are used.
    ///
    /// Distances are compared as `(dx·dx + dy·dy) + dz·dz` and `max_radius·max_radius` in `f32`: rows are equal
    /// to those of `backend_cpu::index::PointIndex::nearest_many`.
    ///
    /// # Errors
    /// [`photon_core::Error::InvalidSetting`] for a radius below 0 or NaN, [`photon_core::Error::OutOfMemory`],
    /// errors of [`photon_core::Backend::fill`].
    pub fn nearest(
        &mut self,
        map: &VulkanMap,
        queries: &VulkanBuffer<Query>,
        k: u32,
        max_radius: f32,
    ) -> Result<VulkanBuffer<u32>> {
        self.nearest_sorted(map, queries, k, max_radius, MapSearch::default())
    }

    /// The same with a given search.
    pub(super) fn nearest_sorted(
        &mut self,
        map: &VulkanMap,
        queries: &VulkanBuffer<Query>,
        k: u32,
        max_radius: f32,
        mut search: MapSearch,
    ) -> Result<VulkanBuffer<u32>> {
        check_radius("max_radius", max_radius)?;
        let count = self.fill_of(queries)?;
        let mut ids = VulkanBuffer::<u32>::new(self, "neighbours", count.saturating_mul(u64::from(k)))?;
        if count > 0 && k > 0 {
            // The index of a key within a portion is a 32-bit word.
            let portion = (ROWS / (8 * u64::from(k))).clamp(1, count);
            let rows = self.memory("rows", portion * u64::from(k) * 8)?;
            let room = k.checked_next_power_of_two().unwrap_or(1 << 31).max(32);
            let in_shared = room.clamp(MIN_ROOM, ROOM);
            let threads = (in_shared / 2).min(256).min(self.limits().max_workgroup);
            let rows_each = u64::from((in_shared / room).max(1));
            let order = search.order(self, map, queries)?;
            let sort =
                self.kernel(&shaders::SEARCH_ORDER, threads, &OrderConstants { room: in_shared, ordered: order != 0 });
            let mut first = 0;
            while first < count {
                let end = count.min(first + portion);
                let question = question(Mode::Rows, k, max_radius);
                search.ask(self, map, (queries, first..end), &question, order, (rows.address(), 0, 0))?;
                let push = OrderPush {
                    rows: rows.address(),
                    ids: ids.data_address(),
                    order,
                    first: first as u32,
                    count: (end - first) as u32,
                    k,
                    room,
                };
                self.dispatch(&sort, &push, (end - first).div_ceil(rows_each))?;
                first = end;
            }
        }
        self.set_length(&mut ids, count * u64::from(k))?;
        Ok(ids)
    }

    /// Counts the photons within `radius` of each query, boundary included, regardless of normals.
    ///
    /// # Errors
    /// As [`Vulkan::nearest`].
    pub fn count_within(
        &mut self,
        map: &VulkanMap,
        queries: &VulkanBuffer<Query>,
        radius: f32,
    ) -> Result<VulkanBuffer<u32>> {
        self.count_paused(map, queries, radius, MapSearch::default())
    }

    /// The same with a given search.
    pub(super) fn count_paused(
        &mut self,
        map: &VulkanMap,
        queries: &VulkanBuffer<Query>,
        radius: f32,
        mut search: MapSearch,
    ) -> Result<VulkanBuffer<u32>> {
        check_radius("radius", radius)?;
        let count = self.fill_of(queries)?;
        let mut counts = VulkanBuffer::<u32>::new(self, "counts", count)?;
        if count > 0 {
            let question = question(Mode::Count, 0, radius);
            search.ask(self, map, (queries, 0..count), &question, 0, (counts.data_address(), 0, count))?;
        }
        self.set_length(&mut counts, count)?;
        Ok(counts)
    }

    /// Uploads queries at the given points, for [`Vulkan::nearest`] and [`Vulkan::count_within`].
    ///
    /// # Errors
    /// [`photon_core::Error::OutOfMemory`].
    pub fn queries_at(&mut self, points: &[[f32; 3]]) -> Result<VulkanBuffer<Query>> {
        let queries: Vec<Query> = points.iter().map(|&position| Query { position, ..Query::default() }).collect();
        self.upload("queries", &queries)
    }

    fn fill_of(&mut self, queries: &VulkanBuffer<Query>) -> Result<u64> {
        Ok(Backend::fill(self, queries)?.length)
    }
}

fn question(mode: Mode, k: u32, radius: f32) -> Question {
    Question {
        mode,
        kernel: Kernel::Constant,
        filter: false,
        flat: false,
        shading: Weighting::Even,
        marked: false,
        k,
        radius,
        min_cosine: -1.0,
        max_plane_distance: 1.0,
        parameter: 1.0,
        threshold: 0,
        error_moments: 0,
    }
}

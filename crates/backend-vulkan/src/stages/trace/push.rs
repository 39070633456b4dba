//! Push and specialization constants of the kernels of photon tracing.

use photon_core::{Features, MediaFeatures};

use super::scratch::MAPS;

host_struct! {
    /// `Chunk` of trace.comp.
    pub(super) struct Chunk {
        pub(super) stored: u64,
        pub(super) endings: u64,
        pub(super) states: u64,
        pub(super) seed: [u32; 2],
        pub(super) pass: u32,
        pub(super) first: u32,
        pub(super) count: u32,
        pub(super) pad: u32,
    }
}

parameters! {
    pub(super) struct TracePush => STAGES_TRACE {
        pub(super) chunk: u64,
        pub(super) scene: u64,
        pub(super) rays: u64,
        pub(super) photons: u64,
        pub(super) owners: u64,
        pub(super) place: u64,
        pub(super) now: u64,
        pub(super) then: u64,
        pub(super) waiting: u64,
        pub(super) left: u64,
        pub(super) quota: u32,
        pub(super) surfaces: u32,
        pub(super) begins: u32,
        pub(super) places: u32,
        pub(super) max_bounces: u32,
        pub(super) pad: u32,
    }
}

parameters! {
    pub(super) struct TallyPush => STAGES_TALLY {
        pub(super) rays: u64,
        pub(super) endings: u64,
        pub(super) stored: u64,
        pub(super) sums: u64,
        pub(super) first: u32,
        pub(super) count: u32,
    }
}

parameters! {
    pub(super) struct ScatterPush => STAGES_TRACE_REORDER {
        pub(super) photons: u64,
        pub(super) owners: u64,
        pub(super) offsets: u64,
        pub(super) cursors: u64,
        pub(super) to: [u64; MAPS],
        pub(super) fills: [u64; MAPS],
        pub(super) count: u32,
        pub(super) places: u32,
    }
}

parameters! {
    pub(super) struct AdvancePush => STAGES_TRACE_ADVANCE {
        pub(super) totals: u64,
        pub(super) needed: [u64; MAPS],
    }
}

specialized!(
    trace_constants: TraceConstants => STAGES_TRACE,
    0 features: Features, 2 random: u32, 3 wanted: u32, 4 dynamic: bool, 5 busy: u32, 6 aimed: bool,
    7 media: MediaFeatures, 8 reflections: bool, 10 shared_groups: u32, 11 all_lights: bool
);

specialized!(tally_constants: TallyConstants => STAGES_TALLY, 3 wanted: u32);

specialized!(reorder_constants: ReorderConstants => STAGES_TRACE_REORDER, 2 format: u32);

specialized!(advance_constants: AdvanceConstants => STAGES_TRACE_ADVANCE, 3 wanted: u32);

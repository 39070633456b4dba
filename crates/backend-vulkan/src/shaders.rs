//! The compiled shaders. Written by `cargo xtask shaders`.

use crate::device::Module;

pub(crate) static CAMERA_AREA: Module =
    Module { name: "camera_area", bytes: include_bytes!("../spirv/camera_area.spv") };

pub(crate) static CAMERA_COMPACT: Module =
    Module { name: "camera_compact", bytes: include_bytes!("../spirv/camera_compact.spv") };

pub(crate) static CAMERA_DIRECT: Module =
    Module { name: "camera_direct", bytes: include_bytes!("../spirv/camera_direct.spv") };

pub(crate) static CAMERA_EYE: Module = Module { name: "camera_eye", bytes: include_bytes!("../spirv/camera_eye.spv") };

pub(crate) static CAMERA_GATHER: Module =
    Module { name: "camera_gather", bytes: include_bytes!("../spirv/camera_gather.spv") };

pub(crate) static CAMERA_GATHERED: Module =
    Module { name: "camera_gathered", bytes: include_bytes!("../spirv/camera_gathered.spv") };

pub(crate) static CAMERA_RADII: Module =
    Module { name: "camera_radii", bytes: include_bytes!("../spirv/camera_radii.spv") };

pub(crate) static CAMERA_SETTLE: Module =
    Module { name: "camera_settle", bytes: include_bytes!("../spirv/camera_settle.spv") };

pub(crate) static DEVICE_COPY: Module =
    Module { name: "device_copy", bytes: include_bytes!("../spirv/device_copy.spv") };

pub(crate) static EXAMPLE_PHOTONS: Module =
    Module { name: "example_photons", bytes: include_bytes!("../spirv/example_photons.spv") };

pub(crate) static FILM_ACCUMULATE: Module =
    Module { name: "film_accumulate", bytes: include_bytes!("../spirv/film_accumulate.spv") };

pub(crate) static FILM_END: Module = Module { name: "film_end", bytes: include_bytes!("../spirv/film_end.spv") };

pub(crate) static FILM_END_ERRORS: Module =
    Module { name: "film_end_errors", bytes: include_bytes!("../spirv/film_end_errors.spv") };

pub(crate) static FILM_ERRORS: Module =
    Module { name: "film_errors", bytes: include_bytes!("../spirv/film_errors.spv") };

pub(crate) static GATHER_CLOSEST: Module =
    Module { name: "gather_closest", bytes: include_bytes!("../spirv/gather_closest.spv") };

pub(crate) static GATHER_CODES: Module =
    Module { name: "gather_codes", bytes: include_bytes!("../spirv/gather_codes.spv") };

pub(crate) static GATHER_COUNT: Module =
    Module { name: "gather_count", bytes: include_bytes!("../spirv/gather_count.spv") };

pub(crate) static GATHER_IRRADIANCE: Module =
    Module { name: "gather_irradiance", bytes: include_bytes!("../spirv/gather_irradiance.spv") };

pub(crate) static GATHER_NEAREST: Module =
    Module { name: "gather_nearest", bytes: include_bytes!("../spirv/gather_nearest.spv") };

pub(crate) static GATHER_ORDER: Module =
    Module { name: "gather_order", bytes: include_bytes!("../spirv/gather_order.spv") };

pub(crate) static GATHER_PLACES: Module =
    Module { name: "gather_places", bytes: include_bytes!("../spirv/gather_places.spv") };

pub(crate) static GATHER_RADIUS: Module =
    Module { name: "gather_radius", bytes: include_bytes!("../spirv/gather_radius.spv") };

pub(crate) static GATHER_SAMPLE: Module =
    Module { name: "gather_sample", bytes: include_bytes!("../spirv/gather_sample.spv") };

pub(crate) static INDEX_ARRANGE: Module =
    Module { name: "index_arrange", bytes: include_bytes!("../spirv/index_arrange.spv") };

pub(crate) static INDEX_BOUNDS: Module =
    Module { name: "index_bounds", bytes: include_bytes!("../spirv/index_bounds.spv") };

pub(crate) static INDEX_CODES: Module =
    Module { name: "index_codes", bytes: include_bytes!("../spirv/index_codes.spv") };

pub(crate) static INDEX_GATHER: Module =
    Module { name: "index_gather", bytes: include_bytes!("../spirv/index_gather.spv") };

pub(crate) static INDEX_KEYS: Module = Module { name: "index_keys", bytes: include_bytes!("../spirv/index_keys.spv") };

pub(crate) static INDEX_LONG_RUNS: Module =
    Module { name: "index_long_runs", bytes: include_bytes!("../spirv/index_long_runs.spv") };

pub(crate) static INDEX_MEDIAN_COUNT: Module =
    Module { name: "index_median_count", bytes: include_bytes!("../spirv/index_median_count.spv") };

pub(crate) static INDEX_MEDIAN_FINISH: Module =
    Module { name: "index_median_finish", bytes: include_bytes!("../spirv/index_median_finish.spv") };

pub(crate) static INDEX_MEDIAN_PART: Module =
    Module { name: "index_median_part", bytes: include_bytes!("../spirv/index_median_part.spv") };

pub(crate) static INDEX_MEDIAN_SIDES: Module =
    Module { name: "index_median_sides", bytes: include_bytes!("../spirv/index_median_sides.spv") };

pub(crate) static INDEX_PARENTS: Module =
    Module { name: "index_parents", bytes: include_bytes!("../spirv/index_parents.spv") };

pub(crate) static INDEX_PICK: Module = Module { name: "index_pick", bytes: include_bytes!("../spirv/index_pick.spv") };

pub(crate) static INDEX_REFINE: Module =
    Module { name: "index_refine", bytes: include_bytes!("../spirv/index_refine.spv") };

pub(crate) static INDEX_VVH_BOXES: Module =
    Module { name: "index_vvh_boxes", bytes: include_bytes!("../spirv/index_vvh_boxes.spv") };

pub(crate) static INDEX_VVH_COLLAPSE: Module =
    Module { name: "index_vvh_collapse", bytes: include_bytes!("../spirv/index_vvh_collapse.spv") };

pub(crate) static INDEX_VVH_COUNT: Module =
    Module { name: "index_vvh_count", bytes: include_bytes!("../spirv/index_vvh_count.spv") };

pub(crate) static INDEX_VVH_FINISH: Module =
    Module { name: "index_vvh_finish", bytes: include_bytes!("../spirv/index_vvh_finish.spv") };

pub(crate) static INDEX_VVH_PART: Module =
    Module { name: "index_vvh_part", bytes: include_bytes!("../spirv/index_vvh_part.spv") };

pub(crate) static INDEX_VVH_PLAN: Module =
    Module { name: "index_vvh_plan", bytes: include_bytes!("../spirv/index_vvh_plan.spv") };

pub(crate) static INDEX_VVH_SIDES: Module =
    Module { name: "index_vvh_sides", bytes: include_bytes!("../spirv/index_vvh_sides.spv") };

pub(crate) static PHOTONS_ADVANCE: Module =
    Module { name: "photons_advance", bytes: include_bytes!("../spirv/photons_advance.spv") };

pub(crate) static PHOTONS_EMIT: Module =
    Module { name: "photons_emit", bytes: include_bytes!("../spirv/photons_emit.spv") };

pub(crate) static PHOTONS_SCATTER: Module =
    Module { name: "photons_scatter", bytes: include_bytes!("../spirv/photons_scatter.spv") };

pub(crate) static PHOTONS_TALLY: Module =
    Module { name: "photons_tally", bytes: include_bytes!("../spirv/photons_tally.spv") };

pub(crate) static PHOTONS_TRACE: Module =
    Module { name: "photons_trace", bytes: include_bytes!("../spirv/photons_trace.spv") };

pub(crate) static PROBE_BSDF: Module = Module { name: "probe_bsdf", bytes: include_bytes!("../spirv/probe_bsdf.spv") };

pub(crate) static PROBE_KERNEL: Module =
    Module { name: "probe_kernel", bytes: include_bytes!("../spirv/probe_kernel.spv") };

pub(crate) static PROBE_LAYOUT: Module =
    Module { name: "probe_layout", bytes: include_bytes!("../spirv/probe_layout.spv") };

pub(crate) static PROBE_MATH: Module = Module { name: "probe_math", bytes: include_bytes!("../spirv/probe_math.spv") };

pub(crate) static PROBE_OCTAHEDRAL: Module =
    Module { name: "probe_octahedral", bytes: include_bytes!("../spirv/probe_octahedral.spv") };

pub(crate) static PROBE_OFFSET: Module =
    Module { name: "probe_offset", bytes: include_bytes!("../spirv/probe_offset.spv") };

pub(crate) static PROBE_RANDOM: Module =
    Module { name: "probe_random", bytes: include_bytes!("../spirv/probe_random.spv") };

pub(crate) static PROBE_SAMPLING: Module =
    Module { name: "probe_sampling", bytes: include_bytes!("../spirv/probe_sampling.spv") };

pub(crate) static PROBE_SOLID_ANGLE: Module =
    Module { name: "probe_solid_angle", bytes: include_bytes!("../spirv/probe_solid_angle.spv") };

pub(crate) static PROBE_TRIANGLE: Module =
    Module { name: "probe_triangle", bytes: include_bytes!("../spirv/probe_triangle.spv") };

pub(crate) static RAYS_NEAREST: Module =
    Module { name: "rays_nearest", bytes: include_bytes!("../spirv/rays_nearest.spv") };

pub(crate) static SCAN_ALONE: Module = Module { name: "scan_alone", bytes: include_bytes!("../spirv/scan_alone.spv") };

pub(crate) static SCAN_SUMS: Module = Module { name: "scan_sums", bytes: include_bytes!("../spirv/scan_sums.spv") };

pub(crate) static SCAN_TILES: Module = Module { name: "scan_tiles", bytes: include_bytes!("../spirv/scan_tiles.spv") };

pub(crate) static SORT_COUNT: Module = Module { name: "sort_count", bytes: include_bytes!("../spirv/sort_count.spv") };

pub(crate) static SORT_OFFSETS: Module =
    Module { name: "sort_offsets", bytes: include_bytes!("../spirv/sort_offsets.spv") };

pub(crate) static SORT_SCATTER: Module =
    Module { name: "sort_scatter", bytes: include_bytes!("../spirv/sort_scatter.spv") };

/// All of them.
pub(crate) static ALL: [&Module; 65] = [
    &CAMERA_AREA,
    &CAMERA_COMPACT,
    &CAMERA_DIRECT,
    &CAMERA_EYE,
    &CAMERA_GATHER,
    &CAMERA_GATHERED,
    &CAMERA_RADII,
    &CAMERA_SETTLE,
    &DEVICE_COPY,
    &EXAMPLE_PHOTONS,
    &FILM_ACCUMULATE,
    &FILM_END,
    &FILM_END_ERRORS,
    &FILM_ERRORS,
    &GATHER_CLOSEST,
    &GATHER_CODES,
    &GATHER_COUNT,
    &GATHER_IRRADIANCE,
    &GATHER_NEAREST,
    &GATHER_ORDER,
    &GATHER_PLACES,
    &GATHER_RADIUS,
    &GATHER_SAMPLE,
    &INDEX_ARRANGE,
    &INDEX_BOUNDS,
    &INDEX_CODES,
    &INDEX_GATHER,
    &INDEX_KEYS,
    &INDEX_LONG_RUNS,
    &INDEX_MEDIAN_COUNT,
    &INDEX_MEDIAN_FINISH,
    &INDEX_MEDIAN_PART,
    &INDEX_MEDIAN_SIDES,
    &INDEX_PARENTS,
    &INDEX_PICK,
    &INDEX_REFINE,
    &INDEX_VVH_BOXES,
    &INDEX_VVH_COLLAPSE,
    &INDEX_VVH_COUNT,
    &INDEX_VVH_FINISH,
    &INDEX_VVH_PART,
    &INDEX_VVH_PLAN,
    &INDEX_VVH_SIDES,
    &PHOTONS_ADVANCE,
    &PHOTONS_EMIT,
    &PHOTONS_SCATTER,
    &PHOTONS_TALLY,
    &PHOTONS_TRACE,
    &PROBE_BSDF,
    &PROBE_KERNEL,
    &PROBE_LAYOUT,
    &PROBE_MATH,
    &PROBE_OCTAHEDRAL,
    &PROBE_OFFSET,
    &PROBE_RANDOM,
    &PROBE_SAMPLING,
    &PROBE_SOLID_ANGLE,
    &PROBE_TRIANGLE,
    &RAYS_NEAREST,
    &SCAN_ALONE,
    &SCAN_SUMS,
    &SCAN_TILES,
    &SORT_COUNT,
    &SORT_OFFSETS,
    &SORT_SCATTER,
];

//! The compiled shaders. Written by `cargo xtask shaders`.

use crate::device::Module;

pub(crate) static DEVICE_COPY: Module =
    Module { name: "device_copy", bytes: include_bytes!("../spirv/device_copy.spv") };

#[cfg(test)]
pub(crate) static EXAMPLE_PHOTONS: Module =
    Module { name: "example_photons", bytes: include_bytes!("../spirv/example_photons.spv") };

pub(crate) static FILM_ACCUMULATE: Module =
    Module { name: "film_accumulate", bytes: include_bytes!("../spirv/film_accumulate.spv") };

pub(crate) static FILM_AVERAGE: Module =
    Module { name: "film_average", bytes: include_bytes!("../spirv/film_average.spv") };

pub(crate) static FILM_BANDWIDTH_BIAS: Module =
    Module { name: "film_bandwidth_bias", bytes: include_bytes!("../spirv/film_bandwidth_bias.spv") };

pub(crate) static FILM_BANDWIDTH_CHANGE: Module =
    Module { name: "film_bandwidth_change", bytes: include_bytes!("../spirv/film_bandwidth_change.spv") };

pub(crate) static FILM_BANDWIDTH_FACTOR: Module =
    Module { name: "film_bandwidth_factor", bytes: include_bytes!("../spirv/film_bandwidth_factor.spv") };

pub(crate) static FILM_DISPLAY: Module =
    Module { name: "film_display", bytes: include_bytes!("../spirv/film_display.spv") };

pub(crate) static FILM_END: Module = Module { name: "film_end", bytes: include_bytes!("../spirv/film_end.spv") };

pub(crate) static FILM_END_ERRORS: Module =
    Module { name: "film_end_errors", bytes: include_bytes!("../spirv/film_end_errors.spv") };

pub(crate) static FILM_ERRORS: Module =
    Module { name: "film_errors", bytes: include_bytes!("../spirv/film_errors.spv") };

pub(crate) static FILM_SAMPLES: Module =
    Module { name: "film_samples", bytes: include_bytes!("../spirv/film_samples.spv") };

pub(crate) static INDEX_ARRANGE: Module =
    Module { name: "index_arrange", bytes: include_bytes!("../spirv/index_arrange.spv") };

pub(crate) static INDEX_BOUNDS: Module =
    Module { name: "index_bounds", bytes: include_bytes!("../spirv/index_bounds.spv") };

pub(crate) static INDEX_CODES: Module =
    Module { name: "index_codes", bytes: include_bytes!("../spirv/index_codes.spv") };

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

pub(crate) static INDEX_PERMUTE: Module =
    Module { name: "index_permute", bytes: include_bytes!("../spirv/index_permute.spv") };

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

#[cfg(test)]
pub(crate) static PROBE_ALPHA: Module =
    Module { name: "probe_alpha", bytes: include_bytes!("../spirv/probe_alpha.spv") };

#[cfg(test)]
pub(crate) static PROBE_AREA: Module = Module { name: "probe_area", bytes: include_bytes!("../spirv/probe_area.spv") };

#[cfg(test)]
pub(crate) static PROBE_BIAS: Module = Module { name: "probe_bias", bytes: include_bytes!("../spirv/probe_bias.spv") };

#[cfg(test)]
pub(crate) static PROBE_BSDF: Module = Module { name: "probe_bsdf", bytes: include_bytes!("../spirv/probe_bsdf.spv") };

#[cfg(test)]
pub(crate) static PROBE_ENVIRONMENT: Module =
    Module { name: "probe_environment", bytes: include_bytes!("../spirv/probe_environment.spv") };

#[cfg(test)]
pub(crate) static PROBE_GLOSS_CAUSTICS: Module =
    Module { name: "probe_gloss_caustics", bytes: include_bytes!("../spirv/probe_gloss_caustics.spv") };

#[cfg(test)]
pub(crate) static PROBE_GLOSSY: Module =
    Module { name: "probe_glossy", bytes: include_bytes!("../spirv/probe_glossy.spv") };

#[cfg(test)]
pub(crate) static PROBE_GRID: Module = Module { name: "probe_grid", bytes: include_bytes!("../spirv/probe_grid.spv") };

#[cfg(test)]
pub(crate) static PROBE_KERNEL: Module =
    Module { name: "probe_kernel", bytes: include_bytes!("../spirv/probe_kernel.spv") };

#[cfg(test)]
pub(crate) static PROBE_LAYOUT: Module =
    Module { name: "probe_layout", bytes: include_bytes!("../spirv/probe_layout.spv") };

#[cfg(test)]
pub(crate) static PROBE_LIGHT_SAMPLER: Module =
    Module { name: "probe_light_sampler", bytes: include_bytes!("../spirv/probe_light_sampler.spv") };

#[cfg(test)]
pub(crate) static PROBE_LIGHT_TREE: Module =
    Module { name: "probe_light_tree", bytes: include_bytes!("../spirv/probe_light_tree.spv") };

#[cfg(test)]
pub(crate) static PROBE_MAPS: Module = Module { name: "probe_maps", bytes: include_bytes!("../spirv/probe_maps.spv") };

#[cfg(test)]
pub(crate) static PROBE_MATH: Module = Module { name: "probe_math", bytes: include_bytes!("../spirv/probe_math.spv") };

#[cfg(test)]
pub(crate) static PROBE_MEDIA: Module =
    Module { name: "probe_media", bytes: include_bytes!("../spirv/probe_media.spv") };

#[cfg(test)]
pub(crate) static PROBE_MEDIUM: Module =
    Module { name: "probe_medium", bytes: include_bytes!("../spirv/probe_medium.spv") };

#[cfg(test)]
pub(crate) static PROBE_OCTAHEDRAL: Module =
    Module { name: "probe_octahedral", bytes: include_bytes!("../spirv/probe_octahedral.spv") };

#[cfg(test)]
pub(crate) static PROBE_OFFSET: Module =
    Module { name: "probe_offset", bytes: include_bytes!("../spirv/probe_offset.spv") };

#[cfg(test)]
pub(crate) static PROBE_PHOTON_FORMAT: Module =
    Module { name: "probe_photon_format", bytes: include_bytes!("../spirv/probe_photon_format.spv") };

#[cfg(test)]
pub(crate) static PROBE_PROJECTION: Module =
    Module { name: "probe_projection", bytes: include_bytes!("../spirv/probe_projection.spv") };

#[cfg(test)]
pub(crate) static PROBE_RANDOM: Module =
    Module { name: "probe_random", bytes: include_bytes!("../spirv/probe_random.spv") };

#[cfg(test)]
pub(crate) static PROBE_ROUGH_GLASS: Module =
    Module { name: "probe_rough_glass", bytes: include_bytes!("../spirv/probe_rough_glass.spv") };

#[cfg(test)]
pub(crate) static PROBE_SAMPLING: Module =
    Module { name: "probe_sampling", bytes: include_bytes!("../spirv/probe_sampling.spv") };

#[cfg(test)]
pub(crate) static PROBE_SHADE: Module =
    Module { name: "probe_shade", bytes: include_bytes!("../spirv/probe_shade.spv") };

#[cfg(test)]
pub(crate) static PROBE_SHADING_NORMAL: Module =
    Module { name: "probe_shading_normal", bytes: include_bytes!("../spirv/probe_shading_normal.spv") };

#[cfg(test)]
pub(crate) static PROBE_SHADOW_TERMINATOR: Module =
    Module { name: "probe_shadow_terminator", bytes: include_bytes!("../spirv/probe_shadow_terminator.spv") };

#[cfg(test)]
pub(crate) static PROBE_SOLID_ANGLE: Module =
    Module { name: "probe_solid_angle", bytes: include_bytes!("../spirv/probe_solid_angle.spv") };

#[cfg(test)]
pub(crate) static PROBE_TEXTURE: Module =
    Module { name: "probe_texture", bytes: include_bytes!("../spirv/probe_texture.spv") };

#[cfg(test)]
pub(crate) static PROBE_TRIANGLE: Module =
    Module { name: "probe_triangle", bytes: include_bytes!("../spirv/probe_triangle.spv") };

pub(crate) static RAYS_NEAREST: Module =
    Module { name: "rays_nearest", bytes: include_bytes!("../spirv/rays_nearest.spv") };

pub(crate) static SCAN_ALONE: Module = Module { name: "scan_alone", bytes: include_bytes!("../spirv/scan_alone.spv") };

pub(crate) static SCAN_SUMS: Module = Module { name: "scan_sums", bytes: include_bytes!("../spirv/scan_sums.spv") };

pub(crate) static SCAN_TILES: Module = Module { name: "scan_tiles", bytes: include_bytes!("../spirv/scan_tiles.spv") };

pub(crate) static SEARCH_CODES: Module =
    Module { name: "search_codes", bytes: include_bytes!("../spirv/search_codes.spv") };

pub(crate) static SEARCH_COUNT: Module =
    Module { name: "search_count", bytes: include_bytes!("../spirv/search_count.spv") };

pub(crate) static SEARCH_K_NEAREST: Module =
    Module { name: "search_k_nearest", bytes: include_bytes!("../spirv/search_k_nearest.spv") };

pub(crate) static SEARCH_NEAREST_PHOTON: Module =
    Module { name: "search_nearest_photon", bytes: include_bytes!("../spirv/search_nearest_photon.spv") };

pub(crate) static SEARCH_ORDER: Module =
    Module { name: "search_order", bytes: include_bytes!("../spirv/search_order.spv") };

pub(crate) static SEARCH_RADIUS: Module =
    Module { name: "search_radius", bytes: include_bytes!("../spirv/search_radius.spv") };

pub(crate) static SEARCH_SAMPLE: Module =
    Module { name: "search_sample", bytes: include_bytes!("../spirv/search_sample.spv") };

pub(crate) static SEARCH_SEGMENT: Module =
    Module { name: "search_segment", bytes: include_bytes!("../spirv/search_segment.spv") };

pub(crate) static SORT_COUNT: Module = Module { name: "sort_count", bytes: include_bytes!("../spirv/sort_count.spv") };

pub(crate) static SORT_OFFSETS: Module =
    Module { name: "sort_offsets", bytes: include_bytes!("../spirv/sort_offsets.spv") };

pub(crate) static SORT_SCATTER: Module =
    Module { name: "sort_scatter", bytes: include_bytes!("../spirv/sort_scatter.spv") };

pub(crate) static STAGES_AREA: Module =
    Module { name: "stages_area", bytes: include_bytes!("../spirv/stages_area.spv") };

pub(crate) static STAGES_DIRECT: Module =
    Module { name: "stages_direct", bytes: include_bytes!("../spirv/stages_direct.spv") };

pub(crate) static STAGES_EMIT: Module =
    Module { name: "stages_emit", bytes: include_bytes!("../spirv/stages_emit.spv") };

pub(crate) static STAGES_EYE: Module = Module { name: "stages_eye", bytes: include_bytes!("../spirv/stages_eye.spv") };

pub(crate) static STAGES_EYE_COMPACT: Module =
    Module { name: "stages_eye_compact", bytes: include_bytes!("../spirv/stages_eye_compact.spv") };

pub(crate) static STAGES_EYE_RADII: Module =
    Module { name: "stages_eye_radii", bytes: include_bytes!("../spirv/stages_eye_radii.spv") };

pub(crate) static STAGES_EYE_SETTLE: Module =
    Module { name: "stages_eye_settle", bytes: include_bytes!("../spirv/stages_eye_settle.spv") };

pub(crate) static STAGES_FINAL_GATHER: Module =
    Module { name: "stages_final_gather", bytes: include_bytes!("../spirv/stages_final_gather.spv") };

pub(crate) static STAGES_FINAL_GATHER_SUM: Module =
    Module { name: "stages_final_gather_sum", bytes: include_bytes!("../spirv/stages_final_gather_sum.spv") };

pub(crate) static STAGES_IRRADIANCE: Module =
    Module { name: "stages_irradiance", bytes: include_bytes!("../spirv/stages_irradiance.spv") };

pub(crate) static STAGES_IRRADIANCE_PLACES: Module =
    Module { name: "stages_irradiance_places", bytes: include_bytes!("../spirv/stages_irradiance_places.spv") };

pub(crate) static STAGES_MEDIUM_DIRECT: Module =
    Module { name: "stages_medium_direct", bytes: include_bytes!("../spirv/stages_medium_direct.spv") };

pub(crate) static STAGES_TALLY: Module =
    Module { name: "stages_tally", bytes: include_bytes!("../spirv/stages_tally.spv") };

pub(crate) static STAGES_TRACE: Module =
    Module { name: "stages_trace", bytes: include_bytes!("../spirv/stages_trace.spv") };

pub(crate) static STAGES_TRACE_ADVANCE: Module =
    Module { name: "stages_trace_advance", bytes: include_bytes!("../spirv/stages_trace_advance.spv") };

pub(crate) static STAGES_TRACE_REORDER: Module =
    Module { name: "stages_trace_reorder", bytes: include_bytes!("../spirv/stages_trace_reorder.spv") };

/// Those of the pipeline.
pub(crate) static KERNELS: [&Module; 62] = [
    &DEVICE_COPY,
    &FILM_ACCUMULATE,
    &FILM_AVERAGE,
    &FILM_BANDWIDTH_BIAS,
    &FILM_BANDWIDTH_CHANGE,
    &FILM_BANDWIDTH_FACTOR,
    &FILM_DISPLAY,
    &FILM_END,
    &FILM_END_ERRORS,
    &FILM_ERRORS,
    &FILM_SAMPLES,
    &INDEX_ARRANGE,
    &INDEX_BOUNDS,
    &INDEX_CODES,
    &INDEX_KEYS,
    &INDEX_LONG_RUNS,
    &INDEX_MEDIAN_COUNT,
    &INDEX_MEDIAN_FINISH,
    &INDEX_MEDIAN_PART,
    &INDEX_MEDIAN_SIDES,
    &INDEX_PARENTS,
    &INDEX_PERMUTE,
    &INDEX_PICK,
    &INDEX_REFINE,
    &INDEX_VVH_BOXES,
    &INDEX_VVH_COLLAPSE,
    &INDEX_VVH_COUNT,
    &INDEX_VVH_FINISH,
    &INDEX_VVH_PART,
    &INDEX_VVH_PLAN,
    &INDEX_VVH_SIDES,
    &RAYS_NEAREST,
    &SCAN_ALONE,
    &SCAN_SUMS,
    &SCAN_TILES,
    &SEARCH_CODES,
    &SEARCH_COUNT,
    &SEARCH_K_NEAREST,
    &SEARCH_NEAREST_PHOTON,
    &SEARCH_ORDER,
    &SEARCH_RADIUS,
    &SEARCH_SAMPLE,
    &SEARCH_SEGMENT,
    &SORT_COUNT,
    &SORT_OFFSETS,
    &SORT_SCATTER,
    &STAGES_AREA,
    &STAGES_DIRECT,
    &STAGES_EMIT,
    &STAGES_EYE,
    &STAGES_EYE_COMPACT,
    &STAGES_EYE_RADII,
    &STAGES_EYE_SETTLE,
    &STAGES_FINAL_GATHER,
    &STAGES_FINAL_GATHER_SUM,
    &STAGES_IRRADIANCE,
    &STAGES_IRRADIANCE_PLACES,
    &STAGES_MEDIUM_DIRECT,
    &STAGES_TALLY,
    &STAGES_TRACE,
    &STAGES_TRACE_ADVANCE,
    &STAGES_TRACE_REORDER,
];

/// Those of tests and of the example.
#[cfg(test)]
pub(crate) static TEST_KERNELS: [&Module; 30] = [
    &EXAMPLE_PHOTONS,
    &PROBE_ALPHA,
    &PROBE_AREA,
    &PROBE_BIAS,
    &PROBE_BSDF,
    &PROBE_ENVIRONMENT,
    &PROBE_GLOSS_CAUSTICS,
    &PROBE_GLOSSY,
    &PROBE_GRID,
    &PROBE_KERNEL,
    &PROBE_LAYOUT,
    &PROBE_LIGHT_SAMPLER,
    &PROBE_LIGHT_TREE,
    &PROBE_MAPS,
    &PROBE_MATH,
    &PROBE_MEDIA,
    &PROBE_MEDIUM,
    &PROBE_OCTAHEDRAL,
    &PROBE_OFFSET,
    &PROBE_PHOTON_FORMAT,
    &PROBE_PROJECTION,
    &PROBE_RANDOM,
    &PROBE_ROUGH_GLASS,
    &PROBE_SAMPLING,
    &PROBE_SHADE,
    &PROBE_SHADING_NORMAL,
    &PROBE_SHADOW_TERMINATOR,
    &PROBE_SOLID_ANGLE,
    &PROBE_TEXTURE,
    &PROBE_TRIANGLE,
];

//! Photon mapping: the part that all backends share.
//!
//! Data layouts, random numbers, scattering, settings, the traits that a backend implements, and the loop
//! that drives them. No input or output, no ray-tracing structure; threads for judging films only ([`parallel`]).
//!
//! Start with [`Pipeline`] and [`render`], which render a [`SceneView`] by [`Settings`]; a backend implements [`Backend`]
//! and [`TransportBackend`].
#![forbid(unsafe_code)]

mod backend;
mod error;
mod file_kind;
mod film;
pub mod memory;
pub mod parallel;
mod pipeline;
mod projection;
mod radius;
mod requirements;
mod scene;
mod settings;
mod shading;
mod shown;

pub use backend::announcement::{AnnouncedMap, Announcement};
pub use backend::kd_tree;
pub use backend::memory::Costs;
pub use backend::observer::{Event, Observer, PassReport};
pub use backend::stages::{
    Aimed, AreaProbe, Batch, BeamEstimator, BeamParams, Deposits, DirectLight, Emitter, EstimateBuffers,
    EstimateParams, EyeBuffers, EyeTracer, FinalGather, GlossCaustics, IrradiancePoints, KdTreeBuilder, MapStages,
    Maps, MediaDeposits, MediaStages, Pass, RadianceEstimator, Search, Stages, Tracer, View,
};
pub use backend::stop::StopCondition;
pub use backend::tally::{Fate, FixedFlux, FluxSum, Tally};
pub use backend::{AimedStages, Backend, Fill, FilmBackend, Stage, StageTimings, TransportBackend};
pub use error::{Error, Result};
pub use file_kind::FileKind;
pub use film::confidence::{ConfidenceInterval, ErrorPixel, Flags, PhotonMoments, student_975};
pub use film::display::{Display, DisplayImage};
pub use film::film_tally::FilmTally;
pub use film::forecast::{ErrorModel, Forecast};
pub use film::pass_set::PassSet;
pub use film::tone_map::{ToneMap, decode_srgb, encode_srgb};
pub use film::{Film, FilmPixel, Layer, NUMERICS, check_size};
pub use glam;
pub use pipeline::blocks::{BlockOutcome, Blocks, render_block, render_blocks};
pub use pipeline::error_target::ErrorTarget;
pub use pipeline::parallel_blocks::render_blocks_in_parallel;
pub use pipeline::render::{Facts, Outcome, PassEnd, Render, render};
pub use pipeline::{Pipeline, QUERIES_PER_PIXEL, segments_per_pixel};
pub use projection::{NoProjection, ProjectionDisc, ProjectionMap, ProjectionSample, ProjectionTarget};
pub use radius::bandwidth::{PixelRadii, RadiusUpdate};
pub use radius::neighbour_radius;
pub use radius::progressive::{inverse_radius_squared_sum, radius_squared_factor, radius_squared_sum};
pub use radius::schedule::Schedule;
pub use requirements::explain::{Need, explain};
pub use requirements::features::Features;
pub use requirements::gloss_caustics::roughest_caustic;
pub use requirements::map_kind::{MapKind, PerMap};
pub use requirements::map_place::MapPlace;
pub use requirements::photon_format::PhotonFormat;
pub use requirements::{Requirements, light_features, material_features};
pub use scene::boundaries::{Boundaries, Enclosing, boundary_crossing};
pub use scene::camera::Camera;
pub use scene::caster::{Hit, Ray, RayCaster, SkipLimit};
pub use scene::environment::{EnvironmentMap, EnvironmentRow};
pub use scene::grid::{self, Columns, Density, Grid, GridTables, OwnedGridTables};
pub use scene::layout::{Element, ErrorMoments, Estimate, Photon, PhotonRay, Query};
pub use scene::light::Light;
pub use scene::light_groups::LightGroups;
pub use scene::light_shares::{LightShare, light_shares};
pub use scene::material::{Material, MaterialKind, Primitive};
pub use scene::material_layers::MaterialLayers;
pub use scene::media::{Interface, MediaFeatures, MediumStack, interface, radiance_scale};
pub use scene::medium::Medium;
pub use scene::portal::Portal;
pub use scene::portal_shares::{PortalShares, portal_shares};
pub use scene::solids::{Locator, Solids, crossing};
pub use scene::texture::{
    Anisotropy, ClearcoatNormal, DiffuseTransmission, Filter, MaterialTextures, OwnedShadingTables,
    PartialTransmission, ShadingTables, SheenLayer, TexelFormat, Texture, TextureUse, Wrap,
};
pub use scene::units::Units;
pub use scene::{SceneView, light_cdf, light_probability, pick_light};
pub use settings::budget::{Budget, Plan};
pub use settings::kernel::Kernel;
pub use settings::preset::Preset;
pub use settings::rule::{Circumstances, Decision, FirstPass, Fixed};
pub use settings::{
    Area, Bandwidth, CausticPhotons, Direct, Estimator, IndexKind, Indirect, Paper, RandomKind, Scheduling, Settings,
};
pub use shading::albedo_table::AlbedoTable;
pub use shading::bsdf::{Bsdf, Lobe, NEGLIGIBLE_THROUGHPUT, most_total_reflections, russian_roulette};
pub use shading::environment::EnvironmentSample;
pub use shading::glossy::{Coat, Glossy, Reflected};
pub use shading::interaction::SurfaceInteraction;
pub use shading::layers::Layers;
pub use shading::light_cone::LightCone;
pub use shading::reflection_lobe::{ReflectionLobe, Vectors};
pub use shading::rough_glass::{RoughGlass, RoughSample};
pub use shading::rough_glass_table::RoughGlassTable;
pub use shading::scattering::{Scattering, Vertex};
pub use shading::segment::Segment;
pub use shading::shade::{Shaded, Shading};
pub use shading::sheen_lobe::SheenTable;
pub use shading::spectrum::{Spectrum, SpectrumCell, Wavelength};
pub use shading::{
    alpha, anisotropy, area, clearcoat, cosine_warp, equiangular, flight, fresnel, ggx, gloss_caustics, glossy,
    light_sampler, light_tree, math, octahedral, offset, partial_transmission, phase, photon_sample, portals, random,
    rough_glass, sampling, segment, shade, shading_normal, shadow_terminator, sheen, solid_angle, spot_part, texture,
};
pub use shown::shown;

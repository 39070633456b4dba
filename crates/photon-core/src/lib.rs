//! Photon mapping, the part that is the same on every backend.
//!
//! Records, random numbers, physics, settings, the traits that a backend implements, and the loop
//! that drives them. No threads, no input or output, no ray-tracing structure.
#![forbid(unsafe_code)]

pub mod area;
mod backend;
mod bandwidth;
mod bsdf;
mod budget;
mod caster;
mod error;
mod errors;
mod explain;
mod features;
mod film;
mod forecast;
pub mod fresnel;
mod interaction;
mod kernel;
mod layout;
mod light_shares;
mod map_kind;
pub mod math;
mod media;
mod memory;
pub mod neighbour_radius;
mod observer;
pub mod octahedral;
pub mod offset;
mod option_names;
mod photon_format;
mod pipeline;
mod preset;
mod progressive;
mod projection;
mod radii;
pub mod random;
mod render;
mod requirements;
pub mod sampling;
mod scene;
mod schedule;
mod settings;
pub mod sobol;
pub mod solid_angle;
mod solids;
mod stages;
mod tally;
mod units;

pub use backend::{AimedStages, Backend, Fill, FilmBackend, Stage, StageTimings, TransportBackend};
pub use bsdf::{Bsdf, Lobe};
pub use budget::{Budget, Plan};
pub use caster::{Hit, Ray, RayCaster};
pub use error::{Error, Result};
pub use errors::{ConfidenceInterval, ErrorPixel, Flags, PhotonMoments, student_975};
pub use explain::{Need, explain};
pub use features::Features;
pub use film::{Film, FilmPixel, Layer, check_size};
pub use forecast::{ErrorModel, Forecast};
pub use glam;
pub use interaction::SurfaceInteraction;
pub use kernel::Kernel;
pub use layout::{
    Camera, Element, ErrorMoments, Estimate, Light, Material, MaterialKind, Medium, Photon, PhotonRay, Primitive, Query,
};
pub use light_shares::{LightShare, light_shares};
pub use map_kind::{MapKind, PerMap};
pub use media::{Interface, MediaFeatures, MediumStack, interface, radiance_scale};
pub use memory::Costs;
pub use observer::{Event, Observer, PassReport};
pub use photon_format::PhotonFormat;
pub use pipeline::{Pipeline, QUERIES_PER_PIXEL};
pub use preset::Preset;
pub use progressive::{inverse_radius_squared_sum, radius_squared_factor, radius_squared_sum};
pub use projection::{NoProjection, ProjectionMap, ProjectionSample, ProjectionTarget};
pub use render::{Facts, Outcome, PassEnd, Render, render};
pub use requirements::{Requirements, light_features, material_features};
pub use scene::{SceneView, light_cdf, light_probability, pick_light};
pub use schedule::Schedule;
pub use settings::{
    Area, Bandwidth, CausticPhotons, Direct, Estimator, IndexKind, Indirect, Paper, RandomKind, Scheduling, Settings,
};
pub use solids::{Locator, Solids};
pub use stages::{
    Aimed, AreaProbe, Batch, Deposits, DirectLight, Emitter, EstimateBuffers, EstimateParams, EyeTracer, FinalGather,
    IrradiancePoints, KdTreeBuilder, MapStages, Maps, Pass, RadianceEstimator, Search, Stages, Tracer, View,
};
pub use tally::{Fate, FixedFlux, FluxSum, Tally};
pub use units::Units;

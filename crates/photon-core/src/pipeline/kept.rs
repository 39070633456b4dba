//! How much of a photon the stages ask for.

use crate::backend::TransportBackend;
use crate::kept::Kept;
use crate::stages::Stages;

/// The least that all stages can work with which touch photons.
pub(super) fn least<B: TransportBackend>(stages: &Stages<B>) -> Kept {
    let Stages { tracer, gather, irradiance, aimed, map, .. } = stages;
    let always = [tracer.least_kept(), map.builder.least_kept(), map.estimator.least_kept()];
    let aimed = aimed.as_ref().map(|aimed| aimed.tracer.least_kept());
    let gather = gather.as_ref().map(|gather| gather.least_kept());
    let irradiance = irradiance.as_ref().map(|irradiance| irradiance.least_kept());
    always.into_iter().chain(aimed).chain(gather).chain(irradiance).max().unwrap_or_default()
}

//! The photon format that the stages need.

use crate::backend::TransportBackend;
use crate::backend::stages::Stages;
use crate::requirements::photon_format::PhotonFormat;

/// The smallest format that all stages which use photons can work with.
pub(super) fn least<B: TransportBackend>(stages: &Stages<B>) -> PhotonFormat {
    let Stages { tracer, gather, irradiance, aimed, map, .. } = stages;
    let always = [tracer.required_format(), map.builder.required_format(), map.estimator.required_format()];
    let aimed = aimed.as_ref().map(|aimed| aimed.tracer.required_format());
    let gather = gather.as_ref().map(|gather| gather.required_format());
    let irradiance = irradiance.as_ref().map(|irradiance| irradiance.required_format());
    always.into_iter().chain(aimed).chain(gather).chain(irradiance).max().unwrap_or_default()
}

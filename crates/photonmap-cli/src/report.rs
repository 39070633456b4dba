//! The report of a render, as JSON.

use photon_core::{Film, FluxSum, Forecast, LightShare, Outcome, PerMap, Render, Settings, Stage, StageTimings, Tally};
use photon_scene::LoadReport;
use serde_json::{Value, json};

use crate::command::decided::Decided;

/// Contents of the report besides those of the renderer.
#[derive(Debug)]
pub struct Details<'a> {
    /// Name of the scene, as given.
    pub scene: &'a str,
    /// The environment, in words.
    pub environment: Option<&'a str>,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The devices that rendered.
    pub device: &'a str,
    /// Passes in a block; `None`: passes were added one by one on the device.
    pub grain: Option<u32>,
    /// The whole film, if it is that of a file: it may have passes of earlier renders.
    pub film: Option<&'a Film>,
    /// The settings.
    pub settings: &'a Settings,
    /// Result of the passes.
    pub outcome: &'a Outcome,
    /// The loader's report.
    pub load: &'a LoadReport,
    /// Warnings of the scene.
    pub warnings: &'a [String],
    /// Share of each light in the photons.
    pub lights: &'a [LightShare],
    /// Seconds spent loading.
    pub seconds_load: f64,
    /// Seconds spent opening the device, and preparing the renderer on it.
    pub seconds_start: f64,
    /// Seconds spent opening the device, most of them while the scene is loaded; 0 for several devices.
    pub seconds_device: f64,
    /// Settings that were decided.
    pub decided: Option<&'a Decided>,
    /// Seconds from the first pass to the film on the host.
    pub seconds_passes: f64,
    /// Seconds from start to finished film.
    pub seconds_total: f64,
}

/// An error forecast; shares are fractions of 1, errors are relative to the pixel.
fn forecast(details: &Forecast) -> Value {
    json!({
        "passes": details.passes,
        "share_claimed": details.claimed,
        "share_within_target": details.within,
        "error": details.error,
        "share": details.share,
        "target": details.target,
        "passes_needed": details.passes_needed,
        "passes_least": details.passes_least,
        "passes_possible": details.passes_possible,
        "error_possible": details.error_possible,
        "error_possible_least": details.error_possible_least,
        "seconds_needed": details.seconds_needed(),
        "seconds_per_pass": details.seconds_per_pass,
        "radius_factor": details.radius_factor,
    })
}

/// Makes the report.
#[must_use]
pub fn json(renderer: &dyn Render, details: &Details<'_>) -> Value {
    let facts = renderer.facts();
    let (required, outcome) = (facts.required, details.outcome);
    let tally = &outcome.tally;
    let seconds = |stage: Stage| outcome.seconds.get(stage);
    let tracing = seconds(Stage::Emit) + seconds(Stage::Trace);
    let last = outcome.last.as_ref();
    json!({
        "scene": details.scene,
        "environment": details.environment,
        "size": [details.size.0, details.size.1],
        "backend": facts.backend,
        "device": details.device,
        "requirements": {
            "features": required.features.names().collect::<Vec<_>>(),
            "shadow_rays": required.shadow_rays,
            "final_gather": required.final_gather,
            "kept_of_photons": required.photon_format.name(),
        },
        "maps": by_name(required.maps),
        // Of one photon record; `bytes_per_photon` also includes the buffers of searches.
        "bytes_of_photon_in_map": by_name(required.maps.map(|kept| kept.then(|| required.photon_format.bytes()))),
        "radius_of_last_pass": by_name(last.map(|pass| pass.radius).unwrap_or_default()),
        "peak_resident_bytes": crate::memory::peak(),
        "paths_per_pass": facts.photons,
        "lights": details.lights.iter().map(|share| json!({
            "light": share.what,
            "power": share.power,
            "paths_per_pass": share.paths(facts.photons),
            "starves": share.starves(facts.photons),
        })).collect::<Vec<_>>(),
        "aimed_paths_per_pass": facts.aimed,
        "bytes_per_photon": bytes_per_photon(&facts.memory, last.map_or(0, |pass| {
            pass.tally.stored.values().chain(pass.aimed.stored.values()).sum()
        })),
        "passes": outcome.passes,
        "cancelled": outcome.cancelled,
        "predicted": outcome.predicted.as_ref().map(forecast),
        "reached": outcome.reached.as_ref().map(forecast),
        "paths": outcome.paths,
        "counters": counters(tally, &outcome.aimed, outcome.truncated_camera_paths),
        // Counts of aimed paths; those that reached a diffuse surface served their purpose.
        "aimed": facts.aimed.map(|_| aimed(&outcome.aimed)),
        "flux": flux(tally),
        // All passes of the film file, where the figures above are of this run. Some may be from a file without counts.
        "film": details.film.map(|film| json!({
            "passes": film.passes,
            "passes_counted": film.tally.passes,
            "counters": counters(&film.tally.photons, &film.tally.aimed, film.tally.truncated_camera_paths),
            "aimed": facts.aimed.map(|_| aimed(&film.tally.aimed)),
            "flux": flux(&film.tally.photons),
        })),
        "bytes": facts.memory.iter().cloned().map(|(label, bytes)| (label, Value::from(bytes))).collect::<serde_json::Map<_, _>>(),
        "seconds": seconds_of(&facts.setup, details),
        "photons_per_second": if tracing > 0.0 { tally.emitted as f64 / tracing } else { 0.0 },
        "grain": details.grain,
        "decided": details.decided.map(|decided| decided.json(outcome)),
        "settings": details.settings,
        "report": details.load.lines.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "warnings": details.warnings,
    })
}

/// Wall-clock seconds. `start` contains those from `prepare` to `pilot`, and what of `device` is left after loading. On a GPU,
/// `bvh` may be spent while the device is opened.
fn seconds_of(setup: &StageTimings, details: &Details<'_>) -> Value {
    let seconds = |stage: Stage| details.outcome.seconds.get(stage);
    json!({
        "load": details.seconds_load,
        "start": details.seconds_start,
        "device": details.seconds_device,
        "prepare": setup.get(Stage::Prepare),
        "bvh": setup.get(Stage::Bvh),
        "project": setup.get(Stage::Project),
        // Where they are needed first, which may be in the pilot pass or in others.
        "pipelines": setup.get(Stage::Compile) + seconds(Stage::Compile),
        "pilot": setup.without_scene(),
        "passes": details.seconds_passes,
        "emit+trace": seconds(Stage::Emit) + seconds(Stage::Trace),
        "build": seconds(Stage::Build),
        "eye": seconds(Stage::Eye),
        "direct": seconds(Stage::Direct),
        "estimate": seconds(Stage::Estimate),
        "gather": seconds(Stage::Gather),
        "film": seconds(Stage::Film),
        "total": details.seconds_total,
    })
}

/// One value for each map, by the map's name.
fn by_name<T: Into<Value>>(values: PerMap<T>) -> Value {
    let fields = values.into_iter().map(|(kind, value)| (kind.name().to_owned(), value.into()));
    Value::Object(fields.collect())
}

/// Counts of paths that were not aimed, of truncated camera paths, and photons stored and paths too deep of all.
fn counters(tally: &Tally, aimed: &Tally, truncated_camera_paths: u64) -> Value {
    json!({
        "emitted": tally.emitted,
        "terminated": tally.terminated,
        "absorbed": tally.absorbed,
        "escaped": tally.escaped,
        "truncated": tally.truncated,
        "dropped": tally.dropped,
        "surfaces": tally.surfaces,
        "truncated_camera_paths": truncated_camera_paths,
        "too_deep": tally.too_deep.saturating_add(aimed.too_deep),
        "stored": by_name(PerMap::from_fn(|kind| tally.stored[kind].saturating_add(aimed.stored[kind]))),
        "balance": tally.balances(),
    })
}

/// Flux of paths that were not aimed, in fractions of the scene's power.
fn flux(tally: &Tally) -> Value {
    let share = |sum: &FluxSum| sum.value().map(|f| f / tally.emitted.max(1) as f64);
    json!({
        "emitted": share(&tally.flux_emitted),
        "absorbed": share(&tally.flux_absorbed),
        "escaped": share(&tally.flux_escaped),
        "truncated": share(&tally.flux_truncated),
        "dropped": share(&tally.flux_dropped),
    })
}

/// Counts of aimed paths by fate; their flux is in fractions of the scene's power.
fn aimed(tally: &Tally) -> Value {
    let flux = |sum: &FluxSum| sum.value().map(|f| f / tally.emitted.max(1) as f64);
    json!({
        "emitted": tally.emitted,
        "terminated": tally.terminated,
        "absorbed": tally.absorbed,
        "escaped": tally.escaped,
        "truncated": tally.truncated,
        "dropped": tally.dropped,
        "surfaces": tally.surfaces,
        "balance": tally.balances(),
        "flux": {
            "emitted": flux(&tally.flux_emitted),
            "terminated": flux(&tally.flux_terminated),
            "absorbed": flux(&tally.flux_absorbed),
            "escaped": flux(&tally.flux_escaped),
            "truncated": flux(&tally.flux_truncated),
            "dropped": flux(&tally.flux_dropped),
        },
    })
}

/// Bytes of maps and buffers per photon of a pass; `None` without photons.
fn bytes_per_photon(memory: &[(String, u64)], photons: u64) -> Option<f64> {
    let bytes: u64 = memory.iter().filter(|(label, _)| label.contains("photons:")).map(|(_, bytes)| bytes).sum();
    (photons > 0).then(|| bytes as f64 / photons as f64)
}

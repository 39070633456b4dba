//! Photons out of the library.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1};
use photonmap::cpu::Cpu;
use photonmap::scene::Scene;
use photonmap::{
    Batch, Deposits, Direct, Indirect, MapKind, MediaDeposits, Pass, PerMap, Photon, PhotonFormat, PhotonRay,
    Requirements, Settings, TransportBackend, octahedral,
};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::gpu;
use crate::scene::RawScene;
use crate::settings::parse;

/// Positions, normals, directions and powers, flat, and the kind of each photon: 0 direct, 1 caustic, 2 global.
type Photons<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<u8>>,
);

/// Traces the paths of one pass and returns their photons, ordered by kind, then path.
#[pyfunction]
pub(crate) fn trace_photons<'py>(
    py: Python<'py>,
    scene: &RawScene,
    settings: &str,
    device: (Option<String>, usize),
) -> PyResult<Photons<'py>> {
    let settings = Settings { direct: Direct::Photons, indirect: Indirect::Map, caustics: true, ..parse(settings)? };
    settings.validate().map_err(Failure::from)?;
    let scene = Arc::clone(&scene.scene);
    let (gpu, threads) = device;
    let found = py.detach(|| {
        if let Some(name) = gpu {
            all(gpu::open(&name)?, &scene, &settings)
        } else {
            all(if threads == 0 { Cpu::new()? } else { Cpu::with_threads(threads)? }, &scene, &settings)
        }
    })?;
    py.check_signals()?;
    let units = scene.units();
    let count: usize = found.values().map(Vec::len).sum();
    let mut positions = Vec::with_capacity(3 * count);
    let (mut normals, mut directions) = (Vec::with_capacity(3 * count), Vec::with_capacity(3 * count));
    let (mut powers, mut kinds) = (Vec::with_capacity(3 * count), Vec::with_capacity(count));
    let power = units.power / f64::from(settings.photons);
    for (kind, photons) in (0_u8..).zip(found.values()) {
        for photon in photons {
            positions.extend(units.point_to_user(photon.position));
            normals.extend(octahedral::unpack(photon.normal).to_array());
            directions.extend(octahedral::unpack(photon.direction).to_array());
            powers.extend(photon.power.map(|part| f64::from(part) * power));
            kinds.push(kind);
        }
    }
    Ok((
        positions.into_pyarray(py),
        normals.into_pyarray(py),
        directions.into_pyarray(py),
        powers.into_pyarray(py),
        kinds.into_pyarray(py),
    ))
}

/// The photons of all paths of pass 0, batch by batch.
fn all<B: TransportBackend>(mut on: B, scene: &Scene, settings: &Settings) -> Result<PerMap<Vec<Photon>>, Failure> {
    let view = scene.view();
    if view.triangles.is_empty() {
        return Err(photonmap::Error::NoTriangles.into());
    }
    if !view.lights.iter().any(|light| light.power.iter().any(|&part| part > 0.0)) {
        return Err(photonmap::Error::NoLight.into());
    }
    let mut required = Requirements::of(&view, settings);
    required.photon_format = PhotonFormat::Full;
    let prepared = on.prepare(&view, &required)?;
    let mut stages = on.stages(&required, settings)?;
    let step = on.batch().min(settings.photons);
    let mut rays = on.alloc::<PhotonRay>("photon rays", step.into())?;
    let mut capacity = PerMap::from_fn(|_| 4 * u64::from(step));
    let mut found = PerMap::from_fn(|_| Vec::new());
    let pass = Pass { seed: settings.seed, index: 0, random: settings.random, sample: 0, samples: 1 };
    let mut first = 0;
    while first < settings.photons {
        let end = first.saturating_add(step).min(settings.photons);
        let batch = Batch { pass, paths: first..end };
        let mut buffers = PerMap::default();
        for kind in MapKind::ALL.into_iter().filter(|&kind| required.maps[kind]) {
            buffers[kind] = Some(on.alloc_photons(kind.label(), capacity[kind], PhotonFormat::Full)?);
        }
        let mut deposits: Deposits<'_, B> = PerMap::default();
        for (kind, buffer) in MapKind::ALL.into_iter().zip(buffers.values_mut()) {
            deposits[kind] = buffer.as_mut();
        }
        stages.emitter.emit(&mut on, &prepared, &batch, &mut rays)?;
        stages.tracer.trace(&mut on, &prepared, &batch, &rays, deposits, MediaDeposits::default())?;
        stages.tracer.take_tally(&mut on)?;
        let mut is_full = false;
        for kind in MapKind::ALL {
            if let Some(buffer) = &buffers[kind] {
                let fill = on.fill(buffer)?;
                if fill.needed > fill.capacity {
                    capacity[kind] = fill.needed + fill.needed / 8;
                    is_full = true;
                }
            }
        }
        // A batch that did not fit is traced again: paths depend on their index alone.
        if is_full {
            continue;
        }
        let mut photons = Vec::new();
        for kind in MapKind::ALL {
            if let Some(buffer) = &buffers[kind] {
                on.download(buffer, &mut photons)?;
                found[kind].append(&mut photons);
            }
        }
        first = end;
    }
    Ok(found)
}

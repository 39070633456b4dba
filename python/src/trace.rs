//! Photons out of the library, and estimates from photons of the caller.

use std::sync::{Arc, Mutex, PoisonError};

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use photonmap::cpu::Cpu;
use photonmap::glam::DVec3;
use photonmap::scene::Scene;
use photonmap::{
    Backend, Batch, Deposits, Direct, Estimate, EstimateParams, Indirect, Kernel, MapKind, MapStages, Pass, PerMap,
    Photon, PhotonFormat, PhotonRay, Query, Requirements, Search, Settings, TransportBackend, octahedral,
};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::frame::Frame;
use crate::gpu;
use crate::points::refuse;
use crate::process::Local;
use crate::render::parse;
use crate::scene::RawScene;
use crate::tree::vectors;

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
    device: (bool, usize),
) -> PyResult<Photons<'py>> {
    let settings = Settings { direct: Direct::Photons, indirect: Indirect::Map, caustics: true, ..parse(settings)? };
    settings.validate().map_err(Failure::from)?;
    let scene = Arc::clone(&scene.scene);
    let (gpu, threads) = device;
    let found = py.detach(|| {
        if gpu {
            all(gpu::open()?, &scene, &settings)
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
    let pass = Pass { seed: settings.seed, index: 0, random: settings.random };
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
        stages.tracer.trace(&mut on, &prepared, &batch, &rays, deposits)?;
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

/// A map on a device: the estimates of queries, whatever the device.
trait AnyMap: Send {
    fn estimate(&mut self, queries: &[Query], params: &EstimateParams) -> Result<Vec<Estimate>, Failure>;
}

struct MapOn<B: Backend> {
    // Dropped before the device that they are on.
    map: B::PhotonMap,
    stages: MapStages<B>,
    on: B,
}

impl<B: Backend> MapOn<B> {
    fn new(mut on: B, photons: &[Photon], settings: &Settings) -> Result<Self, Failure> {
        let mut stages = on.map_stages(settings.index)?;
        let uploaded = on.upload("photons", photons)?;
        let map = stages.builder.build(&mut on, uploaded)?;
        Ok(Self { map, stages, on })
    }
}

impl<B: Backend> AnyMap for MapOn<B> {
    fn estimate(&mut self, queries: &[Query], params: &EstimateParams) -> Result<Vec<Estimate>, Failure> {
        let queries = self.on.upload("queries", queries)?;
        let count = self.on.fill(&queries)?.length;
        let mut buffer = self.on.alloc::<Estimate>("estimates", count)?;
        self.stages.estimator.estimate(&mut self.on, &self.map, &queries, params, &mut buffer)?;
        let mut estimates = Vec::new();
        self.on.download(&buffer, &mut estimates)?;
        Ok(estimates)
    }
}

/// Photons of the caller, arranged for estimates.
#[pyclass(frozen, module = "photonmap._photonmap")]
pub(crate) struct RawMap {
    map: Mutex<Local<Box<dyn AnyMap>>>,
    frame: Frame,
    count: usize,
    /// Watts of one unit of power.
    power: f64,
}

/// Queries that are answered at once.
const ROUND: usize = 1 << 18;

#[pymethods]
impl RawMap {
    /// Positions, normals and powers, flat; `device`: whether it is a GPU, and the number of threads, 0 for all cores.
    #[new]
    fn new(
        py: Python<'_>,
        positions: PyReadonlyArray1<'_, f64>,
        normals: PyReadonlyArray1<'_, f64>,
        powers: PyReadonlyArray1<'_, f64>,
        device: (bool, usize),
    ) -> PyResult<Self> {
        let (positions, normals, powers) = (vectors(&positions)?, vectors(&normals)?, vectors(&powers)?);
        let (gpu, threads) = device;
        let made = py.detach(|| {
            refuse("position", &positions)?;
            let normals = units("normal", &normals)?;
            refuse("power", &powers)?;
            let power = powers.iter().flatten().fold(0.0, |most: f64, part| most.max(part.abs()));
            let power = if power > 0.0 { power } else { 1.0 };
            let frame = Frame::new(&positions);
            let photons: Vec<Photon> = positions
                .iter()
                .zip(&normals)
                .zip(&powers)
                .map(|((position, normal), of)| Photon {
                    position: frame.rounded(position),
                    normal: octahedral::pack(normal.as_vec3()),
                    power: of.map(|part| (part / power) as f32),
                    direction: 0,
                })
                .collect();
            let settings = Settings::default();
            let map: Box<dyn AnyMap> = if gpu {
                Box::new(MapOn::new(gpu::open()?, &photons, &settings)?)
            } else {
                let on = if threads == 0 { Cpu::new()? } else { Cpu::with_threads(threads)? };
                Box::new(MapOn::new(on, &photons, &settings)?)
            };
            Ok::<_, Failure>(Self { map: Mutex::new(Local::new(map)), frame, count: photons.len(), power })
        });
        Ok(made?)
    }

    fn __len__(&self) -> usize {
        self.count
    }

    /// Irradiance at points with normals: all photons within `radius`, or the `k` nearest within it.
    #[expect(clippy::too_many_arguments, reason = "the arguments of the Python method")]
    fn irradiance<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray1<'_, f64>,
        normals: PyReadonlyArray1<'_, f64>,
        k: Option<u32>,
        radius: f64,
        kernel: &str,
        min_normal_cosine: f32,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (points, normals) = (vectors(&points)?, vectors(&normals)?);
        let kernel: Kernel = kernel.parse().map_err(Failure::from)?;
        if !(-1.0..=1.0).contains(&min_normal_cosine) {
            let text = format!("min_normal_cosine is {min_normal_cosine}, but must lie between -1 and 1");
            return Err(Failure::input(text).into());
        }
        let search = k.map_or(Search::Radius, |k| Search::KNearest { k });
        let params = EstimateParams { kernel, min_normal_cosine, ..EstimateParams::new(search) };
        params.validate().map_err(Failure::from)?;
        refuse("x", &points)?;
        let normals = units("normals", &normals)?;
        let scale = self.frame.scale();
        let queries: Vec<Query> = points
            .iter()
            .zip(&normals)
            .map(|(point, normal)| {
                let probe = self.frame.probe(*point);
                // Far from all photons: a place where nothing is found within a finite radius.
                let position = probe.rounded.unwrap_or([FAR; 3]);
                let radius = (radius * scale).min(f64::from(FAR) * 0.5) as f32;
                Query {
                    position,
                    radius: radius.max(f32::MIN_POSITIVE),
                    normal: normal.as_vec3().to_array(),
                    ..Query::default()
                }
            })
            .collect();
        // Per squared length of the user, with two factors, as the square may overflow.
        let mut irradiance = Vec::with_capacity(3 * queries.len());
        for queries in queries.chunks(ROUND) {
            let estimates = py.detach(|| {
                let mut map = self.map.lock().unwrap_or_else(PoisonError::into_inner);
                map.get("this photon map")?.estimate(queries, &params)
            })?;
            for estimate in estimates {
                irradiance.extend(estimate.irradiance(1).map(|part| part * self.power * scale * scale));
            }
            py.check_signals()?;
        }
        Ok(irradiance.into_pyarray(py))
    }
}

/// A coordinate in the frame that is far from all photons, whose square is finite.
const FAR: f32 = 1e9;

/// Unit vectors.
fn units(what: &str, vectors: &[[f64; 3]]) -> Result<Vec<DVec3>, Failure> {
    let mut units = Vec::with_capacity(vectors.len());
    for (index, vector) in vectors.iter().enumerate() {
        let largest = vector.iter().fold(0.0_f64, |most, part| most.max(part.abs()));
        // Divided first, so that no square overflows.
        let unit = (DVec3::from_array(*vector) / largest).normalize_or_zero();
        if !(vector.iter().all(|part| part.is_finite()) && unit != DVec3::ZERO) {
            return Err(Failure::input(format!(
                "{what}[{index}] = {vector:?} has no direction: it must be finite and not 0"
            )));
        }
        units.push(unit);
    }
    Ok(units)
}

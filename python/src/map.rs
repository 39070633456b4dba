//! Estimates from photons of the caller.

use std::sync::{Mutex, PoisonError};

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use photonmap::cpu::Cpu;
use photonmap::glam::DVec3;
use photonmap::{Backend, Estimate, EstimateParams, IndexKind, Kernel, MapStages, Photon, Query, Search, octahedral};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::frame::Frame;
use crate::gpu;
use crate::points::refuse;
use crate::process::Local;
use crate::tree::vectors;

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
    fn new(mut on: B, photons: &[Photon]) -> Result<Self, Failure> {
        let mut stages = on.map_stages(IndexKind::default())?;
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
    /// Positions, normals and powers, flat; `device`: a GPU as [`gpu::open`] names it, or the CPU, and the number of threads, 0 for all cores.
    #[new]
    fn new(
        py: Python<'_>,
        positions: PyReadonlyArray1<'_, f64>,
        normals: PyReadonlyArray1<'_, f64>,
        powers: PyReadonlyArray1<'_, f64>,
        device: (Option<String>, usize),
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
            let map: Box<dyn AnyMap> = if let Some(name) = gpu {
                Box::new(MapOn::new(gpu::open(&name)?, &photons)?)
            } else {
                let on = if threads == 0 { Cpu::new()? } else { Cpu::with_threads(threads)? };
                Box::new(MapOn::new(on, &photons)?)
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

//! `photonmap._photonmap.Tree`: searches for many queries at once. `photonmap.KDTree` has the conventions of scipy.

use std::sync::{Mutex, PoisonError};

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::error::Failure;
use crate::gpu::GpuPoints;
use crate::points::{Points, Scratch, refuse};
use crate::process::{self, Local};

/// Queries per parallel task: enough for the radius of one query to help the next.
const CHUNK: usize = 512;

/// Queries between two checks for signals.
const ROUND: usize = 1 << 17;

/// Indices and distances, or several arrays of integers.
type Neighbours<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>);
type Rows<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>);

/// Points for searching. Arrays are flat: x, y, z of one point after another.
#[pyclass(frozen, module = "photonmap._photonmap")]
pub(crate) struct Tree {
    points: Points,
    gpu: Option<Mutex<Local<GpuPoints>>>,
}

#[pymethods]
impl Tree {
    /// The points are copied; `gpu`: its name, if k-NN and counts are computed there.
    #[new]
    fn new(py: Python<'_>, points: PyReadonlyArray1<'_, f64>, gpu: Option<String>) -> PyResult<Self> {
        let (pool, exact) = (process::pool(py, 0)?, vectors(&points)?);
        let made = py.detach(|| {
            pool.install(|| {
                let points = Points::new(exact)?;
                let gpu = match gpu {
                    Some(name) => Some(Mutex::new(Local::new(GpuPoints::new(&points, &name)?))),
                    None => None,
                };
                if gpu.is_none() {
                    points.index()?;
                }
                Ok::<_, Failure>(Self { points, gpu })
            })
        });
        Ok(made?)
    }

    /// The number of points.
    fn __len__(&self) -> usize {
        self.points.exact().len()
    }

    /// Description of the GPU, if there is one.
    fn device(&self) -> PyResult<Option<String>> {
        let Some(gpu) = &self.gpu else { return Ok(None) };
        let mut gpu = gpu.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Some(gpu.get("this tree")?.device()))
    }

    /// The points, flat.
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.points.exact().as_flattened())
    }

    /// The k nearest points of each query, nearer than `bound`: distances and indices.
    fn nearest<'py>(
        &self,
        py: Python<'py>,
        queries: PyReadonlyArray1<'_, f64>,
        k: usize,
        bound: f64,
        workers: usize,
    ) -> PyResult<Neighbours<'py>> {
        let (pool, queries) = (process::pool(py, workers)?, vectors(&queries)?);
        pool.install(|| refuse("x", &queries))?;
        let cells = queries.len().checked_mul(k);
        let mut distances = room("distances", cells, f64::INFINITY)?;
        let mut ids = room("indices", cells, 0_i64)?;
        if k > 0 {
            let step = if self.gpu.is_some() { GpuPoints::queries_at_once(k) } else { ROUND };
            let rounds = distances.chunks_mut(step * k).zip(ids.chunks_mut(step * k)).zip(queries.chunks(step));
            for ((distances, ids), queries) in rounds {
                py.detach(|| {
                    pool.install(|| match &self.gpu {
                        None => self.nearest_on_cpu(queries, k, bound, (distances, ids)),
                        Some(gpu) => self.nearest_on_gpu(gpu, queries, k, bound, (distances, ids)),
                    })
                })?;
                py.check_signals()?;
            }
        }
        Ok((distances.into_pyarray(py), ids.into_pyarray(py)))
    }

    /// The number of points within the radius of each query, boundary included.
    fn count<'py>(
        &self,
        py: Python<'py>,
        queries: PyReadonlyArray1<'_, f64>,
        radii: PyReadonlyArray1<'_, f64>,
        workers: usize,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let (pool, queries, radii) = (process::pool(py, workers)?, vectors(&queries)?, numbers(&radii));
        let counts = self.counts(py, &pool, &queries, &radii)?;
        Ok(counts.into_pyarray(py))
    }

    /// The points within the radius of each query, boundary included: where the indices of each query start, and those
    /// indices, ascending.
    fn within<'py>(
        &self,
        py: Python<'py>,
        queries: PyReadonlyArray1<'_, f64>,
        radii: PyReadonlyArray1<'_, f64>,
        workers: usize,
    ) -> PyResult<Rows<'py>> {
        let (pool, queries, radii) = (process::pool(py, workers)?, vectors(&queries)?, numbers(&radii));
        let counts = self.counts(py, &pool, &queries, &radii)?;
        let mut starts = room("row starts", counts.len().checked_add(1), 0_i64)?;
        let mut total = 0_usize;
        for (start, &count) in starts.iter_mut().skip(1).zip(&counts) {
            total += count as usize;
            *start = total as i64;
        }
        let mut ids = room("indices", Some(total), 0_i64)?;
        let mut rows = Vec::with_capacity(counts.len());
        let mut rest = ids.as_mut_slice();
        for &count in &counts {
            let (row, others) = rest.split_at_mut(count as usize);
            rows.push(row);
            rest = others;
        }
        for ((rows, queries), radii) in rows.chunks_mut(ROUND).zip(queries.chunks(ROUND)).zip(radii.chunks(ROUND)) {
            let fill = |((row, query), radius): ((&mut &mut [i64], &[f64; 3]), &f64)| {
                let mut to = row.iter_mut();
                self.points.visit(*query, *radius, |id| {
                    to.next().into_iter().for_each(|to| *to = i64::from(id));
                })?;
                row.sort_unstable();
                Ok::<_, Failure>(())
            };
            let rows = rows.par_iter_mut().zip(queries).zip(radii).with_min_len(64);
            py.detach(|| pool.install(|| rows.try_for_each(fill)))?;
            py.check_signals()?;
        }
        Ok((starts.into_pyarray(py), ids.into_pyarray(py)))
    }
}

impl Tree {
    fn nearest_on_cpu(
        &self,
        queries: &[[f64; 3]],
        k: usize,
        bound: f64,
        (distances, ids): (&mut [f64], &mut [i64]),
    ) -> Result<(), Failure> {
        let tasks = distances.par_chunks_mut(k * CHUNK).zip(ids.par_chunks_mut(k * CHUNK));
        tasks.zip(queries.par_chunks(CHUNK)).try_for_each(|((distances, ids), queries)| {
            let mut scratch = Scratch::default();
            let rows = distances.chunks_exact_mut(k).zip(ids.chunks_exact_mut(k));
            rows.zip(queries).try_for_each(|(row, query)| self.points.nearest(*query, bound, row, &mut scratch))
        })
    }

    fn nearest_on_gpu(
        &self,
        gpu: &Mutex<Local<GpuPoints>>,
        queries: &[[f64; 3]],
        k: usize,
        bound: f64,
        (distances, ids): (&mut [f64], &mut [i64]),
    ) -> Result<(), Failure> {
        let frame = self.points.frame();
        let probes: Vec<_> = queries.par_iter().map(|&query| frame.probe(query)).collect();
        let near: Vec<[f32; 3]> = probes.par_iter().map(|probe| probe.rounded.unwrap_or_default()).collect();
        let outer = probes.par_iter().map(|probe| probe.outer(bound * probe.scale)).reduce(|| 0.0, f32::max);
        let width = (k + crate::points::SPARE).min(self.points.exact().len());
        let rows = {
            let mut gpu = gpu.lock().unwrap_or_else(PoisonError::into_inner);
            // The square of the root may be below the number.
            gpu.get("this tree")?.candidates(&near, k, outer.sqrt().next_up())?
        };
        if width == 0 {
            distances.fill(f64::INFINITY);
            ids.fill(0);
            return Ok(());
        }
        let results = distances.par_chunks_mut(k).zip(ids.par_chunks_mut(k)).with_min_len(64);
        let queries = queries.par_iter().zip(&probes).zip(rows.par_chunks(width));
        results.zip(queries).try_for_each_init(Scratch::default, |scratch, (row, ((query, probe), found))| {
            let Some(rounded) = probe.rounded else { return self.points.nearest(*query, bound, row, scratch) };
            let end = found.iter().position(|&id| id == u32::MAX).unwrap_or(width);
            let last = found.get(end.wrapping_sub(1)).filter(|_| end == width).map(|&id| {
                let point = frame.rounded(&self.points.exact()[id as usize]);
                let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| rounded[axis] - point[axis]);
                x * x + y * y + z * z
            });
            let mut near: Vec<_> = found[..end].iter().map(|&id| self.points.candidate(probe, id)).collect();
            self.points.decide(probe, rounded, bound, last, &mut near, row)
        })
    }

    fn counts(
        &self,
        py: Python<'_>,
        pool: &rayon::ThreadPool,
        queries: &[[f64; 3]],
        radii: &[f64],
    ) -> PyResult<Vec<i64>> {
        pool.install(|| refuse("x", queries))?;
        if let Some(at) = radii.iter().position(|radius| !(*radius >= 0.0)) {
            let text = format!("r is {} for query {at}, but must be a number of at least 0", radii[at]);
            return Err(Failure::input(text).into());
        }
        let mut counts = room("counts", Some(queries.len()), 0_i64)?;
        for ((counts, queries), radii) in counts.chunks_mut(ROUND).zip(queries.chunks(ROUND)).zip(radii.chunks(ROUND)) {
            py.detach(|| {
                pool.install(|| match &self.gpu {
                    Some(gpu) => self.count_on_gpu(gpu, queries, radii, counts),
                    None => self.count_on_cpu(queries, radii, counts),
                })
            })?;
            py.check_signals()?;
        }
        Ok(counts)
    }

    fn count_on_cpu(&self, queries: &[[f64; 3]], radii: &[f64], counts: &mut [i64]) -> Result<(), Failure> {
        counts.par_iter_mut().zip(queries).zip(radii).with_min_len(64).try_for_each(|((count, query), radius)| {
            *count = self.points.count(*query, *radius)? as i64;
            Ok(())
        })
    }

    /// Counts on the GPU, if all radii are equal. Where points are too near the boundary for f32, the CPU decides.
    fn count_on_gpu(
        &self,
        gpu: &Mutex<Local<GpuPoints>>,
        queries: &[[f64; 3]],
        radii: &[f64],
        counts: &mut [i64],
    ) -> Result<(), Failure> {
        let radius = radii.first().copied().unwrap_or_default();
        if radii.iter().any(|other| *other != radius) {
            return self.count_on_cpu(queries, radii, counts);
        }
        let frame = self.points.frame();
        let probes: Vec<_> = queries.par_iter().map(|&query| frame.probe(query)).collect();
        let near: Vec<[f32; 3]> = probes.par_iter().map(|probe| probe.rounded.unwrap_or_default()).collect();
        let local = probes.iter().filter(|probe| probe.rounded.is_some());
        let (inner, outer) = local.fold((f32::INFINITY, 0.0_f32), |(inner, outer), probe| {
            (inner.min(probe.inner(radius * probe.scale)), outer.max(probe.outer(radius * probe.scale)))
        });
        let (least, most) = {
            let mut gpu = gpu.lock().unwrap_or_else(PoisonError::into_inner);
            let gpu = gpu.get("this tree")?;
            let least = if inner > 0.0 { gpu.count(&near, inner.sqrt().next_down())? } else { vec![0; near.len()] };
            (least, gpu.count(&near, outer.sqrt().next_up())?)
        };
        let bounds = least.par_iter().zip(&most).zip(&probes);
        counts.par_iter_mut().zip(queries).zip(bounds).try_for_each(|((count, query), ((least, most), probe))| {
            let certain = least == most && probe.rounded.is_some();
            *count = if certain { i64::from(*most) } else { self.points.count(*query, radius)? as i64 };
            Ok(())
        })
    }
}

/// The vectors of a flat array.
pub(crate) fn vectors(array: &PyReadonlyArray1<'_, f64>) -> Result<Vec<[f64; 3]>, Failure> {
    let flat = numbers(array);
    let (vectors, rest) = flat.as_chunks::<3>();
    if rest.is_empty() { Ok(vectors.to_vec()) } else { Err(Failure::input("coordinates must come in threes")) }
}

/// The numbers of an array of any stride.
pub(crate) fn numbers(array: &PyReadonlyArray1<'_, f64>) -> Vec<f64> {
    array.as_array().iter().copied().collect()
}

/// A vector of `count` elements; an error if there is no memory for them.
fn room<T: Copy>(what: &str, count: Option<usize>, value: T) -> Result<Vec<T>, Failure> {
    let mut all = Vec::new();
    let bytes = |count: usize| count as u128 * size_of::<T>() as u128;
    let count = count.ok_or_else(|| Failure::memory(what, u128::from(u64::MAX)))?;
    all.try_reserve_exact(count).map_err(|_| Failure::memory(what, bytes(count)))?;
    all.resize(count, value);
    Ok(all)
}

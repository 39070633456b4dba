//! Precomputed irradiance at photon positions.

use photon_core::{Estimate, IrradiancePoints, Photon, PhotonFormat, Query, Result, octahedral};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::map::CpuMap;

/// Precomputes irradiance at every n-th photon.
#[derive(Debug)]
pub(crate) struct CpuIrradiance;

impl IrradiancePoints<Cpu> for CpuIrradiance {
    fn places(&mut self, on: &mut Cpu, map: &CpuMap, every: u32, queries: &mut CpuBuffer<Query>) -> Result<()> {
        let first = queries.data.len();
        let count = map.len().div_ceil(every as usize);
        queries.needed += count as u64;
        let fit = count.min(queries.capacity as usize - first);
        queries.data.resize(first + fit, Query::default());
        on.pool.install(|| {
            queries.data[first..].par_iter_mut().with_min_len(4096).enumerate().for_each(|(i, query)| {
                let slot = i as u32 * every;
                *query = Query {
                    position: map.index().position(slot),
                    radius: 1.0,
                    normal: map.normal(slot).into(),
                    path: (first + i) as u32,
                    ..Query::default()
                };
            });
        });
        Ok(())
    }

    fn add(
        &mut self,
        on: &mut Cpu,
        queries: &CpuBuffer<Query>,
        estimates: &CpuBuffer<Estimate>,
        paths: u64,
        first: bool,
        points: &mut CpuBuffer<Photon>,
    ) -> Result<()> {
        let fit = queries.data.len().min(points.capacity as usize);
        if first {
            points.needed = queries.data.len() as u64;
            points.data.resize(fit, Photon::default());
        }
        on.pool.install(|| {
            let asked = queries.data.par_iter().zip(&estimates.data);
            points.data.par_iter_mut().with_min_len(4096).zip(asked).for_each(|(point, (query, estimate))| {
                if first {
                    let normal = octahedral::pack(query.normal.into());
                    *point = Photon { position: query.position, direction: normal, power: [0.0; 3], normal };
                }
                for (sum, irradiance) in point.power.iter_mut().zip(estimate.irradiance(paths)) {
                    *sum += irradiance as f32;
                }
            });
        });
        Ok(())
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }
}

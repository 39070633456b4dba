//! Renders one experiment on one backend, and measures the time of each stage.

use std::time::Instant;

use photon_core::{
    Batch, Deposits, Estimate, EyeBuffers, Film, Layer, MapKind, MediaDeposits, Pass, PerMap, Photon, PhotonRay,
    QUERIES_PER_PIXEL, Query, Requirements, Result, Stage, StageTimings, TransportBackend, View,
};
use photon_scene::Scene;

use crate::calibrate::Sizes;
use crate::experiment::Experiment;

/// Measurements of one experiment: the median of its repetitions.
#[derive(Debug)]
pub(crate) struct Measured {
    /// Seconds from the first path to the finished picture.
    pub(crate) wall: f64,
    /// Seconds per stage, by the backend's own clock.
    pub(crate) stages: StageTimings,
    /// Number of paths emitted, and of photons in the caustic and in the global map.
    pub(crate) paths: u64,
    pub(crate) stored: [u64; 2],
    /// Mean radiance of each layer of the picture, mean of RGB.
    pub(crate) layers: [f64; 4],
}

impl Measured {
    /// Seconds of all stages.
    pub(crate) fn work(&self) -> f64 {
        Stage::ALL.iter().map(|&stage| self.stages.get(stage)).sum()
    }
}

/// A scene on a backend.
pub(crate) struct Studio<'s, B: TransportBackend> {
    pub(crate) on: B,
    source: &'s Scene,
    scene: B::Scene,
    required: Requirements,
    view: View,
}

/// Photons to be stored in the caustic and the global map, and the number of paths that emitted them.
struct Lane<B: TransportBackend> {
    photons: Option<B::Buffer<Photon>>,
    paths: u32,
    radius: f32,
}

impl<'s, B: TransportBackend> Studio<'s, B> {
    pub(crate) fn new(mut on: B, source: &'s Scene, view: View) -> Result<Self> {
        let mut required = Requirements::of(&source.view(), &Experiment::large(1)[0].settings);
        // Both maps are requested, also in a scene where one stays empty.
        (required.maps[MapKind::Caustic], required.maps[MapKind::Global]) = (true, true);
        let scene = on.prepare(&source.view(), &required)?;
        Ok(Self { on, source, scene, required, view })
    }

    /// Renders the experiment `repeats` times, after `warm_ups` that are discarded.
    pub(crate) fn run(
        &mut self,
        experiment: &Experiment,
        sizes: &Sizes,
        warm_ups: usize,
        repeats: usize,
    ) -> Result<(Measured, Film)> {
        let mut stages = self.on.stages(&self.required, &experiment.settings)?;
        let mut film = self.on.film(self.source.units(), self.view.width, self.view.height)?;
        let pixels = u64::from(self.view.width) * u64::from(self.view.height);
        let splits = self.required.features.splits_camera_paths();
        let most = pixels * if splits { u64::from(QUERIES_PER_PIXEL) } else { 1 };
        let mut rays = self.on.alloc::<PhotonRay>("photon rays", u64::from(self.on.batch()))?;
        let mut queries = self.on.alloc::<Query>("queries", most)?;
        let mut estimates = self.on.alloc::<Estimate>("estimates", most)?;
        let mut lanes = [self.lane(sizes.caustic)?, self.lane(sizes.global)?];
        self.on.timings()?;

        let (mut walls, mut timings, mut stored) = (Vec::new(), Vec::new(), [0; 2]);
        for repeat in 0..warm_ups + repeats {
            let begun = Instant::now();
            let pass = |index| Pass {
                seed: experiment.settings.seed,
                index,
                random: experiment.settings.random,
                sample: 0,
                samples: 1,
            };
            if experiment.together {
                let [caustic, global] = &mut lanes;
                self.fill(&mut stages, pass(0), global.paths, &mut rays, [&mut caustic.photons, &mut global.photons])?;
            } else {
                // Each map has its own number of paths, hence its own emission.
                let [caustic, global] = &mut lanes;
                self.fill(&mut stages, pass(0), caustic.paths, &mut rays, [&mut caustic.photons, &mut None])?;
                self.fill(&mut stages, pass(1), global.paths, &mut rays, [&mut None, &mut global.photons])?;
            }
            self.on.mark(Some(Stage::Eye));
            let buffers = EyeBuffers { queries: &mut queries, segments: None };
            stages.eye.trace_eye(&mut self.on, &self.scene, &self.view, pass(0), &mut film, buffers)?;
            if let Some(direct) = &mut stages.direct {
                self.on.mark(Some(Stage::Direct));
                let rays = experiment.settings.shadow_rays;
                direct.light(&mut self.on, &self.scene, pass(0), &queries, rays, &mut film)?;
            }
            let maps = [(&experiment.caustic, Layer::Caustic), (&experiment.global, Layer::Indirect)];
            for (lane, (lane_plan, layer)) in maps.into_iter().enumerate() {
                let (Some(map_plan), Some(photons)) = (lane_plan, lanes[lane].photons.take()) else { continue };
                stored[lane] = self.on.fill(&photons)?.length;
                self.on.mark(Some(Stage::Build));
                let map = stages.map.builder.build(&mut self.on, photons)?;
                self.on.mark(Some(Stage::Estimate));
                let gather = experiment.gather(map_plan, lanes[lane].radius);
                stages.map.estimator.estimate(&mut self.on, &map, &queries, &gather, &mut estimates)?;
                self.on.mark(Some(Stage::Film));
                self.on.accumulate(&mut film, layer, &queries, &estimates, u64::from(lanes[lane].paths))?;
                lanes[lane].photons = Some(stages.map.builder.reclaim(map));
            }
            self.on.mark(Some(Stage::Film));
            self.on.end_pass(&mut film)?;
            self.on.mark(None);
            let seconds = self.on.timings()?;
            if repeat >= warm_ups {
                walls.push(begun.elapsed().as_secs_f64());
                timings.push(seconds);
            }
        }
        let paths = if experiment.together { lanes[1].paths } else { lanes[0].paths + lanes[1].paths };
        let film = self.on.read_film(&film)?;
        let layers = Layer::ALL.map(|layer| {
            let radiance = film.layer(layer);
            radiance.iter().flatten().map(|&c| f64::from(c)).sum::<f64>() / (3 * radiance.len()) as f64
        });
        Ok((Measured { wall: median(walls), stages: middle(&timings), paths: u64::from(paths), stored, layers }, film))
    }

    fn lane(&mut self, size: Option<crate::calibrate::Size>) -> Result<Lane<B>> {
        let Some(size) = size else { return Ok(Lane { photons: None, paths: 0, radius: 0.0 }) };
        let photons = self.on.alloc::<Photon>("photons", size.capacity)?;
        Ok(Lane { photons: Some(photons), paths: size.paths, radius: size.radius })
    }

    /// Traces that many paths into the maps that are used.
    pub(crate) fn fill(
        &mut self,
        stages: &mut photon_core::Stages<B>,
        pass: Pass,
        paths: u32,
        rays: &mut B::Buffer<PhotonRay>,
        [caustic, global]: [&mut Option<B::Buffer<Photon>>; 2],
    ) -> Result<()> {
        for photons in [&mut *caustic, &mut *global].into_iter().flatten() {
            self.on.clear(photons)?;
        }
        let mut first = 0;
        while first < paths {
            let end = first.saturating_add(self.on.batch()).min(paths);
            let batch = Batch { pass, paths: first..end };
            self.on.mark(Some(Stage::Emit));
            stages.emitter.emit(&mut self.on, &self.scene, &batch, rays)?;
            self.on.mark(Some(Stage::Trace));
            let mut deposits: Deposits<'_, B> = PerMap::default();
            deposits[MapKind::Caustic] = caustic.as_mut();
            deposits[MapKind::Global] = global.as_mut();
            stages.tracer.trace(&mut self.on, &self.scene, &batch, rays, deposits, MediaDeposits::default())?;
            first = end;
        }
        self.on.mark(None);
        if paths > 0 {
            stages.tracer.take_tally(&mut self.on)?;
        }
        for photons in [caustic, global].into_iter().flatten() {
            let fill = self.on.fill(photons)?;
            if fill.needed > fill.capacity {
                let (needed, capacity) = (fill.needed, fill.capacity);
                return Err(photon_core::Error::CapacityExceeded { label: "photons", needed, capacity });
            }
        }
        Ok(())
    }

    /// Photons of a few paths, to determine the sizes of a map.
    pub(crate) fn sample(&mut self, experiment: &Experiment, paths: u32) -> Result<[B::Buffer<Photon>; 2]> {
        let mut stages = self.on.stages(&self.required, &experiment.settings)?;
        let mut rays = self.on.alloc::<PhotonRay>("photon rays", u64::from(self.on.batch()))?;
        let capacity = u64::from(paths) * 16;
        let mut caustic = Some(self.on.alloc::<Photon>("photons", capacity)?);
        let mut global = Some(self.on.alloc::<Photon>("photons", capacity)?);
        let pass = Pass {
            seed: experiment.settings.seed,
            index: 2,
            random: photon_core::RandomKind::Counter,
            sample: 0,
            samples: 1,
        };
        self.fill(&mut stages, pass, paths, &mut rays, [&mut caustic, &mut global])?;
        match (caustic, global) {
            (Some(caustic), Some(global)) => Ok([caustic, global]),
            _ => Err(photon_core::Error::NoReceiver),
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The median of each stage.
fn middle(all: &[StageTimings]) -> StageTimings {
    let mut result = StageTimings::default();
    for stage in Stage::ALL {
        result.add(stage, median(all.iter().map(|one| one.get(stage)).collect()));
    }
    result
}

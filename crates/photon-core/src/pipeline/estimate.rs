//! Reading the maps of a pass.

use super::Pipeline;
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::film::Layer;
use crate::radii;
use crate::stages::{Maps, Pass, Told};

impl<B: TransportBackend> Pipeline<B> {
    /// Reads the maps, of so many paths each, at the queries, into the film.
    pub(super) fn estimate(&mut self, index: u32, paths: [u64; 3], queries: u64) -> Result<()> {
        self.on.mark(Some(Stage::Build));
        let mut maps: [Option<B::PhotonMap>; 3] = [None, None, None];
        let mut lengths = [0; 3];
        for (i, (photons, map)) in self.photons.iter_mut().zip(&mut maps).enumerate() {
            // An empty map is not built: it has nothing to say.
            if let Some(filled) = photons.take() {
                let length = self.on.fill(&filled)?.length;
                if length == 0 {
                    *photons = Some(filled);
                } else {
                    lengths[i] = length;
                    *map = Some(self.stages.map.builder.build(&mut self.on, filled)?);
                }
            }
        }
        let radii = [self.radii.direct, self.radii.caustic, self.radii.global];
        let gathers = radii.map(|radius| radii::gather(&self.settings, radius, index));
        let shown = [
            self.settings.direct == crate::Direct::Photons,
            self.settings.caustics,
            self.settings.indirect == crate::Indirect::Map,
        ];
        let layers = [Layer::Direct, Layer::Caustic, Layer::Indirect];
        let pass = Pass { seed: self.settings.seed, index, random: self.settings.random };
        if let (Some(estimates), true) = (&mut self.estimates, queries > 0) {
            for i in 0..3 {
                let (Some(map), true) = (&maps[i], shown[i]) else { continue };
                self.on.mark(Some(Stage::Estimate));
                let (on, estimator) = (&mut self.on, &mut self.stages.map.estimator);
                match &mut self.spreads {
                    None => estimator.estimate(on, map, &self.queries, &gathers[i], estimates)?,
                    Some(spreads) => {
                        estimator.estimate_spread(on, map, &self.queries, &gathers[i], estimates, spreads)?;
                    }
                }
                if let Some(area) = &mut self.stages.area {
                    let told = Told { estimates, spreads: self.spreads.as_mut() };
                    area.correct(on, &self.scene, pass, &self.queries, &gathers[i], told)?;
                }
                on.mark(Some(Stage::Film));
                if let Some(spreads) = &self.spreads {
                    on.fold_errors(&mut self.film, layers[i], &self.queries, estimates, spreads, paths[i])?;
                }
                self.on.fold(&mut self.film, layers[i], &self.queries, estimates, paths[i])?;
            }
        }
        let gathers_rays = self.stages.gather.is_some() && queries > 0;
        self.on.mark(gathers_rays.then_some(Stage::Gather));
        let irradiance = if gathers_rays { self.irradiance(&maps, lengths, &gathers, pass, paths)? } else { None };
        if let (Some(stage), true) = (&mut self.stages.gather, gathers_rays) {
            let [direct, caustic, global] = &maps;
            let lent = Maps {
                direct: direct.as_ref().map(|map| (map, gathers[0])),
                caustic: caustic.as_ref().map(|map| (map, gathers[1])),
                global: global.as_ref().map(|map| (map, gathers[2])),
                irradiance: irradiance.as_ref().map(|(map, gather)| (map, *gather)),
                paths: paths[2],
                caustic_paths: paths[1],
            };
            let rays = self.settings.gather_rays;
            stage.gather(&mut self.on, &self.scene, &lent, pass, &self.queries, rays, &mut self.film)?;
        }
        self.on.mark(None);
        self.reclaim_irradiance(irradiance);
        for (photons, map) in self.photons.iter_mut().zip(maps) {
            if let Some(map) = map {
                *photons = Some(self.stages.map.builder.reclaim(map));
            }
        }
        Ok(())
    }
}

//! The experiments to render: the paper's grid in both interpretations, and a larger one of our own.

use photon_core::{EstimateParams, IndexKind, Kernel, RandomKind, Scheduling, Search, Settings};

/// The paper's seconds: caustic photons, global, on its CPU, on its GPU (Lin and Wang 2010, table of
/// results; Pentium 4 530 and GeForce 8600 GT).
pub(crate) const FIGURES: [(u32, u32, f64, f64); 7] = [
    (0, 0, 1.03, 0.532),
    (20_000, 200, 18.34, 1.82),
    (20_000, 1000, 39.53, 3.75),
    (50_000, 200, 18.87, 1.98),
    (50_000, 1000, 40.11, 3.93),
    (100_000, 200, 19.55, 2.23),
    (100_000, 1000, 41.29, 4.16),
];

/// Photons per estimate where the paper gives no number.
pub(crate) const MAX: u32 = 200;
/// Photons of the global map if "global" is interpreted as the size of an estimate.
const GLOBAL_MAP: u32 = 100_000;

/// Interpretation of the paper's column "global". The paper does not define it, and its times grow as if it were the
/// size of an estimate: by the same 20 seconds from 200 to 1000, however many caustic photons there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reading {
    /// Photons in the global map.
    Photons,
    /// Photons per estimate.
    Gather,
}

impl Reading {
    pub(crate) const ALL: [Self; 2] = [Self::Photons, Self::Gather];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::Gather => "gather",
        }
    }

    /// Description for the tables.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Photons => "the photons in the global map; 200 of them at most in an estimate",
            Self::Gather => "the most photons in an estimate; the global map holds 100 000",
        }
    }
}

/// One map: how many photons, and how radiance is estimated from them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MapParams {
    /// Required number of photons.
    pub(crate) photons: u32,
    /// Estimator.
    pub(crate) search: Search,
    /// Number of photons within the radius at a typical point.
    pub(crate) neighbours: u32,
}

/// One picture to render and time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Experiment {
    /// `pictures`, `photons`, `gather` or `large`.
    pub(crate) table: &'static str,
    /// Name in its table.
    pub(crate) name: String,
    /// The map of photons that were reflected and refracted by specular surfaces only.
    pub(crate) caustic: Option<MapParams>,
    /// The map of photons with at least one diffuse scattering.
    pub(crate) global: Option<MapParams>,
    /// Whether one emission fills both maps, so that the number of caustic photons is not free.
    pub(crate) together: bool,
    pub(crate) settings: Settings,
}

fn paper_search(max: u32) -> Search {
    Search::Paper { max, threshold: 8, factor: 1.0 }
}

fn paper_settings() -> Settings {
    Settings { shadow_rays: 4, ..Settings::paper() }
}

impl Experiment {
    /// A cell of the paper's table.
    pub(crate) fn cell(reading: Reading, caustic: u32, global: u32) -> Self {
        let map = |photons: u32, max: u32| {
            // If a map holds little more than an estimate takes, the estimate shall still be local.
            let neighbours = max.min(photons / 8).max(8);
            (photons > 0).then_some(MapParams { photons, search: paper_search(max), neighbours })
        };
        let read = match reading {
            Reading::Photons => map(global, MAX),
            Reading::Gather if global == 0 => None,
            Reading::Gather => map(GLOBAL_MAP, global),
        };
        Self {
            table: reading.name(),
            name: format!("{caustic}/{global}"),
            caustic: map(caustic, MAX),
            global: read,
            together: false,
            settings: paper_settings(),
        }
    }

    /// The paper's three pictures, and one by our defaults with the same number of photons. The name is that of
    /// the file.
    pub(crate) fn pictures() -> Vec<Self> {
        let picture = |name: &str, experiment: Self| Self { table: "pictures", name: name.to_owned(), ..experiment };
        let both = Self::cell(Reading::Gather, 100_000, 1000);
        let global = Self { caustic: None, ..both.clone() };
        let map = |photons, neighbours| Some(MapParams { photons, search: Search::Radius, neighbours });
        let defaults = Self {
            caustic: map(100_000, 50),
            global: map(GLOBAL_MAP, 200),
            settings: Settings { shadow_rays: 4, ..Settings::default() },
            ..both.clone()
        };
        vec![
            picture("no-photons", Self::cell(Reading::Gather, 0, 0)),
            picture("global", global),
            picture("global-caustic", both),
            picture("defaults", defaults),
        ]
    }

    /// Our own grid: the paper's method with that many photons in the global map, then with one of its choices
    /// replaced at a time, and finally with all of them replaced.
    pub(crate) fn large(photons: u32) -> Vec<Self> {
        let paper = paper_settings();
        let variants = [
            ("the paper's way", paper.clone()),
            ("dynamic sharing", Settings { scheduling: Scheduling::Dynamic, ..paper.clone() }),
            ("VVH kd-tree", Settings { index: IndexKind::Vvh, ..paper.clone() }),
            ("Morton order", Settings { index: IndexKind::Morton, ..paper.clone() }),
            ("counter-based numbers", Settings { random: RandomKind::Counter, ..paper }),
            ("our defaults", Settings { shadow_rays: 4, ..Settings::default() }),
        ];
        let experiment = |(name, settings): (&str, Settings)| {
            let ours = settings == Settings { shadow_rays: 4, ..Settings::default() };
            let map = |neighbours| {
                let search = if ours { Search::Radius } else { paper_search(MAX) };
                Some(MapParams { photons, search, neighbours: if ours { neighbours } else { MAX } })
            };
            // The defaults of a picture: see `photon_core`'s pipeline.
            let (caustic, global) = (map(12), map(64));
            Self { table: "large", name: name.to_owned(), caustic, global, together: true, settings }
        };
        variants.into_iter().map(experiment).collect()
    }

    /// The estimate parameters of a map, for a radius in normalised space.
    pub(crate) fn gather(&self, map: &MapParams, radius: f32) -> EstimateParams {
        let kernel = if map.search == Search::Radius { self.settings.kernel } else { Kernel::Constant };
        // The paper tests normals only by its equation (2).
        let min_normal_cosine = if map.search == Search::Radius { self.settings.min_normal_cosine } else { -1.0 };
        EstimateParams { kernel, radius_scale: radius, min_normal_cosine, ..EstimateParams::new(map.search) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_differ_in_what_global_counts() {
        let photons = Experiment::cell(Reading::Photons, 20_000, 1000);
        let gather = Experiment::cell(Reading::Gather, 20_000, 1000);
        assert_eq!(photons.caustic, gather.caustic);
        assert_eq!(photons.global.unwrap().photons, 1000);
        assert_eq!(gather.global.unwrap().search, paper_search(1000));
        assert!(Experiment::cell(Reading::Gather, 0, 0).global.is_none());
    }

    #[test]
    fn each_variant_exchanges_one_habit() {
        let all = Experiment::large(1000);
        let base = &all[0].settings;
        for other in &all[1..5] {
            let s = &other.settings;
            let differ = [s.scheduling != base.scheduling, s.index != base.index, s.random != base.random];
            assert_eq!(differ.iter().filter(|&&d| d).count(), 1, "{}", other.name);
        }
        assert_eq!(all[5].global.unwrap().search, Search::Radius);
    }
}

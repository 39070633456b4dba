//! What photons did, as `film.json` has it and as words for messages.

use std::collections::BTreeMap;

use photon_core::{FilmTally, FluxSum, MapKind, PerMap, Tally};
use serde::{Deserialize, Serialize};

/// [`FilmTally`] in `film.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StoredTally {
    /// Number of passes that were counted.
    pub(crate) passes: u32,
    photons: Counts,
    aimed: Counts,
    /// Absent from films of older versions.
    #[serde(default)]
    truncated_camera_paths: u64,
}

/// [`Tally`] in `film.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Counts {
    emitted: u64,
    absorbed: u64,
    escaped: u64,
    truncated: u64,
    dropped: u64,
    terminated: u64,
    surfaces: u64,
    too_deep: u64,
    /// By the name of the map.
    stored: BTreeMap<String, u64>,
    flux_emitted: Flux,
    flux_absorbed: Flux,
    flux_escaped: Flux,
    flux_truncated: Flux,
    flux_dropped: Flux,
    flux_terminated: Flux,
}

/// Red, green and blue in units of 2⁻⁴⁰ of the scene's power per path: decimal text, since numbers of JSON have 64 bits.
type Flux = [String; 3];

impl StoredTally {
    /// `None` if no pass was counted.
    pub(crate) fn new(tally: &FilmTally) -> Option<Self> {
        let &FilmTally { passes, truncated_camera_paths, .. } = tally;
        let stored = || Self {
            passes,
            photons: Counts::new(&tally.photons),
            aimed: Counts::new(&tally.aimed),
            truncated_camera_paths,
        };
        (passes > 0).then(stored)
    }

    /// The counts, or what is wrong with them.
    pub(crate) fn read(&self) -> Result<FilmTally, String> {
        let mut tally = FilmTally::default();
        (tally.passes, tally.photons, tally.aimed) = (self.passes, self.photons.read()?, self.aimed.read()?);
        tally.truncated_camera_paths = self.truncated_camera_paths;
        Ok(tally)
    }
}

impl Counts {
    fn new(tally: &Tally) -> Self {
        // Every member by name: a new one is an error here until it is stored.
        let &Tally {
            emitted,
            absorbed,
            escaped,
            truncated,
            dropped,
            terminated,
            surfaces,
            too_deep,
            stored,
            flux_emitted,
            flux_absorbed,
            flux_escaped,
            flux_truncated,
            flux_dropped,
            flux_terminated,
        } = tally;
        let flux = |sum: FluxSum| sum.units().map(|units| units.to_string());
        Self {
            emitted,
            absorbed,
            escaped,
            truncated,
            dropped,
            terminated,
            surfaces,
            too_deep,
            stored: stored.iter().map(|(kind, &count)| (kind.name().to_owned(), count)).collect(),
            flux_emitted: flux(flux_emitted),
            flux_absorbed: flux(flux_absorbed),
            flux_escaped: flux(flux_escaped),
            flux_truncated: flux(flux_truncated),
            flux_dropped: flux(flux_dropped),
            flux_terminated: flux(flux_terminated),
        }
    }

    fn read(&self) -> Result<Tally, String> {
        let known = |name: &String| MapKind::ALL.iter().any(|kind| kind.name() == name);
        if let Some(name) = self.stored.keys().find(|name| !known(name)) {
            return Err(format!("its counts name a map {name:?}"));
        }
        let flux = |texts: &Flux| {
            let mut units = [0; 3];
            for (unit, text) in units.iter_mut().zip(texts) {
                *unit = text.parse().map_err(|_| format!("its flux {text:?} is no whole number"))?;
            }
            Ok::<_, String>(FluxSum::from_units(units))
        };
        Ok(Tally {
            emitted: self.emitted,
            absorbed: self.absorbed,
            escaped: self.escaped,
            truncated: self.truncated,
            dropped: self.dropped,
            terminated: self.terminated,
            surfaces: self.surfaces,
            too_deep: self.too_deep,
            stored: PerMap::from_fn(|kind| self.stored.get(kind.name()).copied().unwrap_or_default()),
            flux_emitted: flux(&self.flux_emitted)?,
            flux_absorbed: flux(&self.flux_absorbed)?,
            flux_escaped: flux(&self.flux_escaped)?,
            flux_truncated: flux(&self.flux_truncated)?,
            flux_dropped: flux(&self.flux_dropped)?,
            flux_terminated: flux(&self.flux_terminated)?,
        })
    }
}

/// The counts as text, for messages between processes of one program.
#[must_use]
pub fn tally_to_text(tally: &FilmTally) -> String {
    // Numbers and names can always be written.
    serde_json::to_string(&StoredTally::new(tally)).unwrap_or_default()
}

/// Reads the counts of [`tally_to_text`].
///
/// # Errors
/// What is wrong with the text.
pub fn tally_from_text(text: &str) -> Result<FilmTally, String> {
    let stored: Option<StoredTally> = serde_json::from_str(text).map_err(|error| error.to_string())?;
    stored.map_or(Ok(FilmTally::default()), |stored| stored.read())
}

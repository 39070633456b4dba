//! The measurements, as tables beside the paper's own figures.

use std::fmt::Write as _;

use photon_core::Stage;

use crate::biases::Bias;
use crate::experiment::{Experiment, FIGURES, Reading};
use crate::studio::Measured;
use crate::table::{Table, csv_heading, csv_row, seconds, times};

/// Results of one backend.
#[derive(Debug)]
pub(crate) struct Results {
    pub(crate) backend: &'static str,
    pub(crate) device: String,
    pub(crate) cells: Vec<(Experiment, Measured)>,
    pub(crate) biases: Vec<Bias>,
    /// Number of cells for which there was no time.
    pub(crate) left_out: u32,
}

impl Results {
    pub(crate) fn new(backend: &'static str, device: String) -> Self {
        Self { backend, device, cells: Vec::new(), biases: Vec::new(), left_out: 0 }
    }

    fn cell(&self, experiment: &Experiment) -> Option<&Measured> {
        self.cells.iter().find(|(other, _)| other == experiment).map(|(_, measured)| measured)
    }
}

/// Results of all backends.
#[derive(Debug, Default)]
pub(crate) struct Report {
    all: Vec<Results>,
}

impl Report {
    pub(crate) fn add(&mut self, results: Results) {
        self.all.push(results);
        // In the paper's order: the CPU's column before the GPU's.
        self.all.sort_by_key(|results| results.backend);
    }

    /// Every cell, with its seconds per stage.
    pub(crate) fn csv(&self) -> String {
        let rows = self.all.iter().flat_map(|results| {
            results
                .cells
                .iter()
                .map(|(experiment, measured)| csv_row(results.backend, &results.device, experiment, measured))
        });
        std::iter::once(csv_heading()).chain(rows).collect()
    }

    /// The paper's grid in both interpretations.
    pub(crate) fn grid(&self) -> String {
        let mut headings = vec!["caustic / \"global\"", "paper's CPU", "paper's GPU", "ratio"];
        for results in &self.all {
            headings.extend([results.backend, "faster than the paper's"]);
        }
        if self.all.len() == 2 {
            headings.push("ratio");
        }
        let mut text = String::new();
        for reading in Reading::ALL {
            let _ = writeln!(text, "\"Global\" read as {}:\n", reading.words());
            let mut table = Table::new(&headings);
            for (caustic, global, cpu, gpu) in FIGURES {
                let mut row = vec![format!("{caustic} / {global}"), seconds(cpu), seconds(gpu), times(cpu / gpu)];
                let experiment = Experiment::cell(reading, caustic, global);
                let found: Vec<_> = self.all.iter().map(|results| (results, results.cell(&experiment))).collect();
                for (results, measured) in &found {
                    // Each compared with the paper's backend of the same kind.
                    let papers = if results.backend == "cpu" { cpu } else { gpu };
                    row.push(measured.map_or("-".to_owned(), |m| seconds(m.wall)));
                    row.push(measured.map_or("-".to_owned(), |m| times(papers / m.wall)));
                }
                if let [(_, Some(one)), (_, Some(other))] = found.as_slice() {
                    row.push(times(one.wall / other.wall));
                }
                table.row(row);
            }
            let _ = writeln!(text, "{}", table.text());
        }
        text
    }

    /// The pictures and our own grid, stage by stage: the cost of each choice of the paper.
    fn by_stage(&self) -> String {
        let stages = [Stage::Emit, Stage::Trace, Stage::Build, Stage::Eye, Stage::Direct, Stage::Estimate, Stage::Film];
        let mut headings = vec!["way", "caustic", "global", "paths", "together"];
        headings.extend(stages.map(Stage::name));
        let mut text = String::new();
        for results in &self.all {
            let mut table = Table::new(&headings);
            for (experiment, measured) in &results.cells {
                let title = match experiment.table {
                    "large" => format!("{}, {}", experiment.global.map_or(0, |map| map.photons), experiment.name),
                    "pictures" => format!("picture: {}", experiment.name),
                    _ => continue,
                };
                let [caustic, global] = measured.stored.map(|n| n.to_string());
                let mut row = vec![title, caustic, global, measured.paths.to_string(), seconds(measured.wall)];
                row.extend(stages.map(|stage| seconds(measured.stages.get(stage))));
                table.row(row);
            }
            let _ = writeln!(text, "{}:\n\n{}", results.backend, table.text());
        }
        text
    }

    /// The errors of the paper's formulas.
    fn biases(&self) -> String {
        let mut text = String::new();
        for results in &self.all {
            let mut table = Table::new(&["error", "predicted", "paper's method", "defaults", "as predicted"]);
            for bias in &results.biases {
                let with_error = |(value, error): (f64, f64)| format!("{value:.4} ± {error:.4}");
                table.row(vec![
                    bias.what.to_owned(),
                    format!("{:.4}", bias.predicted),
                    with_error(bias.paper),
                    with_error(bias.ours),
                    if bias.is_as_predicted() { "yes" } else { "no" }.to_owned(),
                ]);
            }
            let _ = writeln!(text, "{}:\n\n{}", results.backend, table.text());
        }
        text
    }

    /// Mean radiance of the pictures' layers, and of the two that the maps give, compared with those of the
    /// defaults with the same number of photons.
    fn pictures(&self) -> String {
        let headings = ["picture", "emission", "direct", "caustic", "of defaults", "indirect", "of defaults", "time"];
        let mut table = Table::new(&headings);
        for results in &self.all {
            let pictures = || results.cells.iter().filter(|(experiment, _)| experiment.table == "pictures");
            let defaults =
                pictures().find(|(experiment, _)| experiment.name == "defaults").map(|(_, measured)| measured);
            for (experiment, measured) in pictures() {
                let mut row = vec![format!("{}-{}.png", experiment.name, results.backend)];
                for (layer, &mean) in measured.layers.iter().enumerate() {
                    row.push(format!("{mean:.5}"));
                    if layer >= 2 {
                        let whole = defaults.map(|measured| measured.layers[layer]).filter(|&whole| whole > 0.0);
                        row.push(whole.map_or("-".to_owned(), |whole| format!("{:.3}", mean / whole)));
                    }
                }
                row.push(seconds(measured.wall));
                table.row(row);
            }
        }
        table.text()
    }

    /// All tables, for a document.
    pub(crate) fn markdown(&self) -> String {
        let mut text = String::new();
        for results in &self.all {
            let _ = writeln!(text, "- {}: {}", results.backend, results.device);
            if results.left_out > 0 {
                let _ = writeln!(text, "  ({} cells left out for want of time: see `--time`)", results.left_out);
            }
        }
        let _ = writeln!(text, "\n### Pictures, mean radiance by layer in W/(m²·sr)\n\n{}", self.pictures());
        let _ = writeln!(text, "### Errors of the paper's formulas\n\n{}", self.biases());
        let _ = writeln!(text, "### Stage by stage\n\n{}", self.by_stage());
        let _ = write!(text, "### The paper's table\n\n{}", self.grid());
        text
    }
}

//! Tables that are readable as text and as Markdown, and the same rows as CSV.

use std::fmt::Write as _;

use photon_core::{Settings, Stage};

use crate::experiment::Experiment;
use crate::studio::Measured;

/// A table of text cells.
#[derive(Debug, Default)]
pub(crate) struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings.
    pub(crate) fn new(headings: &[&str]) -> Self {
        Self { rows: vec![headings.iter().map(|&heading| heading.to_owned()).collect()] }
    }

    pub(crate) fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    /// As Markdown with aligned columns: the first to the left, numbers to the right.
    pub(crate) fn text(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let wide = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0).max(3)
        };
        let widths: Vec<usize> = (0..columns).map(wide).collect();
        let mut text = String::new();
        for (index, row) in self.rows.iter().enumerate() {
            for (column, width) in widths.iter().enumerate() {
                let cell = row.get(column).map_or("", String::as_str);
                let _ = if column == 0 { write!(text, "| {cell:<width$} ") } else { write!(text, "| {cell:>width$} ") };
            }
            text.push_str("|\n");
            if index == 0 {
                for (column, width) in widths.iter().enumerate() {
                    let dashes = "-".repeat(width + 1);
                    let _ = if column == 0 { write!(text, "|{dashes}-") } else { write!(text, "|{dashes}:") };
                }
                text.push_str("|\n");
            }
        }
        text
    }
}

/// Seconds with three digits: `1.23 s`, `45.6 ms`, `789 µs`; a dash for zero.
pub(crate) fn seconds(value: f64) -> String {
    if value <= 0.0 {
        return "-".to_owned();
    }
    let (scaled, unit) = match value {
        v if v >= 1.0 => (v, "s"),
        v if v >= 1e-3 => (v * 1e3, "ms"),
        v => (v * 1e6, "µs"),
    };
    format!("{} {unit}", digits(scaled))
}

/// A ratio with three digits.
pub(crate) fn times(value: f64) -> String {
    format!("{}×", digits(value))
}

fn digits(value: f64) -> String {
    let places = match value {
        v if v >= 99.95 => 0,
        v if v >= 9.995 => 1,
        _ => 2,
    };
    format!("{value:.places$}")
}

/// The header of the CSV file.
pub(crate) fn csv_heading() -> String {
    let stages: Vec<&str> = Stage::ALL.iter().map(|stage| stage.name()).collect();
    format!(
        "backend,device,table,name,caustic_wanted,global_wanted,caustic_stored,global_stored,paths,index,sharing,random,wall_s,stages_s,{},emission_mean,direct_mean,caustic_mean,indirect_mean\n",
        stages.join(",")
    )
}

/// One row of it.
pub(crate) fn csv_row(backend: &str, device: &str, experiment: &Experiment, measured: &Measured) -> String {
    let wanted = |map: Option<crate::experiment::MapParams>| map.map_or(0, |map| map.photons);
    let Settings { index, scheduling, random, .. } = experiment.settings;
    let stages: Vec<String> = Stage::ALL.iter().map(|&stage| format!("{:.9}", measured.stages.get(stage))).collect();
    format!(
        "{backend},\"{}\",{},{},{},{},{},{},{},{index:?},{scheduling:?},{random:?},{:.9},{:.9},{},{}\n",
        device.replace('"', "'"),
        experiment.table,
        experiment.name,
        wanted(experiment.caustic),
        wanted(experiment.global),
        measured.stored[0],
        measured.stored[1],
        measured.paths,
        measured.wall,
        measured.work(),
        stages.join(","),
        measured.layers.map(|mean| format!("{mean:.6}")).join(",")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!([seconds(1.234), seconds(0.0456), seconds(7.89e-4)], ["1.23 s", "45.6 ms", "789 µs"]);
        assert_eq!([times(0.5), times(12.345), times(1234.0)], ["0.50×", "12.3×", "1234×"]);
    }

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(&["a", "long"]);
        table.row(vec!["word".to_owned(), "1".to_owned()]);
        assert_eq!(table.text(), "| a    | long |\n|------|-----:|\n| word |    1 |\n");
    }
}

//! Where f32 loses digits, and from where on that shows: the shipped stages of the CPU beside their twins in f64.
//!
//! `examples/precision.rs` writes the tables and the plot of `docs/studies/precision.md`; a part of it runs in the ordinary
//! tests, with bounds.

pub mod fields;
pub mod shipped;
pub mod stages;
pub mod sweeps;

use std::fmt::Write as _;

/// Figures, by a row's name.
#[derive(Clone, Debug)]
pub struct Table {
    /// What it is about.
    pub title: &'static str,
    /// Of the name, then of each figure.
    pub columns: Vec<&'static str>,
    /// Name and figures.
    pub rows: Vec<(String, Vec<f64>)>,
}

impl Table {
    /// An empty one.
    #[must_use]
    pub fn new(title: &'static str, columns: &[&'static str]) -> Self {
        Self { title, columns: columns.to_vec(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row(&mut self, name: impl Into<String>, figures: &[f64]) {
        assert_eq!(figures.len() + 1, self.columns.len());
        self.rows.push((name.into(), figures.to_vec()));
    }

    /// The figure of that row and column, counted from the first figure.
    #[must_use]
    pub fn at(&self, name: &str, column: usize) -> f64 {
        self.rows.iter().find(|(own, _)| own == name).unwrap().1[column]
    }

    /// The number of the first column of that name, counted from the first figure.
    #[must_use]
    pub fn column(&self, name: &str) -> usize {
        self.columns[1..].iter().position(|own| *own == name).unwrap()
    }

    /// In Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text =
            format!("### {}\n\n| {} |\n|{}\n", self.title, self.columns.join(" | "), "---|".repeat(self.columns.len()));
        for (name, figures) in &self.rows {
            let _ = write!(text, "| {name} |");
            for figure in figures {
                let _ = write!(text, " {} |", shown(*figure));
            }
            text.push('\n');
        }
        text
    }
}

/// Two digits; whole numbers as they are.
fn shown(figure: f64) -> String {
    if figure.is_nan() {
        "–".to_owned()
    } else if figure == figure.trunc() && figure.abs() < 1e6 {
        format!("{figure}")
    } else {
        format!("{figure:.1e}")
    }
}

/// The value that a share of all are below or at; NaN of none.
#[must_use]
pub fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

/// Median, 99 of 100, and worst.
#[must_use]
pub fn spread(mut values: Vec<f64>) -> [f64; 3] {
    [0.5, 0.99, 1.0].map(|share| quantile(&mut values, share))
}

/// How far `found` is from `truth`, relative to it.
#[must_use]
pub fn relative(found: f64, truth: f64) -> f64 {
    if found == truth { 0.0 } else { ((found - truth) / truth).abs() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_known_values() {
        let values: Vec<f64> = (0..=100).rev().map(f64::from).collect();
        assert_eq!(spread(values), [50.0, 99.0, 100.0]);
        assert!(spread(Vec::new())[0].is_nan());
        assert_eq!((relative(1.5, 1.0), relative(0.0, 0.0)), (0.5, 0.0));
    }

    #[test]
    fn tables_are_written_and_read() {
        let mut table = Table::new("Errors", &["stage", "worst", "none"]);
        table.row("hit", &[1.25e-7, f64::NAN]);
        assert_eq!(table.at("hit", table.column("worst")), 1.25e-7);
        assert_eq!(table.markdown(), "### Errors\n\n| stage | worst | none |\n|---|---|---|\n| hit | 1.2e-7 | – |\n");
    }
}

//! Where f32 loses digits, and when that becomes visible: the shipped CPU stages compared with their f64 twins.
//!
//! `examples/precision.rs` writes the tables and the plot of `docs/studies/data/precision.txt`; part of it runs in the
//! ordinary tests, with bounds.

pub mod fields;
pub mod shipped;
pub mod stages;
pub mod sweeps;

use std::fmt::Write as _;

/// A table of numbers with named rows.
#[derive(Clone, Debug)]
pub struct Table {
    /// Its heading.
    pub title: &'static str,
    /// Headings of the name and of each number.
    pub columns: Vec<&'static str>,
    /// Names and numbers.
    pub rows: Vec<(String, Vec<f64>)>,
}

impl Table {
    /// An empty table.
    #[must_use]
    pub fn new(title: &'static str, columns: &[&'static str]) -> Self {
        Self { title, columns: columns.to_vec(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row(&mut self, name: impl Into<String>, figures: &[f64]) {
        assert_eq!(figures.len() + 1, self.columns.len());
        self.rows.push((name.into(), figures.to_vec()));
    }

    /// The number in the given row and column, counted from the first number.
    #[must_use]
    pub fn at(&self, name: &str, column: usize) -> f64 {
        self.rows.iter().find(|(own, _)| own == name).unwrap().1[column]
    }

    /// Index of the first column with this heading, counted from the first number.
    #[must_use]
    pub fn column(&self, name: &str) -> usize {
        self.columns[1..].iter().position(|own| *own == name).unwrap()
    }

    /// Formats the table as Markdown.
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

/// Two significant digits; whole numbers unchanged.
fn shown(figure: f64) -> String {
    if figure.is_nan() {
        "–".to_owned()
    } else if figure == figure.trunc() && figure.abs() < 1e6 {
        format!("{figure}")
    } else {
        format!("{figure:.1e}")
    }
}

/// The quantile of `values` at `share`; NaN if there are none.
#[must_use]
pub fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

/// Median, 99 % quantile, and maximum.
#[must_use]
pub fn spread(mut values: Vec<f64>) -> [f64; 3] {
    [0.5, 0.99, 1.0].map(|share| quantile(&mut values, share))
}

/// The relative error of `found`.
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

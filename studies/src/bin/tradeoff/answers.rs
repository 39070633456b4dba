//! The tables of results for error targets and time budgets.

use std::fmt::Write as _;

use crate::asked::DEFAULT_WAY;
use crate::records::{AskedRow, Body, Part};
use crate::tables::{backends, head, percent};

/// All tables, backends side by side: by scene, then in the order of the targets.
fn rows(parts: &[Part]) -> Vec<(&str, &AskedRow)> {
    let mut rows: Vec<(&str, &AskedRow)> = Vec::new();
    for part in parts {
        if let Body::Asked(asked) = &part.body {
            rows.extend(asked.iter().map(|row| (part.backend.as_str(), row)));
        }
    }
    let order = |row: &AskedRow| {
        let same = rows.iter().filter(|(_, other)| other.scene == row.scene);
        same.map(|(_, other)| (&other.asked, &other.way)).position(|asked| asked == (&row.asked, &row.way))
    };
    let mut sorted = rows.clone();
    sorted.sort_by(|(a, x), (b, y)| x.scene.cmp(&y.scene).then(order(x).cmp(&order(y))).then(a.cmp(b)));
    sorted
}

/// Predictions and results; times as `render --time` uses them.
pub(crate) fn asked(parts: &[Part]) -> String {
    let mut text = String::from(
        "\n### Error and time budgets\n\nAn error target for 95 % of the pixels that have an interval, within 20 s; or a time budget, as `--time --errors` spends it.\n*Reached* is the estimated error. *Covered* is left out where the reference has fewer than 27 times the photons of\nthe run, at which its error is a third of the run's.\n",
    );
    let columns = ["scene", "asked", "backend", "predicted", "took", "reached", "claimed", "covered", "relMSE"];
    text += &head(&columns.map(str::to_owned), 5);
    let rows = rows(parts);
    let shown = rows.iter().filter(|(_, row)| row.way.as_deref().is_none_or(|way| way == DEFAULT_WAY));
    let mut any = false;
    for (backend, row) in shown {
        any = true;
        let reached = row.reached.map_or_else(|| "–".to_owned(), percent);
        let covered = row.covered.map_or_else(|| "–".to_owned(), percent);
        let error = row.error.map_or_else(|| "–".to_owned(), |error| format!("{error:.2e}"));
        let _ = writeln!(
            text,
            "| {} | {} | {backend} | {} | {} | {reached} | {:.0} % | {covered} | {error} |",
            row.scene,
            row.asked,
            row.predicted,
            row.took,
            100.0 * row.claimed
        );
    }
    if any { text } else { String::new() }
}

/// Results of a time budget for each way to use it.
pub(crate) fn ways(parts: &[Part]) -> String {
    let rows = rows(parts);
    let mut names: Vec<&str> = Vec::new();
    for name in rows.iter().filter_map(|(_, row)| row.way.as_deref()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    if names.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\n### Ways to spend a time\n\nrelMSE of one run each, for pictures of 48 × 48 pixels with 20000 paths per pass. Adapted radii are chosen once, after a pilot with\nerror estimates; radii per pixel are updated again whenever the number of passes has doubled.\n",
    );
    let mut columns = vec!["scene".to_owned(), "time".to_owned(), "backend".to_owned()];
    columns.extend(names.iter().map(|&name| name.to_owned()));
    text += &head(&columns, 3);
    let mut seen: Vec<(&str, &str)> = Vec::new();
    for (_, row) in &rows {
        if row.way.is_none() || seen.contains(&(&row.scene, &row.asked)) {
            continue;
        }
        seen.push((&row.scene, &row.asked));
        for backend in backends(parts) {
            let cells: Vec<String> = names
                .iter()
                .map(|name| {
                    let same = |(of, other): &&(&str, &AskedRow)| {
                        *of == backend
                            && (&other.scene, &other.asked, other.way.as_deref())
                                == (&row.scene, &row.asked, Some(*name))
                    };
                    let error = rows.iter().find(same).and_then(|(_, other)| other.error);
                    error.map_or_else(|| "–".to_owned(), |error| format!("{error:.2e}"))
                })
                .collect();
            let _ = writeln!(text, "| {} | {} | {backend} | {} |", row.scene, row.asked, cells.join(" | "));
        }
    }
    text
}

//! The tables of the document, with backends side by side.

use std::fmt::Write as _;

use crate::measure::{pareto, slope};
use crate::records::{Body, Claims, Note, Part, Row, Summary, Sweep};

/// Sweeps, with the result files that they are from.
pub(crate) fn sweeps(parts: &[Part]) -> Vec<(&Part, &Sweep)> {
    fn of(part: &Part) -> Option<(&Part, &Sweep)> {
        if let Body::Sweep(sweep) = &part.body { Some((part, sweep)) } else { None }
    }
    parts.iter().filter_map(of).collect()
}

/// Names of the backends, in order.
pub(crate) fn backends(parts: &[Part]) -> Vec<&str> {
    let ours = parts.iter().filter(|part| !matches!(part.body, Body::Tracer(_)));
    let mut names: Vec<&str> = ours.map(|part| part.backend.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Names of the scenes, in order.
pub(crate) fn scenes(parts: &[Part]) -> Vec<&str> {
    let mut names: Vec<&str> = sweeps(parts).iter().map(|(_, sweep)| sweep.scene.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// A header and delimiter row: text to the left, numbers to the right.
pub(crate) fn head(columns: &[String], texts: usize) -> String {
    let line: Vec<&str> = (0..columns.len()).map(|i| if i < texts { "---" } else { "---:" }).collect();
    format!("\n| {} |\n|{}|\n", columns.join(" | "), line.join("|"))
}

/// The first columns, then these for each backend.
fn columns(parts: &[Part], first: &[&str], each: &[&str]) -> Vec<String> {
    let mut all: Vec<String> = first.iter().map(|&name| name.to_owned()).collect();
    for backend in backends(parts) {
        all.extend(each.iter().map(|name| format!("{name}, {backend}")));
    }
    all
}

/// Rows of all backends with the same key, in the order of the first backend that has them.
fn together<'a, R>(
    parts: &'a [Part],
    rows: impl Fn(&'a Part) -> &'a [R],
    key: impl Fn(&R) -> String,
) -> Vec<(String, Vec<Option<&'a R>>)> {
    let names = backends(parts);
    let mut all: Vec<(String, Vec<Option<&'a R>>)> = Vec::new();
    for part in parts {
        let place = names.iter().position(|name| *name == part.backend).unwrap_or(0);
        for row in rows(part) {
            let key = key(row);
            let at = all.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
                all.push((key, vec![None; names.len()]));
                all.len() - 1
            });
            all[at].1[place] = Some(row);
        }
    }
    all
}

fn lines<'a, R>(rows: &[(String, Vec<Option<&'a R>>)], cell: impl Fn(&'a R) -> String, empty: &str) -> String {
    let mut text = String::new();
    for (key, found) in rows {
        let cells: Vec<String> = found.iter().map(|row| row.map_or_else(|| empty.to_owned(), &cell)).collect();
        let _ = writeln!(text, "| {key} | {} |", cells.join(" | "));
    }
    text
}

pub(crate) fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

fn claim_cells(claims: &Claims) -> String {
    if claims.claimed > 0.0 {
        format!("{} | {} | {:.2}", percent(claims.claimed), percent(claims.covered), claims.sharpness)
    } else {
        "0.0 % | – | –".to_owned()
    }
}

/// Coverage in fields with a known result.
pub(crate) fn fields(parts: &[Part]) -> String {
    fn rows(part: &Part) -> &[crate::records::FieldRow] {
        if let Body::Fields(rows) = &part.body { rows } else { &[] }
    }
    let found = together(parts, rows, |row| {
        format!("{} | {} | {:.2} | {}", row.field, row.passes, row.alpha, percent(row.claims.by_noise))
    });
    let Some(row) = parts.iter().flat_map(rows).next() else { return String::new() };
    let all: Vec<_> = parts.iter().flat_map(rows).collect();
    let smooth = all.iter().filter(|row| !row.broken);
    let least = smooth.clone().map(|row| row.claims.covered).fold(1.0, f64::min);
    let widest = smooth.map(|row| row.claims.sharpness).fold(0.0, f64::max);
    let most = all.iter().filter(|row| row.broken).map(|row| row.claims.claimed).fold(0.0, f64::max);
    let mut text = format!(
        "\n### Intervals in fields with a known answer\n\n{} seeds per row with {} independent pixels each, and 20 expected photons within the first radius, which is the unit of distances.\n*By noise* is the fraction of pixels that an interval from noise alone would cover. In smooth fields and at\nstraight edges {} of the intervals or more hold, and none is wider than {widest:.2} root mean square errors; at folds, at\ncorners and on the dark side of edges at most {} of the pixels have an interval.\n",
        row.films,
        row.pixels,
        percent(least),
        percent(most)
    );
    text += &head(&columns(parts, &["field", "passes", "α", "by noise"], &["claimed", "covered", "claim / error"]), 1);
    text + &lines(&found, |row| claim_cells(&row.claims), "– | – | –")
}

/// Convergence rates.
pub(crate) fn rates(parts: &[Part]) -> String {
    fn rows(part: &Part) -> &[crate::records::RateRow] {
        if let Body::Rates(rows) = &part.body { rows } else { &[] }
    }
    let found = together(parts, rows, |row| {
        format!("{} | {:.2} | {} | {} to {} | {:.3}", row.field, row.alpha, row.of, row.from, row.to, row.theory)
    });
    if found.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\n### Convergence rates in fields with a known answer\n\nFitted slopes over passes in logarithms, with jackknife errors over pixels; *theory* is the slope over the same passes.\nWith constant radii (α = 1) the bias is constant.\n",
    );
    text += &head(&columns(parts, &["field", "α", "of", "passes", "theory"], &["slope"]), 3);
    text + &lines(&found, |row| format!("{:.3} ± {:.3}", row.slope, row.error), "–")
}

/// Coverage in scenes: with many seeds where the result is known, else against references.
pub(crate) fn claims(parts: &[Part]) -> String {
    fn rows(part: &Part) -> &[crate::records::ClaimRow] {
        if let Body::Claims(rows) = &part.body { rows } else { &[] }
    }
    let each = ["claimed", "covered", "worst run", "claim / error"];
    let cells = |claims: &Claims| {
        if claims.claimed > 0.0 {
            format!(
                "{} | {} | {} | {:.2}",
                percent(claims.claimed),
                percent(claims.covered),
                percent(claims.worst),
                claims.sharpness
            )
        } else {
            "0.0 % | – | – | –".to_owned()
        }
    };
    let mut text = String::from("\n### Intervals in scenes\n");
    let found = together(parts, rows, |row| format!("{} | {} | {}", row.scene, row.passes, row.seeds));
    if !found.is_empty() {
        text += "\nAgainst closed forms:\n";
        text += &head(&columns(parts, &["scene", "passes", "seeds"], &each), 1);
        text += &lines(&found, |row| cells(&row.claims), "– | – | – | –");
    }
    let names = backends(parts);
    let mut details: Vec<(String, Vec<Option<&Claims>>)> = Vec::new();
    for (part, sweep) in sweeps(parts) {
        if matches!(sweep.truth, Note::Constant(_)) {
            continue;
        }
        for row in sweep.rows.iter().filter(|row| row.knob == "errors") {
            let Some(claims) = &row.summary.claims else { continue };
            let key = format!("{} | {} | {}", sweep.scene, row.passes, sweep.seeds);
            let at = details.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
                details.push((key, vec![None; names.len()]));
                details.len() - 1
            });
            details[at].1[names.iter().position(|name| *name == part.backend).unwrap_or(0)] = Some(claims);
        }
    }
    if !details.is_empty() {
        text += "\nAgainst references:\n";
        text += &head(&columns(parts, &["scene", "passes", "seeds"], &each), 1);
        text += &lines(&details, cells, "– | – | – | –");
    }
    text
}

/// Slopes of errors over photons, and the Pareto fronts.
pub(crate) fn fronts(parts: &[Part]) -> String {
    let mut text = String::from(
        "\n### Error over photons\n\nSlopes in logarithms from 1 to 64 passes; the asymptotic value of all three is −0.67.\n",
    );
    text += &head(&["scene", "backend", "error", "bias²", "variance"].map(str::to_owned), 2);
    for (part, sweep) in sweeps(parts) {
        let rows: Vec<&Row> = sweep.rows.iter().filter(|row| row.knob == "passes").collect();
        let fit = |of: &dyn Fn(&Summary) -> f64| {
            let points = rows.iter().map(|row| (row.summary.photons as f64, of(&row.summary)));
            let points: Vec<(f64, f64)> = points.filter(|p| p.1 > 0.0).collect();
            if points.len() < 3 {
                return "–".to_owned();
            }
            let (slope, error) = slope(&points);
            format!("{slope:.2} ± {error:.2}")
        };
        let (error, bias, variance) = (fit(&|s| s.error), fit(&|s| s.bias), fit(&|s| s.variance));
        let _ = writeln!(text, "| {} | {} | {error} | {bias} | {variance} |", sweep.scene, part.backend);
    }
    text += "\n### Pareto front\n\nSettings that no other setting beats in both time and error, from the fastest.\n";
    text += &head(&["scene", "backend", "setting", "passes", "time", "relMSE"].map(str::to_owned), 3);
    for (part, sweep) in sweeps(parts) {
        let places: Vec<(f64, f64)> = sweep.rows.iter().map(|row| (row.summary.seconds, row.summary.error)).collect();
        for i in pareto(&places) {
            let row = &sweep.rows[i];
            let _ = writeln!(
                text,
                "| {} | {} | {} {} | {} | {} | {:.2e} |",
                sweep.scene,
                part.backend,
                row.knob,
                row.value,
                row.passes,
                time(row.summary.seconds),
                row.summary.error
            );
        }
    }
    text
}

pub(crate) fn time(seconds: f64) -> String {
    if seconds < 0.1 { format!("{:.1} ms", 1000.0 * seconds) } else { format!("{seconds:.2} s") }
}

/// The baseline setting of a sweep.
fn middle(sweep: &Sweep) -> Option<&Row> {
    sweep.rows.iter().find(|row| row.knob == "passes" && row.passes == crate::sweep::PASSES)
}

/// Error of each setting relative to that of the baseline in the same time.
pub(crate) fn merits(parts: &[Part]) -> String {
    let (names, scenes) = (backends(parts), scenes(parts));
    if scenes.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\n### Cost and gain of each setting\n\n*Time* is relative to the baseline. *Error* is relMSE relative to what the baseline would reach in the same time, if errors fall as the\npower −2/3 of time: below 1 a setting pays. Geometric means over all scenes, and each scene on the first backend.\n",
    );
    let mut columns = columns(parts, &["knob", "value"], &["time", "error"]);
    columns.extend(scenes.iter().map(|&scene| scene.to_owned()));
    text += &head(&columns, 2);
    let all = sweeps(parts);
    // Time and error of a row of one backend and scene, relative to those of the baseline.
    let ratio = |backend: &str, scene: &str, row: &Row| -> Option<(f64, f64)> {
        let (_, sweep) = all.iter().find(|(part, sweep)| part.backend == backend && sweep.scene == scene)?;
        let (middle, row) = (
            middle(sweep)?,
            sweep.rows.iter().find(|r| (&r.knob, &r.value, r.passes) == (&row.knob, &row.value, row.passes))?,
        );
        let time = row.summary.seconds / middle.summary.seconds;
        Some((time, row.summary.error / middle.summary.error * time.powf(2.0 / 3.0)))
    };
    let Some((_, first)) = all.first() else { return text };
    for row in &first.rows {
        let mut cells = Vec::new();
        for &backend in &names {
            let found: Vec<(f64, f64)> = scenes.iter().filter_map(|&scene| ratio(backend, scene, row)).collect();
            let mean = |of: &dyn Fn(&(f64, f64)) -> f64| {
                (found.iter().map(|pair| of(pair).ln()).sum::<f64>() / found.len().max(1) as f64).exp()
            };
            cells.push(if found.is_empty() {
                "– | –".to_owned()
            } else {
                format!("×{:.2} | ×{:.2}", mean(&|p| p.0), mean(&|p| p.1))
            });
        }
        for &scene in &scenes {
            let found = names.first().and_then(|backend| ratio(backend, scene, row));
            cells.push(found.map_or_else(|| "–".to_owned(), |(_, error)| format!("×{error:.2}")));
        }
        let _ = writeln!(text, "| {} | {} | {} |", row.knob, row.value, cells.join(" | "));
    }
    text
}

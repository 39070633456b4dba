//! Writes `docs/studies/extremes.csv` and `extremes-long.csv` from a run on every backend.

use std::fmt::Write as _;
use std::fs;

use crate::shell;

const QUICK: &str = "docs/studies/extremes.csv";
const LONG: &str = "docs/studies/extremes-long.csv";

const RUN: [&str; 7] = ["cargo", "run", "--quiet", "--locked", "-p", "studies", "--bin"];

/// The quick run, a minute or two.
pub(crate) fn quick() -> Result<(), String> {
    write(QUICK, &[])
}

/// The long run, most of an hour.
pub(crate) fn long() -> Result<(), String> {
    write(LONG, &["--long"])
}

/// The rows of a long run on another machine, for example one with a GPU: reads what the program printed there.
pub(crate) fn elsewhere() -> Result<(), String> {
    let from = "out/extremes-long.md";
    let text = fs::read_to_string(shell::root().join(from)).map_err(|error| format!("{from}: {error}"))?;
    let bad = put(LONG, &text)?;
    if bad == 0 { Ok(()) } else { Err(format!("{from} has {bad} rows that fail")) }
}

fn write(file: &str, extent: &[&str]) -> Result<(), String> {
    let (text, all) = shell::capture_all(&[&RUN, ["extremes", "--"].as_slice(), extent].concat())?;
    put(file, &text)?;
    if all { Ok(()) } else { Err(format!("{file} is written, and has rows that fail")) }
}

/// Writes the rows of a report, and returns the number of failed ones.
fn put(file: &str, report: &str) -> Result<usize, String> {
    let rows = rows(report)?;
    fs::write(shell::root().join(file), csv(&rows)).map_err(|error| format!("{file}: {error}"))?;
    Ok(rows.iter().filter(|row| row[8] == "FAILS").count())
}

/// Backend, device, group, seconds of the group, case, quantity, range, result, verdict.
type Row = [String; 9];

/// The rows of the Markdown that the program prints.
fn rows(report: &str) -> Result<Vec<Row>, String> {
    let mut rows = Vec::new();
    let (mut backend, mut device, mut group, mut seconds) = ("", "", "", "");
    for line in report.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            (backend, device) = title.split_once(": ").unwrap_or((title, ""));
        } else if let Some(title) = line.strip_prefix("### ") {
            group = title;
        } else if let Some(time) = line.strip_suffix(" s").filter(|time| time.parse::<f64>().is_ok()) {
            seconds = time;
        } else if line.starts_with("| ") && !line.starts_with("| case |") {
            // `\\|` is a literal bar within a cell.
            let hidden = line.replace("\\|", "\0");
            let cells: Vec<String> = hidden
                .trim_matches('|')
                .split('|')
                .map(|cell| cell.replace('\0', "|").trim().trim_matches('*').to_owned())
                .collect();
            let [case, what, range, found, verdict] = <[String; 5]>::try_from(cells)
                .map_err(|cells| format!("a row of {} cells instead of 5: {line}", cells.len()))?;
            let place = [backend, device, group, seconds].map(str::to_owned);
            let [backend, device, group, seconds] = place;
            rows.push([backend, device, group, seconds, case, what, range, found, verdict]);
        }
    }
    if rows.is_empty() { Err("the report has no rows".to_owned()) } else { Ok(rows) }
}

/// Formats rows by RFC 4180: cells with a comma or a quote are quoted.
fn csv(rows: &[Row]) -> String {
    let mut text = "backend,device,group,seconds,case,what,range,found,verdict\n".to_owned();
    for row in rows {
        let cells = row.each_ref().map(|cell| {
            if cell.contains([',', '"']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }
        });
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPORT: &str = "## CPU: 2 threads, x86_64\n\n### Points\n\n5 s\n\n| case | what | range | found | |\n\
                          |---|---|---|---|---|\n| S1 | paths, lost | 10 | \\|z\\| < 4.5 | holds |\n\
                          | S2 | a \"b\" | 1 | 0 | **FAILS** |\n";

    #[test]
    fn a_report_becomes_rows() {
        let text = csv(&rows(REPORT).unwrap());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[1], r#"CPU,"2 threads, x86_64",Points,5,S1,"paths, lost",10,|z| < 4.5,holds"#);
        assert_eq!(lines[2], r#"CPU,"2 threads, x86_64",Points,5,S2,"a ""b""",1,0,FAILS"#);
        assert_eq!(lines.len(), 3);
    }

    #[test]
    fn a_report_without_rows_and_a_short_row_are_refused() {
        assert!(rows("## CPU: one\n").is_err());
        assert!(rows("| S1 | what | holds |\n").unwrap_err().contains("3 cells"));
    }
}

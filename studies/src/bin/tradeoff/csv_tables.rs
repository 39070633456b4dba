//! Moves long tables from the document to CSV files beside it.

use std::fmt::Write as _;

/// Tables with more rows than this become CSV files.
const MAX_ROWS: usize = 20;

/// A document without its long tables.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Separated {
    /// The Markdown, with a link in place of each long table.
    pub(crate) text: String,
    /// Name and content of each CSV file.
    pub(crate) files: Vec<(String, String)>,
}

/// Moves each table of more than [`MAX_ROWS`] rows to `NAME-HEADING.csv`, named after the heading above it.
pub(crate) fn separate(markdown: &str, name: &str) -> Separated {
    let mut out = Separated::default();
    let mut heading = String::new();
    let mut lines = markdown.lines().peekable();
    while let Some(line) = lines.next() {
        if line.starts_with('#') {
            heading = slug(line);
        }
        if !line.starts_with('|') {
            out.text += line;
            out.text.push('\n');
            continue;
        }
        let mut table = vec![line];
        while let Some(next) = lines.next_if(|next| next.starts_with('|')) {
            table.push(next);
        }
        // The header and the delimiter row below it do not count.
        let rows = table.len().saturating_sub(2);
        if rows <= MAX_ROWS {
            table.iter().for_each(|line| out.text += &format!("{line}\n"));
            continue;
        }
        let file = format!("{name}-{heading}.csv");
        let _ = writeln!(out.text, "{rows} rows in [{file}]({file}).");
        out.files.push((file, csv(&table)));
    }
    out
}

/// The lines of a Markdown table as CSV; the delimiter row is dropped.
pub(crate) fn csv(table: &[&str]) -> String {
    let mut text = String::new();
    for (number, line) in table.iter().enumerate() {
        if number != 1 {
            let inner = line.trim().trim_start_matches('|').trim_end_matches('|');
            let cells: Vec<String> = inner.split('|').map(|cell| quoted(cell.trim())).collect();
            let _ = writeln!(text, "{}", cells.join(","));
        }
    }
    text
}

/// One cell, in quotes where RFC 4180 requires them.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_owned() }
}

fn slug(heading: &str) -> String {
    let words = heading.trim_start_matches('#').trim().to_lowercase();
    words.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: usize) -> String {
        let mut text = "# One\n\n## Two words\n\n| a, b | c |\n|---|---:|\n".to_owned();
        (0..rows).for_each(|row| text += &format!("| {row} | x \"y\" |\n"));
        text + "\nAfter.\n"
    }

    #[test]
    fn short_tables_stay() {
        let text = table(MAX_ROWS);
        assert_eq!(separate(&text, "n"), Separated { text, files: Vec::new() });
    }

    #[test]
    fn long_tables_become_files_with_every_row() {
        let found = separate(&table(MAX_ROWS + 1), "n");
        assert_eq!(found.text, "# One\n\n## Two words\n\n21 rows in [n-two-words.csv](n-two-words.csv).\n\nAfter.\n");
        let [(name, csv)] = &found.files[..] else { panic!("{found:?}") };
        assert_eq!(name, "n-two-words.csv");
        assert_eq!(csv.lines().count(), MAX_ROWS + 2);
        assert!(csv.starts_with("\"a, b\",c\n0,\"x \"\"y\"\"\"\n"), "{csv}");
    }
}

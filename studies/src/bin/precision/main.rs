//! Writes `docs/studies/data/precision.txt` and the plot of its tables. Run it in release mode: it takes some minutes.
#![expect(clippy::print_stderr, reason = "progress goes to stderr")]

mod plot;

use std::path::Path;
use std::time::Instant;

use photon_tests::precision::{Table, fields, stages, sweeps};
use plot::{Line, Panel};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("no workspace")?;
    let mut tables = Vec::new();
    let mut add = |table: &dyn Fn() -> Table| {
        let start = Instant::now();
        let table = table();
        eprintln!("{}: {:.1} s", table.title, start.elapsed().as_secs_f64());
        tables.push(table);
    };
    add(&|| stages::all(100_000));
    add(&|| sweeps::detail(&[1.0, 10.0, 100.0, 1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6, 1e7], 50_000));
    add(&|| sweeps::places(0..=9, 20_000));
    add(&|| sweeps::path(&[1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48], 50_000));
    add(&|| fields::radius(1..=7, 200));
    add(&|| fields::photons(1..=6, 30));
    add(&|| stages::grazing(20_000));
    add(&|| stages::near_one());
    add(&|| stages::pole(&[0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4]));

    let body: Vec<String> = tables.iter().map(Table::markdown).collect();
    std::fs::write(root.join("docs/studies/data/precision.txt"), body.join("\n"))?;
    std::fs::write(root.join("docs/images/precision.svg"), picture(&tables))?;
    Ok(())
}

/// Error over level of detail, and over path length.
fn picture(tables: &[Table]) -> String {
    let lines = |table: usize, names: &[(&'static str, &'static str)]| -> Vec<Line> {
        let table = &tables[table];
        let points = |column: usize| {
            let x = |name: &str| name.parse().unwrap_or(f64::NAN);
            table.rows.iter().map(|(name, figures)| (x(name), figures[column].abs())).collect()
        };
        names.iter().map(|&(column, name)| Line { name, points: points(table.column(column)) }).collect()
    };
    let detail = Panel {
        title: "a room in the corner of a scene",
        x: "scene / room",
        lines: lines(
            1,
            &[
                ("first landing is off by, rooms, median", "first landing off by, rooms, median"),
                ("at the fourth", "paths diverged at the fourth landing"),
                ("flux onto the floor, relative", "flux onto the floor, relative"),
                ("± standard error", "its standard error"),
                ("paths out of the closed room", "paths out of the closed room"),
            ],
        ),
    };
    let path = Panel {
        title: "along a path",
        x: "landing",
        lines: lines(
            3,
            &[
                ("paths diverged there or before", "paths diverged"),
                ("off by, rooms, median", "off by, rooms, median"),
                ("power, relative, 99 of 100", "power, relative, 99 of 100"),
            ],
        ),
    };
    plot::picture(&[detail, path])
}

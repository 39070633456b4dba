//! The contact sheet and the table.

use std::fmt::Write as _;
use std::path::Path;

use photon_scene::EnvironmentDesc;
use photonmap_cli::fault::Fault;
use photonmap_cli::{atomic_write, png_file};

/// Pictures in a row of the contact sheet.
const COLUMNS: usize = 4;

/// What is known about a model.
#[derive(Debug, Default)]
pub(crate) struct Row {
    /// Path within the folder.
    pub(crate) name: String,
    /// Lines of the loader, and warnings.
    pub(crate) report: Vec<String>,
    pub(crate) triangles: usize,
    pub(crate) seconds_load: f64,
    pub(crate) seconds_render: f64,
    /// Name of the picture's file.
    pub(crate) picture: String,
    /// Its pixels, sRGB of 8 bits; empty if there was an error.
    pub(crate) bytes: Vec<u8>,
    /// Why there is no picture.
    pub(crate) error: Option<String>,
}

/// Writes `sheet.png`, with the pictures in the order of the rows, and `README.md`.
pub(crate) fn write(out: &Path, size: u32, environment: Option<&EnvironmentDesc>, rows: &[Row]) -> Result<(), Fault> {
    let light =
        environment.map_or("the lights of the files".to_owned(), |desc| format!("{desc}, and the lights of the files"));
    let mut text = format!(
        "# Gallery\n\nLight: {light}. The exposure of each picture is its own.\n\n![All models](sheet.png)\n\n"
    );
    text += "| model | triangles | loaded, s | rendered, s | report |\n|---|---:|---:|---:|---|\n";
    for row in rows {
        let report = match &row.error {
            Some(error) => format!("**{error}**"),
            None if row.report.is_empty() => "exact".to_owned(),
            None => row.report.join("<br>"),
        };
        let report = report.replace('|', "\\|").replace('\n', " ");
        let name = if row.error.is_some() { row.name.clone() } else { format!("[{}]({})", row.name, row.picture) };
        let (load, render) = (row.seconds_load, row.seconds_render);
        let _ = writeln!(text, "| {name} | {} | {load:.2} | {render:.1} | {report} |", row.triangles);
    }
    atomic_write::write_bytes(&out.join("README.md"), text.as_bytes())?;
    let pictures: Vec<&[u8]> = rows.iter().filter(|row| row.error.is_none()).map(|row| row.bytes.as_slice()).collect();
    if pictures.is_empty() {
        return Ok(());
    }
    let (width, height, bytes) = sheet(size as usize, &pictures);
    png_file::write_bytes(&out.join("sheet.png"), width as u32, height as u32, &bytes)
}

/// Square pictures side by side on white, with a gap between them: width, height and pixels.
fn sheet(size: usize, pictures: &[&[u8]]) -> (usize, usize, Vec<u8>) {
    let cell = size + size.div_ceil(64);
    let columns = COLUMNS.min(pictures.len());
    let (width, height) = (columns * cell, pictures.len().div_ceil(columns) * cell);
    let mut bytes = vec![255; 3 * width * height];
    for (index, picture) in pictures.iter().enumerate() {
        let (left, top) = (index % columns * cell, index / columns * cell);
        for (y, line) in picture.chunks_exact(3 * size).enumerate() {
            let start = 3 * ((top + y) * width + left);
            bytes[start..start + line.len()].copy_from_slice(line);
        }
    }
    (width, height, bytes)
}

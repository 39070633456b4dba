//! Data and display windows: texels are where the file says, not stretched over the picture.

use std::ops::Range;

use exr::math::Vec2;

use super::ImageError;

/// A rectangle of texels in the coordinates of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) at: Vec2<i32>,
    pub(super) size: Vec2<usize>,
}

impl Window {
    fn columns(&self) -> Range<i64> {
        i64::from(self.at.x())..i64::from(self.at.x()) + self.size.width() as i64
    }

    fn rows(&self) -> Range<i64> {
        i64::from(self.at.y())..i64::from(self.at.y()) + self.size.height() as i64
    }

    fn text(&self) -> String {
        format!("{} × {} texels at ({}, {})", self.size.width(), self.size.height(), self.at.x(), self.at.y())
    }
}

/// The texels of a display window, and what is missing or left out.
pub(super) struct Placed {
    pub(super) texels: Vec<[f32; 4]>,
    pub(super) remarks: Vec<String>,
}

/// Places the texels of the data window within the display window: black with this alpha where there are none, and cut
/// off beyond it.
pub(super) fn place(texels: Vec<[f32; 4]>, data: Window, shown: Window, alpha: f32) -> Result<Placed, ImageError> {
    if data == shown {
        return Ok(Placed { texels, remarks: Vec::new() });
    }
    let within = |a: Range<i64>, b: Range<i64>| a.start.max(b.start)..a.end.min(b.end);
    let columns = within(data.columns(), shown.columns());
    let rows = within(data.rows(), shown.rows());
    let windows = || format!("its data window of {} and its display window of {}", data.text(), shown.text());
    if columns.is_empty() || rows.is_empty() {
        return Err(ImageError::new(format!("has nothing to show: {} do not overlap", windows())));
    }
    let width = (columns.end - columns.start) as usize;
    let mut placed = vec![[0.0, 0.0, 0.0, alpha]; shown.size.area()];
    for row in rows.clone() {
        let start = |of: &Window| {
            (row - of.rows().start) as usize * of.size.width() + (columns.start - of.columns().start) as usize
        };
        let (from, to) = (start(&data), start(&shown));
        placed[to..to + width].copy_from_slice(&texels[from..from + width]);
    }
    let mut remarks = Vec::new();
    if columns != shown.columns() || rows != shown.rows() {
        remarks.push(format!("is black where it has no texels: {} differ", windows()));
    }
    if columns != data.columns() || rows != data.rows() {
        remarks.push(format!("is cut where its texels lie outside of the picture: {} differ", windows()));
    }
    Ok(Placed { texels: placed, remarks })
}

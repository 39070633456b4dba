//! Counts features of an OBJ file that are not rendered as given.

use crate::load::polygon::crossing;
use crate::load::white::White;
use crate::report::LoadReport;
use std::collections::BTreeMap;

/// Keywords that are listed one by one.
const MOST_KEYWORDS: usize = 20;

/// How many there are, and the line of the first.
#[derive(Clone, Copy, Default)]
pub(super) struct Count {
    count: usize,
    first: usize,
}

impl Count {
    pub(super) fn add(&mut self, line: usize) {
        if self.count == 0 {
            self.first = line;
        }
        self.count += 1;
    }
}

/// The counts.
#[derive(Default)]
pub(super) struct Census {
    /// Polygons that cross themselves.
    pub(super) crossing: Count,
    /// Faces with fewer than three corners.
    pub(super) small: Count,
    /// Normals that are not finite.
    pub(super) normals: Count,
    /// Texture coordinates, likewise.
    pub(super) uvs: Count,
    /// Corners of faces with a normal that does not exist.
    pub(super) lost_normals: Count,
    /// Those with texture coordinates that do not exist.
    pub(super) lost_uvs: Count,
    /// Vertices with numbers that are neither a colour nor a weight of 1.
    pub(super) others: Count,
    pub(super) white: Option<White>,
    ignored: BTreeMap<String, Count>,
    /// Statements with further keywords.
    rest: Count,
}

impl Census {
    /// Counts a statement that is not read.
    pub(super) fn ignore(&mut self, keyword: &str, line: usize) {
        if let Some(count) = self.ignored.get_mut(keyword) {
            count.add(line);
        } else if self.ignored.len() < MOST_KEYWORDS {
            self.ignored.entry(keyword.to_owned()).or_default().add(line);
        } else {
            self.rest.add(line);
        }
    }

    /// Adds the counts to the report.
    pub(super) fn report(&self, report: &mut LoadReport) {
        let file = "the file";
        let Count { count, first } = self.crossing;
        if count > 0 {
            report.approximated(file, crossing(count, &format!("in line {first}")));
        }
        for (Count { count, first }, what, result) in [
            (self.normals, "normals (vn) are not three finite numbers", "triangles have their own normal there"),
            (
                self.lost_normals,
                "corners of faces refer to normals that do not exist",
                "they have that of their triangle",
            ),
            (self.uvs, "texture coordinates (vt) are not finite numbers", "0 is taken"),
            (self.lost_uvs, "corners of faces refer to texture coordinates that do not exist", "they have none"),
            (self.others, "vertices have numbers that are no colour (v x y z r g b)", "they are left out"),
        ] {
            if count > 0 {
                report.approximated(file, format!("{count} {what}, the first in line {first}; {result}"));
            }
        }
        let Count { count, first } = self.small;
        if count > 0 {
            report.left_out(file, format!("{count} faces of fewer than three corners, the first in line {first}"));
        }
        if let Some(white) = self.white {
            white.report(file, report);
        }
        let unread = "which are not geometry that is read";
        for (keyword, Count { count, first }) in &self.ignored {
            let text = format!("{count} statements '{keyword}', {unread}; the first in line {first}");
            report.left_out(file, text);
        }
        let Count { count, first } = self.rest;
        if count > 0 {
            report.left_out(file, format!("{count} statements of other kinds, {unread}; the first in line {first}"));
        }
    }
}

//! Counts features of an OBJ file that are not rendered as given.

use crate::load::polygon::{concave, fan_covers};
use crate::report::LoadReport;
use glam::DVec3;
use std::collections::BTreeMap;

/// The counts.
#[derive(Default)]
pub(super) struct Census {
    pub(super) colored: usize,
    smoothed: usize,
    concave: Vec<usize>,
    pub(super) ignored: BTreeMap<String, usize>,
}

impl Census {
    /// Counts a polygon that a fan does not cover, and one with normals that simulate curvature.
    pub(super) fn polygon(&mut self, corners: &[u32], positions: &[[f64; 3]], normals: &[DVec3], line: usize) {
        let places: Option<Vec<DVec3>> =
            corners.iter().map(|&index| positions.get(index as usize).map(|&at| DVec3::from_array(at))).collect();
        let Some(places) = places else { return };
        if !fan_covers(&places) {
            self.concave.push(line);
        }
        let fan = |next: usize| (places[next] - places[0]).cross(places[next + 1] - places[0]);
        let whole: DVec3 = (1..places.len() - 1).map(fan).sum();
        let face_normal = whole.normalize_or_zero();
        // Smaller differences, up to some 2.5 degrees, are rounding errors of normals in files.
        self.smoothed += usize::from(normals.iter().any(|normal| normal.dot(face_normal).abs() < 0.999));
    }

    /// Adds the counts to the report.
    pub(super) fn report(&self, report: &mut LoadReport) {
        if self.smoothed > 0 {
            report.approximated(
                "the file",
                format!(
                    "{} polygons are smoothed by vertex normals and rendered flat; use finer meshes if that is visible",
                    self.smoothed
                ),
            );
        }
        if let Some(line) = self.concave.first() {
            report.approximated("the file", concave(self.concave.len(), &format!("in line {line}")));
        }
        if self.colored > 0 {
            report.left_out(
                "the file",
                format!("the colours of {} vertices; give an albedo in an override file", self.colored),
            );
        }
        for (keyword, count) in &self.ignored {
            report.left_out("the file", format!("{count} statements '{keyword}', which are not geometry that is read"));
        }
    }
}

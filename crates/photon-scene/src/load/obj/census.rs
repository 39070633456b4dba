//! What an OBJ file has that is not rendered as it stands, counted.

use crate::load::polygon::{concave, fan_covers};
use crate::report::LoadReport;
use glam::DVec3;
use std::collections::BTreeMap;

/// What is left out, counted.
#[derive(Default)]
pub(super) struct Census {
    pub(super) colored: usize,
    smoothed: usize,
    concave: Vec<usize>,
    pub(super) ignored: BTreeMap<String, usize>,
}

impl Census {
    /// Notes a polygon that a fan does not cover, and one whose normals pretend that it is curved.
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
        // Less than that, some 2.5 degrees, is what files round their normals to.
        self.smoothed += usize::from(normals.iter().any(|normal| normal.dot(face_normal).abs() < 0.999));
    }

    /// Says it.
    pub(super) fn report(&self, report: &mut LoadReport) {
        if self.smoothed > 0 {
            report.approximated(
                "the file",
                format!(
                    "{} polygons are smoothed by vertex normals and rendered flat; use finer meshes where facets show",
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

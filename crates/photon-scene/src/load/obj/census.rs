//! Counts features of an OBJ file that are not rendered as given.

use super::group::Corner;
use crate::load::polygon::{concave, fan_covers};
use crate::report::LoadReport;
use glam::DVec3;
use std::collections::BTreeMap;

/// The counts.
#[derive(Default)]
pub(super) struct Census {
    concave: Vec<usize>,
    pub(super) ignored: BTreeMap<String, usize>,
}

impl Census {
    /// Counts a polygon that a fan does not cover.
    pub(super) fn polygon(&mut self, corners: &[Corner], positions: &[[f64; 3]], line: usize) {
        let place = |corner: &Corner| positions.get(corner.position as usize).map(|&at| DVec3::from_array(at));
        let places: Option<Vec<DVec3>> = corners.iter().map(place).collect();
        let Some(places) = places else { return };
        if !fan_covers(&places) {
            self.concave.push(line);
        }
    }

    /// Adds the counts to the report.
    pub(super) fn report(&self, report: &mut LoadReport) {
        if let Some(line) = self.concave.first() {
            report.approximated("the file", concave(self.concave.len(), &format!("in line {line}")));
        }
        for (keyword, count) in &self.ignored {
            report.left_out("the file", format!("{count} statements '{keyword}', which are not geometry that is read"));
        }
    }
}

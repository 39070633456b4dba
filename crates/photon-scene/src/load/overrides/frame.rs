//! Relative coordinates of override files.

use crate::builder::SceneBuilder;

/// The bounding box of the scene's triangles, as far as `relative` coordinates need it.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    center: [f64; 3],
    /// Its largest extent; 1 for an empty box.
    pub(super) size: f64,
}

impl Frame {
    pub(super) fn of(scene: &SceneBuilder) -> Self {
        let (low, high) = scene.bounds().unwrap_or(([-0.5; 3], [0.5; 3]));
        let extents: [f64; 3] = std::array::from_fn(|axis| high[axis] - low[axis]);
        let size = extents.into_iter().fold(0.0, f64::max);
        Self {
            center: std::array::from_fn(|axis| low[axis] + 0.5 * extents[axis]),
            size: if size > 0.0 { size } else { 1.0 },
        }
    }

    pub(super) fn place(self, relative: bool, at: [f64; 3]) -> [f64; 3] {
        if !relative {
            return at;
        }
        std::array::from_fn(|axis| self.center[axis] + self.size * at[axis])
    }

    /// A parallelogram, counter-clockwise as seen from the side to which the cross product of its edges points.
    pub(super) fn corners(self, relative: bool, corner: [f64; 3], [first, second]: [[f64; 3]; 2]) -> [[f64; 3]; 4] {
        let sum = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|axis| a[axis] + b[axis]);
        let next = sum(corner, first);
        [corner, next, sum(next, second), sum(corner, second)].map(|at| self.place(relative, at))
    }
}

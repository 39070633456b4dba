//! Grids of densities of the media inside solids.

use std::fmt;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use photon_core::{Grid, Medium, OwnedGridTables};

use crate::error::SceneError;
use crate::normalise::Frame;

/// Densities by which the coefficients of a medium are multiplied: smoke, clouds.
///
/// They are trilinear between cell centres, clamped at the border, and 0 outside of the box of the grid.
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub struct GridDesc {
    /// Number of cells along x, y and z, ≥ 1; at most [`Self::MAX_CELLS`] in all.
    pub cells: [u32; 3],
    /// One density for each cell, finite and ≥ 0, x fastest.
    pub densities: Arc<[f32]>,
    /// Rows of an affine transform from the unit cube, which the cells fill, to user space; the last is 0, 0, 0, 1.
    pub transform: [[f64; 4]; 4],
    /// Factor on the densities, finite and ≥ 0.
    pub density_scale: f64,
}

/// Leaves out the densities.
impl fmt::Debug for GridDesc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cells, densities: _, transform, density_scale } = self;
        let mut text = f.debug_struct("GridDesc");
        text.field("cells", cells).field("transform", transform).field("density_scale", density_scale);
        text.finish_non_exhaustive()
    }
}

impl GridDesc {
    /// Greatest number of cells: 512³.
    pub const MAX_CELLS: u64 = 1 << 27;

    /// Densities of the unit cube.
    #[must_use]
    pub fn new(cells: [u32; 3], densities: impl Into<Arc<[f32]>>) -> Self {
        let unit = std::array::from_fn(|row| std::array::from_fn(|column| f64::from(u8::from(row == column))));
        Self { cells, densities: densities.into(), transform: unit, density_scale: 1.0 }
    }

    /// The grid with this [`Self::transform`].
    #[must_use]
    pub fn with_transform(self, transform: [[f64; 4]; 4]) -> Self {
        Self { transform, ..self }
    }

    /// The grid with this transform, that of an axis-aligned box with these corners.
    #[must_use]
    pub fn with_box(self, low: [f64; 3], high: [f64; 3]) -> Self {
        let mut transform = [[0.0; 4], [0.0; 4], [0.0; 4], [0.0, 0.0, 0.0, 1.0]];
        for axis in 0..3 {
            (transform[axis][axis], transform[axis][3]) = (high[axis] - low[axis], low[axis]);
        }
        self.with_transform(transform)
    }

    /// The grid with this [`Self::density_scale`].
    #[must_use]
    pub fn with_density_scale(self, density_scale: f64) -> Self {
        Self { density_scale, ..self }
    }

    /// The largest density.
    fn largest(&self) -> f32 {
        self.densities.iter().copied().fold(0.0, f32::max)
    }

    /// The largest factor on coefficients.
    pub(crate) fn factor(&self) -> f64 {
        self.density_scale * f64::from(self.largest())
    }

    fn linear(&self) -> DMat3 {
        let column = |at: usize| DVec3::new(self.transform[0][at], self.transform[1][at], self.transform[2][at]);
        DMat3::from_cols(column(0), column(1), column(2))
    }

    /// Why it is invalid: property, value and hint.
    pub(crate) fn fault(&self) -> Option<(&'static str, String, &'static str)> {
        let count = self.cells.iter().try_fold(1_u64, |all, &cells| all.checked_mul(u64::from(cells)));
        if !count.is_some_and(|count| (1..=Self::MAX_CELLS).contains(&count)) {
            let hint = "each side must have at least 1 cell, and all of it at most 2^27, such as 512x512x512";
            return Some(("grid", format!("one of {:?} cells", self.cells), hint));
        }
        if count != Some(self.densities.len() as u64) {
            let value = format!("one of {:?} cells with {} densities", self.cells, self.densities.len());
            return Some(("grid", value, "every cell needs one density"));
        }
        let is_valid = |density: &f32| density.is_finite() && *density >= 0.0;
        if let Some((index, density)) = self.densities.iter().enumerate().find(|(_, density)| !is_valid(density)) {
            let hint = "densities must be finite and at least 0: smoke and clouds, not distances from a surface";
            return Some(("grid", format!("one with the density {density} in cell {index}"), hint));
        }
        if !(self.density_scale.is_finite() && self.density_scale >= 0.0) {
            return Some(("density_scale", self.density_scale.to_string(), "it must be finite and at least 0"));
        }
        let value = || format!("{:?}", self.transform);
        if self.transform[3] != [0.0, 0.0, 0.0, 1.0] || !self.transform.iter().flatten().all(|part| part.is_finite()) {
            return Some(("transform", value(), "it needs four rows of finite numbers, the last of them 0, 0, 0, 1"));
        }
        // Relative to the volume of a cuboid of such edges.
        let linear = self.linear();
        let edges: f64 = [0, 1, 2].map(|axis| linear.col(axis).length()).iter().product();
        let is_invertible = linear.determinant().abs() > 1e-9 * edges && linear.inverse().is_finite();
        (!is_invertible).then(|| {
            ("transform", value(), "it must map the unit cube to a body with a volume: its columns are the edges")
        })
    }

    /// The map from normalised space to nodes: rows of a [`Grid`].
    fn rows(&self, frame: Frame) -> [[f32; 4]; 3] {
        let inverse = self.linear().inverse();
        let corner = DVec3::new(self.transform[0][3], self.transform[1][3], self.transform[2][3]);
        let shift = inverse * (frame.center - corner);
        std::array::from_fn(|axis| {
            let cells = f64::from(self.cells[axis]);
            let row = inverse.row(axis) * (frame.scale * cells);
            [row.x, row.y, row.z, shift[axis] * cells + 0.5].map(|part| part as f32)
        })
    }
}

/// The media of a scene, in the order in which they were added.
pub(crate) struct MediaTable<'a> {
    media: Vec<Medium>,
    grids: Vec<Option<&'a GridDesc>>,
}

impl<'a> MediaTable<'a> {
    /// Begins with the space around solids.
    pub(crate) fn new(ambient: Medium) -> Self {
        Self { media: vec![ambient], grids: vec![None] }
    }

    /// Index of a medium, after the ambient one; equal media share an entry. Coefficients are those at the largest density.
    pub(crate) fn index_of(&mut self, medium: Medium, grid: Option<&'a GridDesc>) -> u32 {
        let mut known = self.media.iter().zip(&self.grids).skip(1);
        let index = known.position(|known| known == (&medium, &grid)).map_or_else(
            || {
                self.media.push(medium);
                self.grids.push(grid);
                self.media.len() - 1
            },
            |index| index + 1,
        );
        index as u32
    }

    /// Whether any of them absorbs or scatters light.
    pub(crate) fn attenuates(&self) -> bool {
        self.media.iter().any(Medium::attenuates)
    }

    /// Number of media inside solids and boundaries.
    pub(crate) fn solids(&self) -> usize {
        self.media.len() - 1
    }

    /// The table, and the grids of its media.
    pub(crate) fn build(self, frame: Frame) -> Result<(Vec<Medium>, OwnedGridTables), SceneError> {
        let mut tables = OwnedGridTables::default();
        let mut added: Vec<(&GridDesc, u32)> = Vec::new();
        for (medium, grid) in self.grids.iter().enumerate() {
            let Some(desc) = grid else { continue };
            let largest = desc.largest();
            if !(largest > 0.0) {
                continue;
            }
            let is_same =
                |other: &GridDesc| other.cells == desc.cells && Arc::ptr_eq(&other.densities, &desc.densities);
            let first = match added.iter().find(|(other, _)| is_same(other)) {
                Some(&(_, first)) => first,
                None => tables.add(desc.cells, &desc.densities, largest)?,
            };
            added.push((desc, first));
            tables.grids.resize(self.media.len(), Grid::default());
            let [x, y, z] = desc.rows(frame);
            tables.grids[medium] = Grid { x, y, z, cells: desc.cells, first };
        }
        Ok((self.media, tables))
    }
}

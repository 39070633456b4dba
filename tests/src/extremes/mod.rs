//! Tests of the limits: extreme sizes, powers, counts, shapes and refractive indices.
//!
//! Each group of cases fills a [`Sheet`] with rows: what was tried, over which range, and the result. The quick
//! extent runs in the ordinary tests; `cargo xtask extremes` writes the rows of every backend to
//! `docs/studies/extremes.csv`.

pub mod geometry;
pub mod large;
pub mod optics;
pub mod points;
pub mod power;
pub mod scale;
pub mod scenes;
pub mod sheet;
pub mod views;

pub use sheet::{Extent, Row, Sheet, Verdict};

use crate::harness::TestBackend;

/// A group of cases.
pub type Group = fn(&mut Sheet);

/// All groups with their names, for one backend.
#[must_use]
pub fn groups<T: TestBackend>() -> Vec<(&'static str, Group)> {
    vec![
        ("Scale and place", scale::all::<T> as Group),
        ("Power and counts", power::all::<T>),
        ("Points", points::all::<T>),
        ("Large maps", large::all::<T>),
        ("Geometry", geometry::all::<T>),
        ("Optics", optics::all::<T>),
        ("Cameras and lights", views::all::<T>),
    ]
}

//! The compiled part of the Python package `photonmap`. The classes that users see are in the Python files beside it.
#![forbid(unsafe_code)]

mod error;
mod frame;
mod gpu;
mod points;
mod process;
mod tree;

use pyo3::prelude::*;

/// The compiled part of `photonmap`.
#[pymodule]
mod _photonmap {
    #[pymodule_export]
    use crate::tree::Tree;
}

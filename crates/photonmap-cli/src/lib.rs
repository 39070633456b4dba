//! What the programs of this package share: arguments, pictures in files, reports.
#![forbid(unsafe_code)]

pub mod args;
pub mod backend;
pub mod difference;
pub mod exr_file;
pub mod fault;
pub mod memory;
pub mod npy;
pub mod png_file;
pub mod report;
pub mod tonemap;
pub mod whole;

//! Tests with generated files.

mod damage;
mod deviations;
pub(super) mod file;
mod fuzz;
mod geometry;
mod glossy;
mod lights;
mod materials;
mod pose;
mod textures;

//! Tests with generated files.

mod damage;
mod file;
mod fuzz;
mod geometry;
mod glossy;
mod lights;
mod materials;
mod textures;

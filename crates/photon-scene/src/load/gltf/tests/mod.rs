//! Tests with generated files.

mod damage;
mod file;
mod fuzz;
mod geometry;
mod lights;
mod materials;
mod pose;
mod textures;

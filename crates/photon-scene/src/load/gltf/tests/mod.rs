//! Files made here, and what is read from them.

mod damage;
mod file;
mod fuzz;
mod geometry;
mod lights;
mod materials;

//! Files made here, and what is read from them.

mod damage;
mod file;
mod geometry;
mod lights;
mod materials;

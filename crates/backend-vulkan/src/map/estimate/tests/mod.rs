//! Searches on the device against backend-cpu's.

mod estimates;
mod inputs;
mod maps;
mod neighbours;
mod pauses;

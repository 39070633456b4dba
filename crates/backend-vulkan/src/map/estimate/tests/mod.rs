//! Searches on the device compared with backend-cpu's.

mod estimates;
mod inputs;
mod maps;
mod neighbours;
mod pauses;

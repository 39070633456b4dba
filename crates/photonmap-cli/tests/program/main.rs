//! The program `photonmap`, tested by its command line.
#![expect(clippy::unwrap_used, reason = "test code")]

mod backends;
mod blender;
mod commands;
mod compare;
#[cfg(unix)]
mod denoise;
mod environment;
mod export;
mod files;
mod film;
mod map;
mod progress;
mod render;
mod support;
mod watch;

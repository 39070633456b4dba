//! The interface for C and C++: `photonmap.h`, as a shared and as a static library.
//!
//! The header is generated from this crate by a test; `docs/c.md` describes how to build with it, and
//! `examples/c` has programs in C and C++. Rust programs use the crate `photonmap` instead.
//!
//! Only these files have unsafe code: `pointer` (arrays, text and handles of the caller), `caster` (calls of the caller's
//! ray caster), `renderer` (calls of the caller's progress function), and the entry functions, which pass on pointers.
#![allow(clippy::missing_safety_doc, reason = "the header states for each function what its pointers have to be")]
#![allow(clippy::missing_errors_doc, reason = "every function returns a status, which the header describes")]

mod builder;
mod caster;
mod describe;
mod device;
mod error;
mod film;
mod map;
mod options;
mod photons;
mod pointer;
mod renderer;
mod scene;

pub use builder::*;
pub use caster::{PM_NO_HIT, PmCaster, PmHit, PmRay};
pub use describe::*;
pub use device::pm_devices;
pub use error::{PM_ABI, PmStatus, pm_abi, pm_last_error, pm_version};
pub use film::*;
pub use map::*;
pub use options::*;
pub use photons::*;
pub use renderer::*;
pub use scene::*;

//! The truth, as generic functions over a backend: every backend runs the same suite.
//!
//! Names begin with the number of the closed form or of the failure mode in the tables of
//! `tests/README.md`. Random numbers are fixed by seeds; statistical bounds are 4.5 standard errors,
//! computed where they are used.
#![forbid(unsafe_code)]
#![expect(clippy::unwrap_used, clippy::missing_panics_doc, reason = "all of this is test code")]

pub mod determinism;
pub mod dielectrics;
pub mod direct;
pub mod equivalence;
pub mod estimators;
pub mod harness;
pub mod interreflection;
pub mod numerics;
pub mod paper;
pub mod stats;

/// Makes a `#[test]` of each function for one backend.
#[macro_export]
macro_rules! suite {
    ($backend:ty, $($module:ident :: { $($name:ident),+ $(,)? })+) => {
        $(mod $module {
            #[allow(unused_imports, reason = "a backend named by its full path needs none")]
            use super::*;
            $(#[test]
            fn $name() {
                if <$backend as $crate::harness::TestBackend>::available() {
                    $crate::$module::$name::<$backend>();
                }
            })+
        })+
    };
}

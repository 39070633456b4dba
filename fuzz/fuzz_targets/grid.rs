//! Any bytes as a grid of densities, in both formats: an error with a message, or valid densities.
#![no_main]

use photon_scene::{GridDesc, LoadOptions};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    for name in ["a.vol", "a.nvdb"] {
        match GridDesc::read(&photon_fuzz::file(name, data), &LoadOptions::default().with_memory(Some(1 << 26))) {
            Ok(grid) => {
                let cells: u64 = grid.cells.iter().map(|&cells| u64::from(cells)).product();
                assert_eq!(cells, grid.densities.len() as u64);
                assert!(grid.densities.iter().all(|density| density.is_finite() && *density >= 0.0));
                assert!(grid.transform.iter().flatten().all(|part| part.is_finite()));
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
});

//! Any two array files, as `photonmap map` reads them: an error with a message, or points that can be searched.
#![no_main]

use backend_cpu::index::{IndexKind, Neighbours, PointIndex};
use photon_image::npy;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    // The second file starts at the next magic number of an array file.
    let again = data.windows(6).skip(1).position(|window| window == b"\x93NUMPY").map_or(data.len(), |at| at + 1);
    let read = |name: &str, bytes: &[u8]| match npy::read_points(&photon_fuzz::file(name, bytes)) {
        Ok(points) => {
            assert!(points.len() * 12 < bytes.len());
            Some(points)
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            None
        }
    };
    let (photons, queries) = (read("p.npy", &data[..again]), read("q.npy", &data[again..]));
    let (Some(photons), Some(queries)) = (photons, queries) else { return };
    for kind in [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton] {
        let Ok(index) = PointIndex::build(&photons, kind) else {
            assert!(photons.iter().flatten().any(|x| !x.is_finite()));
            return;
        };
        let mut nearest = Neighbours::default();
        for &query in queries.iter().take(16) {
            index.nearest_of_all(query, 3, f32::INFINITY, &mut nearest);
            assert!(nearest.as_slice().len() <= photons.len().min(3));
            assert!(nearest.as_slice().iter().all(|n| (n.id as usize) < photons.len() && !n.d2.is_nan()));
            assert!(index.count_within(query, 1.0) as usize <= photons.len());
        }
    }
});

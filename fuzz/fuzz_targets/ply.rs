//! Whatever a file says: an error in words, or a sound scene.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    photon_fuzz::check(photon_scene::load(&photon_fuzz::file("a.ply", data), None));
});

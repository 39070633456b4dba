//! Any STL file: an error with a message, or a valid scene.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    photon_fuzz::check(photon_scene::load(&photon_fuzz::file("a.stl", data), None));
});

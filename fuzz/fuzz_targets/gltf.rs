//! Whatever a file says: an error in words, or a sound scene.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    // Both containers: the binary one is told by its first bytes.
    let name = if data.starts_with(b"glTF") { "a.glb" } else { "a.gltf" };
    photon_fuzz::check(photon_scene::load(&photon_fuzz::file(name, data), None));
});

//! Any glTF file: an error with a message, or a valid scene.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    // Both containers: the binary one is recognised by its first bytes.
    let name = if data.starts_with(b"glTF") { "a.glb" } else { "a.gltf" };
    photon_fuzz::check(photon_scene::load(&photon_fuzz::file(name, data), None));
});

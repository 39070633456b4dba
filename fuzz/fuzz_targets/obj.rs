//! Any OBJ file: an error with a message, or a valid scene.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    // After a separator line follows the material library.
    let at = data.windows(5).position(|window| window == b"\n%%%\n");
    let (obj, mtl) = at.map_or((data, &[][..]), |at| (&data[..at], &data[at + 5..]));
    photon_fuzz::file("a.mtl", mtl);
    photon_fuzz::check(photon_scene::load(&photon_fuzz::file("a.obj", obj), None));
});

//! Whatever a file says: an error in words, or a sound scene.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    // What follows a line of its own is the library of materials.
    let at = data.windows(5).position(|window| window == b"\n%%%\n");
    let (obj, mtl) = at.map_or((data, &[][..]), |at| (&data[..at], &data[at + 5..]));
    photon_fuzz::file("a.mtl", mtl);
    photon_fuzz::check(photon_scene::load(&photon_fuzz::file("a.obj", obj), None));
});

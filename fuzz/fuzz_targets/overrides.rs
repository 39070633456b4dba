//! Any override file, applied to a scene.
#![no_main]

use photon_scene::{LoadReport, Overrides};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let Ok(overrides) = Overrides::read(&photon_fuzz::file("a.toml", data)) else { return };
    let Some(mut builder) = photon_scene::builtin("cornell") else { return };
    let mut report = LoadReport::default();
    photon_fuzz::check(overrides.apply(&mut builder, &mut report).and_then(|()| Ok((builder.build()?, report))));
});

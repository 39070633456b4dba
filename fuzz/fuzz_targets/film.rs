//! Any bytes as a film file: an error with a message, or a film that can be shown.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let source = std::io::Cursor::new(data);
    match photon_film::load_from(source, data.len() as u64, "a.film".as_ref()) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok((film, info)) => {
            assert_eq!(film.pixels.len(), film.width as usize * film.height as usize);
            assert_eq!(film.beauty().len(), film.pixels.len());
            assert_eq!(info.contains.count(), u64::from(film.passes));
            // Counts of damaged files may be arbitrarily large; sums of them must not overflow.
            let _: [bool; 2] = [film.tally.photons.balances(), film.tally.aimed.balances()];
        }
    }
});

//! Any bytes as an image: an error with a message, or texels that a texture may have.
#![no_main]

use photon_core::TexelFormat;
use photon_scene::Image;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let image = match Image::decode(data) {
        Ok(image) => image,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let texture = image.texture("image", TexelFormat::Srgb8).image;
    assert!((1..=65_536).contains(&texture.width) && (1..=65_536).contains(&texture.height));
    let texels = texture.width as usize * texture.height as usize;
    assert_eq!(texture.texels.len(), texels * texture.format.words());
    if image.is_float {
        assert!(image.texels.iter().map(|word| f32::from_bits(*word)).all(|value| value.is_finite() && value >= 0.0));
    }
});

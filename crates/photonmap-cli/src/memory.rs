//! Memory of the process: how much it uses, and how much it may use.

mod available;

use std::collections::BTreeSet;

pub use photon_image::fault::bytes_text as text;
use photon_scene::Scene;

/// Resident bytes now, if the system reports them (Linux).
#[must_use]
pub fn resident() -> Option<u64> {
    status("VmRSS:")
}

/// Peak resident bytes, likewise.
#[must_use]
pub fn peak() -> Option<u64> {
    status("VmHWM:")
}

fn status(key: &str) -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| kilobytes * 1024)
}

/// Memory that the process needs besides the library's buffers: stacks, kernels, and files while they are
/// written.
const BESIDES: u64 = 24 << 20;

/// Bytes per pixel while a picture is being written: its channels, and their compressed form.
const WRITTEN: u64 = 300;

/// Memory limit for the library, including what it holds already, such that the process stays below `cap`.
#[must_use]
pub fn for_the_library(cap: u64, size: (u32, u32)) -> u64 {
    cap.saturating_sub(besides(size))
}

/// Memory that the process has now, and needs for other things than the library.
#[must_use]
pub fn besides(size: (u32, u32)) -> u64 {
    let pixels = u64::from(size.0) * u64::from(size.1);
    resident().unwrap_or_default() + BESIDES + pixels * WRITTEN
}

/// Memory limit for loading a scene file: half of what the library may have now. The other half is for the tables that are
/// made of the scene, and for photons.
#[must_use]
pub fn for_loading(cap: u64, size: (u32, u32)) -> u64 {
    for_the_library(cap, size) / 2
}

/// The same without a limit by the user: half of what is available on this machine. `None` where the system does not say.
#[must_use]
pub fn for_loading_by_default() -> Option<u64> {
    available::available().map(|bytes| bytes / 2)
}

/// Bytes of the texels of a scene; textures that share them count once.
#[must_use]
pub fn texels(scene: &Scene) -> u64 {
    let mut seen = BTreeSet::new();
    let images = scene.view().shading.textures.iter();
    images.filter(|image| seen.insert(image.texels.as_ptr())).map(|image| size_of_val(&*image.texels) as u64).sum()
}

/// Parses a size in bytes: `2GiB`, `500MB`, `1048576`.
///
/// # Errors
/// A message for the user.
pub fn parse(text: &str) -> Result<u64, String> {
    let split = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (digits, unit) = text.split_at(split);
    let unit = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "k" | "kib" => 1024.0,
        "m" | "mib" => 1_048_576.0,
        "g" | "gib" => 1_073_741_824.0,
        _ => return Err("give a size such as 2GiB, 500MB or a number of bytes".to_owned()),
    };
    match digits.parse::<f64>() {
        Ok(number) if number > 0.0 && number * unit < 1e18 => Ok((number * unit) as u64),
        _ => Err("give a size above 0, such as 2GiB".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_absurd_ones_refused() {
        assert_eq!(parse("2GiB"), Ok(2 << 30));
        assert_eq!(parse("1.5 MB"), Ok(1_500_000));
        assert_eq!(parse("4096"), Ok(4096));
        for bad in ["", "GiB", "-1", "0", "2 ells", "1e3", "99999999999GiB"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_peak_is_no_less_than_what_is_resident() {
        if let (Some(now), Some(peak)) = (resident(), peak()) {
            assert!(now > 0 && peak >= now);
        }
    }
}

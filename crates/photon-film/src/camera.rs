//! Cameras in the key of a film.

use bytemuck::bytes_of_mut;
use photon_core::Camera;

/// The bytes of a camera in hexadecimal.
pub(crate) fn record(camera: &Camera) -> String {
    bytemuck::bytes_of(camera).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The members in which two cameras differ, with the values of each; the ends of records that are no cameras.
pub(crate) fn difference(records: [&str; 2]) -> [String; 2] {
    let [Some(found), Some(expected)] = records.map(camera) else {
        return records
            .map(|record| format!("..{}", record.get(record.len().saturating_sub(16)..).unwrap_or_default()));
    };
    let [found, expected] = [found, expected].map(|camera| members(&camera));
    let differ = || found.iter().zip(&expected).filter(|(found, expected)| found.1 != expected.1);
    let text = |(name, value): &(&str, String)| format!("{name} {value}");
    let all = |texts: Vec<String>| format!("one with {}", texts.join(", "));
    [all(differ().map(|(found, _)| text(found)).collect()), all(differ().map(|(_, expected)| text(expected)).collect())]
}

fn camera(record: &str) -> Option<Camera> {
    let mut camera = Camera::default();
    let bytes = bytes_of_mut(&mut camera);
    if record.len() != 2 * bytes.len() || !record.is_ascii() {
        return None;
    }
    for (at, byte) in bytes.iter_mut().enumerate() {
        *byte = u8::from_str_radix(&record[2 * at..2 * at + 2], 16).ok()?;
    }
    Some(camera)
}

/// All members by name; lengths are normalised.
fn members(camera: &Camera) -> [(&'static str, String); 8] {
    // Every member by name: a new one is an error here until it is compared.
    let Camera { origin, kind, forward, media, right, lens_radius, up, focus_distance } = camera;
    [
        ("position", format!("{origin:?}")),
        ("direction", format!("{forward:?}")),
        ("projection", if *kind == Camera::PERSPECTIVE { "perspective" } else { "orthographic" }.to_owned()),
        ("half width", format!("{right:?}")),
        ("half height", format!("{up:?}")),
        ("lens radius", lens_radius.to_string()),
        ("distance of focus", focus_distance.to_string()),
        ("medium", media.to_string()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_differ_by_name() {
        let plain = Camera { origin: [0.25, 0.0, 0.0], ..Camera::default() };
        let other = Camera { origin: [0.5, 0.0, 0.0], lens_radius: 0.125, ..plain };
        let records = [plain, other].map(|camera| record(&camera));
        let [found, expected] = difference([&records[0], &records[1]]);
        assert_eq!(found, "one with position [0.25, 0.0, 0.0], lens radius 0");
        assert_eq!(expected, "one with position [0.5, 0.0, 0.0], lens radius 0.125");
        let [short, _] = difference([&"a".repeat(999), &records[0]]);
        assert_eq!(short, format!("..{}", "a".repeat(16)));
        assert!(difference(["x\u{e9}", ""]).iter().all(|text| text.len() < 20));
    }
}

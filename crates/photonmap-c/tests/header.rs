//! The committed header is the one that cbindgen generates from the sources.
#![expect(clippy::unwrap_used, reason = "test code")]

use std::path::Path;

use cbindgen::{Builder, Config, DocumentationStyle, EnumConfig, ExportConfig, Language, RenameRule, Style};

/// The sources, in the order of the header.
const SOURCES: [&str; 11] = [
    "error.rs",
    "describe.rs",
    "scene.rs",
    "builder.rs",
    "caster.rs",
    "options.rs",
    "device.rs",
    "renderer.rs",
    "film.rs",
    "photons.rs",
    "map.rs",
];

const INTRODUCTION: &str = "\
/*
 * photonmap: photon mapping on the CPU and on GPUs. Generated; see docs/c.md.
 *
 * Handles are opaque. Functions that make one say what frees it; NULL may be freed, and a handle must not be freed
 * twice. Arrays and texts are the caller's, and are not kept after a call. Texts are UTF-8 and end with a zero.
 *
 * Functions that can fail return a status, and pm_last_error() has words for it, for each thread. NULL, sizes that do
 * not fit, and numbers that are not finite or out of range are errors. What a pointer points to cannot be checked.
 *
 * Structs begin with their size, which the caller sets to sizeof: `PmView view = {sizeof view};` sets all else to 0.
 * Fields may be added at the end in later versions, where 0 has the effect of this version.
 *
 * Any thread may call any function, but not two at once with the same handle, unless both arguments are const.
 *
 * Lengths are in user space, whose unit is called m. Colours are linear RGB; light is in radiometric units.
 */";

fn generated(root: &Path) -> String {
    let config = Config {
        language: Language::C,
        cpp_compat: true,
        header: Some(INTRODUCTION.into()),
        include_guard: Some("PHOTONMAP_H".into()),
        no_includes: true,
        sys_includes: vec!["stddef.h".into(), "stdint.h".into()],
        usize_is_size_t: true,
        documentation_style: DocumentationStyle::Doxy,
        style: Style::Both,
        line_length: 120,
        enumeration: EnumConfig { rename_variants: RenameRule::QualifiedScreamingSnakeCase, ..EnumConfig::default() },
        export: ExportConfig { include: vec!["PmProgress".into()], ..ExportConfig::default() },
        ..Config::default()
    };
    let mut builder = Builder::new().with_config(config);
    for source in SOURCES {
        builder = builder.with_src(root.join("src").join(source));
    }
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}

#[test]
fn the_header_is_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (path, expected) = (root.join("include/photonmap.h"), generated(root));
    if std::env::var_os("PHOTON_RENEW_HEADER").is_some() {
        std::fs::write(&path, &expected).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    let differs = found.lines().zip(expected.lines()).position(|(found, expected)| found != expected);
    assert!(
        found == expected,
        "photonmap.h differs from the sources (first in line {}); run PHOTON_RENEW_HEADER=1 cargo nextest run -p photonmap-c --test header",
        differs.map_or(0, |line| line + 1)
    );
}

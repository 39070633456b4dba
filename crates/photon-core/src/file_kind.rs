//! Kinds of files by their first bytes.

use std::fmt;

/// A kind of file that its first bytes show: for messages about files that are not what their names say.
///
/// ```
/// let kind = photon_core::FileKind::other_than(&["glb"], b"<!DOCTYPE html><title>a.glb</title>").unwrap();
/// assert_eq!(kind.to_string(), "is an HTML page; download the file itself instead of the page about it");
/// assert_eq!(photon_core::FileKind::other_than(&["glb"], b"glTF\x02\0\0\0"), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FileKind {
    /// Its extension in lower case, where files of the kind are read.
    pub extension: Option<&'static str>,
    /// Name with its article.
    pub name: &'static str,
    /// Instruction for a file that should be of another kind.
    pub remedy: &'static str,
}

const PICTURE: &str = "give the file that was meant; a picture is a texture or an environment";
const CONVERT: &str = "convert it to PNG or OpenEXR if it is meant as a picture";
const EXPORT: &str = "import it in Blender and export glTF 2.0 (.glb)";
const RENAME: &str = "give it the extension of its format";
const GRID: &str = "give it the extension of its format; materials in override files have grids";

/// First bytes, and what they show.
type Row = (&'static [u8], Option<&'static str>, &'static str, &'static str);

#[rustfmt::skip]
const BINARY: &[Row] = &[
    (b"version https://git-lfs.github.com/", None, "a Git LFS pointer", "fetch the file with `git lfs pull`"),
    (b"/annex/objects/", None, "a git-annex pointer", "fetch the file with `git annex get`"),
    (b"404: Not Found", None, "a server's message that there is no such file", "check the address, and download it again"),
    (b"glTF", Some("glb"), "a GLB", RENAME),
    (b"ply\n", Some("ply"), "a PLY file", RENAME),
    (b"ply\r", Some("ply"), "a PLY file", RENAME),
    (b"VOL\x03", Some("vol"), "a grid of densities of Mitsuba", GRID),
    (b"NanoVDB", Some("nvdb"), "a grid of NanoVDB", GRID),
    (b" BDV\0\0\0\0", None, "an OpenVDB file", "make a .nvdb of it by nanovdb_convert"),
    (b"\x89PNG", Some("png"), "a PNG picture", PICTURE),
    (b"\xff\xd8\xff", Some("jpg"), "a JPEG picture", PICTURE),
    (b"\x76\x2f\x31\x01", Some("exr"), "an OpenEXR picture", PICTURE),
    (b"#?RADIANCE", Some("hdr"), "a Radiance HDR picture", PICTURE),
    (b"#?RGBE", Some("hdr"), "a Radiance HDR picture", PICTURE),
    (b"\x93NUMPY", Some("npy"), "an array of NumPy", RENAME),
    (b"\xabKTX 20", None, "a KTX2 texture", CONVERT),
    (b"\xabKTX", None, "a KTX texture", CONVERT),
    (b"sB\x13\0", None, "a Basis texture", CONVERT),
    (b"DDS ", None, "a DDS texture", CONVERT),
    (b"GIF8", None, "a GIF", CONVERT),
    (b"II*\0", None, "a TIFF", CONVERT),
    (b"MM\0*", None, "a TIFF", CONVERT),
    (b"8BPS", None, "a Photoshop document", CONVERT),
    (b"%PDF", None, "a PDF document", "give the file that was meant"),
    (b"Kaydara FBX Binary", None, "an FBX file", EXPORT),
    (b"BLENDER", None, "a Blender file", "export it from Blender as glTF 2.0 (.glb)"),
    (b"PXR-USDC", None, "a USD file", EXPORT),
    (b"#usda", None, "a USD file", EXPORT),
    (b"Ogawa", None, "an Alembic file", EXPORT),
    (b"\x1f\x8b", None, "compressed by gzip", "unpack it with gunzip, and load that"),
    (b"BZh", None, "compressed by bzip2", "unpack it with bunzip2, and load that"),
    (b"\xfd7zXZ\0", None, "compressed by xz", "unpack it with unxz, and load that"),
    (b"\x28\xb5\x2f\xfd", None, "compressed by zstd", "unpack it with unzstd, and load that"),
    (b"PK\x03\x04", Some("zip"), "a ZIP archive", "unpack it, and load a file in it"),
    (b"PK\x05\x06", Some("zip"), "an empty ZIP archive", "download it again"),
    (b"7z\xbc\xaf\x27\x1c", None, "a 7z archive", "unpack it, and load a file in it"),
    (b"Rar!\x1a\x07", None, "a RAR archive", "unpack it, and load a file in it"),
];

/// First words of text, in lower case and without white space before them, and their kinds.
#[rustfmt::skip]
const TEXT: &[Row] = &[
    (b"<!doctype html", None, HTML.0, HTML.1),
    (b"<html", None, HTML.0, HTML.1),
    (b"<head", None, HTML.0, HTML.1),
    (b"<svg", None, "an SVG drawing", "give the file that was meant"),
    (b"<?xml", None, "an XML document", "open it in a text editor: it may be the message of a server"),
    (b"solid ", Some("stl"), "an STL file", RENAME),
    (b"solid\n", Some("stl"), "an STL file", RENAME),
    (b"{", Some("gltf"), "JSON", "give it the extension .gltf if it is glTF"),
];
const HTML: (&str, &str) = ("an HTML page", "download the file itself instead of the page about it");

impl FileKind {
    /// So many bytes at the start of a file show its kind.
    pub const START: usize = 512;

    /// The kind of the file that starts with these bytes, unless its extension, in lower case, is one of `expected`; none of an
    /// unknown kind.
    #[must_use]
    pub fn other_than(expected: &[&str], bytes: &[u8]) -> Option<Self> {
        Self::of(bytes).filter(|kind| kind.extension.is_none_or(|known| !expected.contains(&known)))
    }

    /// The kind of the file that starts with these bytes.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let kind = |extension, name, remedy| Some(Self { extension, name, remedy });
        if bytes.is_empty() {
            return kind(None, "empty", "copy, download or export it again");
        }
        let found = |rows: &[Row], start: &[u8]| {
            rows.iter().find(|row| start.starts_with(row.0)).map(|&(_, extension, name, remedy)| Self {
                extension,
                name,
                remedy,
            })
        };
        if let Some(found) = found(BINARY, bytes) {
            return Some(found);
        }
        match (bytes.get(..4), bytes.get(4..12)) {
            (Some(b"RIFF"), Some(rest)) if rest.ends_with(b"WEBP") => {
                return kind(Some("webp"), "a WebP picture", PICTURE);
            }
            // The length of the file, then zeros.
            (Some([b'B', b'M', ..]), _) if bytes.get(6..10) == Some(&[0; 4]) => return kind(None, "a BMP", CONVERT),
            (_, Some(b"ftypavif")) => return kind(None, "an AVIF", CONVERT),
            (_, Some(b"ftypheic" | b"ftypheix" | b"ftypmif1")) => return kind(None, "a HEIC", CONVERT),
            _ => {}
        }
        if bytes.get(257..262) == Some(b"ustar") {
            return kind(None, "a TAR archive", "unpack it, and load a file in it");
        }
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        let start: Vec<u8> = text.iter().take(16).map(u8::to_ascii_lowercase).collect();
        found(TEXT, &start)
    }
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "is {}; {}", self.name, self.remedy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_known_by_their_first_bytes() {
        let mut tar = vec![b'a'; 512];
        tar[257..262].copy_from_slice(b"ustar");
        for (bytes, name) in [
            (&b""[..], "empty"),
            (b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12\n", "a Git LFS pointer"),
            (b"\n\n  <!DOCTYPE HTML PUBLIC>", "an HTML page"),
            (b"\xef\xbb\xbf<HTML lang=de>", "an HTML page"),
            (b"404: Not Found", "a server's message that there is no such file"),
            (b"RIFF\x01\0\0\0WEBPVP8 ", "a WebP picture"),
            (b"\0\0\0\x1cftypavif", "an AVIF"),
            (b" BDV\0\0\0\0\x08", "an OpenVDB file"),
            (b"\r\n {\"asset\": 1}", "JSON"),
            (b"BM\x46\0\0\0\0\0\0\0\x36\0\0\0", "a BMP"),
            (&tar, "a TAR archive"),
        ] {
            assert_eq!(FileKind::of(bytes).map(|kind| kind.name), Some(name), "{bytes:?}");
        }
        for bytes in [&b"v 0 0 0\n"[..], b"\0", b"ply", b"RIFF\x01\0\0\0WAVEfmt ", b"# a comment", b"\xff"] {
            assert_eq!(FileKind::of(bytes), None, "{bytes:?}");
        }
    }

    #[test]
    fn what_is_expected_is_no_other_kind() {
        assert_eq!(FileKind::other_than(&["gltf", "glb"], b"{}"), None);
        assert_eq!(FileKind::other_than(&["obj"], b"{}").unwrap().extension, Some("gltf"));
        // However it is called, an empty file is none.
        assert_eq!(FileKind::other_than(&["obj"], b"").unwrap().name, "empty");
    }
}

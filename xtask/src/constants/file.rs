//! The text of a file of constants.

use std::fmt::{self, Write as _};
use std::fs;
use std::path::Path;

/// A description of a group of constants, and their names and values.
pub(super) type Group = (&'static str, Vec<(&'static str, Number)>);

/// The value of a constant.
#[derive(Clone, Copy, Debug)]
pub(super) enum Number {
    Uint(u32),
    Int(i32),
    Float(f64),
}

impl From<u32> for Number {
    fn from(value: u32) -> Self {
        Self::Uint(value)
    }
}

impl From<f32> for Number {
    fn from(value: f32) -> Self {
        Self::Float(value.into())
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uint(value) => write!(f, "{value}u"),
            Self::Int(value) => write!(f, "{value}"),
            // All digits of the `f32`: a GLSL compiler may evaluate constant expressions in double precision.
            Self::Float(value) => write!(f, "{value:?}"),
        }
    }
}

impl Number {
    fn glsl_type(self) -> &'static str {
        match self {
            Self::Uint(_) => "uint",
            Self::Int(_) => "int",
            Self::Float(_) => "float",
        }
    }
}

/// The text of a file.
pub(super) fn text(guard: &str, groups: &[Group]) -> String {
    let mut text = format!(
        "// Numbers that Rust and GLSL share. Written by `cargo xtask constants`.\n#ifndef {guard}\n#define {guard}\n"
    );
    for (what, numbers) in groups {
        let _ = writeln!(text, "\n// {what}");
        for (name, number) in numbers {
            let _ = writeln!(text, "const {} {name} = {number};", number.glsl_type());
        }
    }
    text.push_str("\n#endif\n");
    text
}

/// Fails if the file is not this text.
pub(super) fn compare(path: &Path, text: &str) -> Result<(), String> {
    let old = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    if old == text {
        return Ok(());
    }
    Err(format!("{} is stale: run `cargo xtask constants`, then `cargo xtask shaders`", path.display()))
}

#[cfg(test)]
mod tests {
    use super::super::files;
    use super::*;

    #[test]
    fn a_doctored_file_is_stale() {
        let path = std::env::temp_dir().join(format!("photon-constants-{}.glsl", std::process::id()));
        for (_, guard, groups) in files() {
            let text = text(guard, &groups);
            fs::write(&path, &text).unwrap();
            assert!(compare(&path, &text).is_ok());
            fs::write(&path, text.replacen("= 16u", "= 17u", 1)).unwrap();
            assert!(compare(&path, &text).unwrap_err().contains("stale"));
            fs::remove_file(&path).unwrap();
            assert!(compare(&path, &text).is_err());
        }
    }

    /// What a compiler reads is the number, to the bit, of the right type, under a name that no other number has.
    #[test]
    fn numbers_are_written_exactly() {
        for (_, guard, groups) in files() {
            let text = text(guard, &groups);
            let all: Vec<_> = groups.iter().flat_map(|(_, numbers)| numbers).collect();
            for (name, number) in &all {
                let lines: Vec<_> = text.lines().filter(|line| line.contains(&format!(" {name} = "))).collect();
                let [line] = lines[..] else { panic!("{name} is defined {} times", lines.len()) };
                let (kind, value) = line.trim_end_matches(';').split_once(&format!(" {name} = ")).unwrap();
                let read = match number {
                    Number::Uint(n) => kind == "const uint" && value == format!("{n}u"),
                    Number::Int(n) => kind == "const int" && value.parse() == Ok(*n),
                    Number::Float(n) => kind == "const float" && value.parse() == Ok(*n) && value.contains(['.', 'e']),
                };
                assert!(read, "{line}");
            }
        }
    }
}

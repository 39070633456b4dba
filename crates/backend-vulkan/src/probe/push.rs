//! The push constants in the committed SPIR-V against those of Rust: what the tests of `pushed!` call.

use std::fs;
use std::path::Path;

use super::spirv::push_members;
use crate::shaders;

/// Whether a module's push constants are these members, each with its offset and its bytes, of a struct of so many
/// bytes. Rust may end in words that no kernel reads, which make the size a multiple of 8.
///
/// # Errors
/// What lies otherwise.
pub(crate) fn check(words: &[u32], size: usize, members: &[(&str, u32, u32)]) -> Result<(), String> {
    let sum: u32 = members.iter().map(|(.., bytes)| bytes).sum();
    if sum as usize != size {
        return Err(format!("members of {sum} bytes are listed, of a struct of {size}"));
    }
    let pushed = push_members(words)?.ok_or("the module has no push constants")?;
    let (read, unread) = members.split_at_checked(pushed.len()).ok_or("the kernel reads more than is pushed")?;
    let same = read.iter().zip(&pushed).all(|(ours, (name, offset, bytes))| *ours == (name.as_str(), *offset, *bytes));
    let fills = |name: &str| name.starts_with("pad") || name == "reserved";
    if !same || !unread.iter().all(|(name, ..)| fills(name)) {
        return Err(format!("push constants lie otherwise in SPIR-V:\n{pushed:?}\nthan in Rust:\n{members:?}"));
    }
    Ok(())
}

/// The names of modules that the sources below a folder list after `pushed!`.
fn listed(folder: &Path, names: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            listed(&path, names);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            for call in text.split("\npushed!(").skip(1) {
                let modules = call.split_once("=>").and_then(|(_, rest)| rest.split_once(',')).map_or("", |it| it.0);
                names.extend(modules.split_whitespace().map(str::to_lowercase));
            }
        }
    }
}

/// No kernel's push constants are left out.
#[test]
fn every_kernel_is_listed() {
    // Asked at run time: a target folder that was moved must not point back at the old checkout.
    let folder = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| "crates/backend-vulkan".into());
    let mut names = Vec::new();
    listed(&Path::new(&folder).join("src"), &mut names);
    // The example's kernel is a host's, which runs it without us.
    for module in shaders::ALL.iter().filter(|module| !module.name.starts_with("example_")) {
        let pushes = push_members(&module.words()).unwrap().is_some();
        assert!(!pushes || names.iter().any(|name| name == module.name), "{} is in no pushed!", module.name);
    }
}

/// A member of another name, place or size, one too few and one too many are found.
#[test]
fn structs_that_lie_otherwise_fail() {
    let words = shaders::DEVICE_COPY.words();
    let pushed = push_members(&words).unwrap().unwrap();
    let good: Vec<_> = pushed.iter().map(|(name, offset, bytes)| (name.as_str(), *offset, *bytes)).collect();
    let size = |members: &[(&str, u32, u32)]| members.iter().map(|(.., bytes)| *bytes as usize).sum::<usize>();
    check(&words, size(&good), &good).unwrap();
    let fails = |members: &[(&str, u32, u32)]| check(&words, size(members), members).unwrap_err();
    let last = good.len() - 1;
    let mut other = good.clone();
    other[last].0 = "other";
    assert!(fails(&other).contains("otherwise"));
    other.clone_from(&good);
    other[last].1 += 4;
    assert!(fails(&other).contains("otherwise"));
    other.clone_from(&good);
    other[last].2 += 4;
    assert!(fails(&other).contains("otherwise"));
    assert!(fails(&good[..last]).contains("more than is pushed"));
    other.clone_from(&good);
    other.push(("more", 64, 4));
    assert!(fails(&other).contains("otherwise"));
    other[last + 1].0 = "padding";
    check(&words, size(&other), &other).unwrap();
    assert!(check(&words, size(&good) + 4, &good).unwrap_err().contains("listed"));
}

//! The layout of push constants in the committed SPIR-V compared with Rust's: called by the tests of `pushed!`.

use super::listed::listed;
use super::spirv::push_members;
use crate::shaders;

/// Checks that a module's push constants are these members, each given by name, offset and size in bytes, of a
/// struct of `size` bytes. The Rust struct may end in padding that no kernel reads, which makes the size a
/// multiple of 8.
///
/// # Errors
/// Describes the difference.
pub(crate) fn check(words: &[u32], size: usize, members: &[(&str, u32, u32)]) -> Result<(), String> {
    let sum: u32 = members.iter().map(|(.., bytes)| bytes).sum();
    if sum as usize != size {
        return Err(format!("the listed members have {sum} bytes, but the struct has {size}"));
    }
    let pushed = push_members(words)?.ok_or("the module has no push constants")?;
    let (read, unread) = members.split_at_checked(pushed.len()).ok_or("the kernel reads more than is pushed")?;
    let same = read.iter().zip(&pushed).all(|(ours, (name, offset, bytes))| *ours == (name.as_str(), *offset, *bytes));
    let fills = |name: &str| name.starts_with("pad") || name == "reserved";
    if !same || !unread.iter().all(|(name, ..)| fills(name)) {
        return Err(format!(
            "push constants are laid out differently in SPIR-V:\n{pushed:?}\nthan in Rust:\n{members:?}"
        ));
    }
    Ok(())
}

/// Every kernel with push constants is checked.
#[test]
fn every_kernel_is_listed() {
    let names = listed("pushed!");
    // The example's kernel belongs to a host, which runs it without this backend.
    for module in
        shaders::KERNELS.iter().chain(&shaders::TEST_KERNELS).filter(|module| !module.name.starts_with("example_"))
    {
        let pushes = push_members(&module.words()).unwrap().is_some();
        assert!(!pushes || names.iter().any(|name| name == module.name), "{} is in no pushed!", module.name);
    }
}

/// A member with another name, offset or size, a missing one and an extra one are detected.
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
    assert!(fails(&other).contains("differently"));
    other.clone_from(&good);
    other[last].1 += 4;
    assert!(fails(&other).contains("differently"));
    other.clone_from(&good);
    other[last].2 += 4;
    assert!(fails(&other).contains("differently"));
    assert!(fails(&good[..last]).contains("more than is pushed"));
    other.clone_from(&good);
    other.push(("more", 64, 4));
    assert!(fails(&other).contains("differently"));
    other[last + 1].0 = "padding";
    check(&words, size(&other), &other).unwrap();
    assert!(check(&words, size(&good) + 4, &good).unwrap_err().contains("listed"));
}

//! The specialization constants in the committed SPIR-V compared with Rust's: called by the tests of `specialized!`.

use super::listed::listed;
use super::spirv::specialization_constants;
use crate::shaders;

/// The id of the workgroup size, which is not named.
const WORKGROUP: u32 = 1;

/// Checks that a module has exactly the constants `set`, each given by id, name and whether its type in Rust is
/// `bool`, and in addition at most the constants named by `unset`.
///
/// # Errors
/// Describes the difference.
pub(crate) fn check(words: &[u32], set: &[(u32, &str, bool)], unset: &[&str]) -> Result<(), String> {
    let found = specialization_constants(words)?;
    for (id, name, is_bool) in set {
        let capitals = name.to_uppercase();
        let Some((_, _, bool_in_glsl)) = found.iter().find(|(known, other, _)| known == id && *other == capitals)
        else {
            return Err(format!("no constant {id} is called {capitals}: {found:?}"));
        };
        if *bool_in_glsl && !is_bool {
            return Err(format!("{capitals} is a bool in GLSL, but not in Rust"));
        }
    }
    for (id, name, _) in found.iter().filter(|(id, ..)| *id != WORKGROUP) {
        let (set, unset) = (set.iter().any(|(known, ..)| known == id), unset.contains(&name.to_lowercase().as_str()));
        if !set && !unset {
            return Err(format!("constant {id}, {name}, is neither set nor listed as default"));
        }
    }
    Ok(())
}

/// Every kernel with constants besides the workgroup size is checked. Kernels over lists of photons that read no
/// photon have an unused `FORMAT` from an included file.
#[test]
fn every_kernel_with_constants_is_listed() {
    let names = listed("specialized!(", ',');
    for module in shaders::KERNELS.iter().chain(&shaders::TEST_KERNELS) {
        let constants = specialization_constants(&module.words()).unwrap();
        let named: Vec<_> = constants.iter().filter(|(id, ..)| *id != WORKGROUP).map(|(_, name, _)| name).collect();
        let known = names.iter().any(|name| name == module.name);
        let unused = module.name.starts_with("index_") && named == ["FORMAT"];
        assert!(known || unused || named.is_empty(), "{} is in no specialized!: {named:?}", module.name);
    }
}

/// A wrong id, name or type, a missing constant and an extra one are detected.
#[test]
fn constants_that_differ_fail() {
    let words = shaders::RAYS_NEAREST.words();
    let good = [(2, "shadow", true), (3, "busy", false), (10, "shared_groups", false)];
    check(&words, &good, &[]).unwrap();
    let fails = |change: fn(&mut [(u32, &str, bool); 3])| {
        let mut other = good;
        change(&mut other);
        check(&words, &other, &[]).unwrap_err()
    };
    assert!(fails(|set| set[1].0 = 4).contains("no constant 4"));
    assert!(fails(|set| (set[0].0, set[1].0) = (3, 2)).contains("no constant 3"));
    assert!(fails(|set| set[1].1 = "idle").contains("IDLE"));
    assert!(fails(|set| set[0].2 = false).contains("bool"));
    assert!(check(&words, &good[..2], &[]).unwrap_err().contains("SHARED_GROUPS"));
    check(&words, &good[..2], &["shared_groups"]).unwrap();
    let more = [good.as_slice(), &[(5, "more", false)]].concat();
    assert!(check(&words, &more, &[]).unwrap_err().contains("MORE"));
    assert!(check(&words[1..], &good, &[]).is_err());
}

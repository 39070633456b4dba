//! The parameters of kernels in the committed SPIR-V compared with Rust's: called by the tests of `parameters!`.

use super::layout::{Listed, compare, members_of};
use super::listed::listed;
use super::spirv::{Member, parameters};
use crate::parameters::{MAX_PUSHED, Parameters};
use crate::shaders;

/// Checks the parameters of all kernels that a struct is for.
pub(crate) fn check_parameters<P: Parameters + Listed>() {
    let members = members_of::<P>();
    for module in P::MODULES {
        let checked = check(&module.words(), &members);
        checked.unwrap_or_else(|message| panic!("{}: {message}", module.name));
    }
}

fn check(words: &[u32], members: &[Member]) -> Result<(), String> {
    let given = parameters(words)?.ok_or("the kernel has no parameters")?;
    let bytes: u32 = members.iter().map(|member| member.shape.1).sum();
    if given.is_by_address != (bytes as usize > MAX_PUSHED) {
        return Err(format!("{bytes} bytes, by address: {}; up to {MAX_PUSHED} are pushed", given.is_by_address));
    }
    compare(members, &given.members).map_err(|message| format!("parameters are {message}"))
}

/// The parameters of every kernel are checked.
#[test]
fn every_kernel_is_listed() {
    let names = listed("parameters! {", '{');
    // The example's kernel belongs to a host, which runs it without this backend.
    for module in
        shaders::KERNELS.iter().chain(&shaders::TEST_KERNELS).filter(|module| !module.name.starts_with("example_"))
    {
        let has_some = parameters(&module.words()).unwrap().is_some();
        assert!(!has_some || names.iter().any(|name| name == module.name), "{} is in no parameters!", module.name);
    }
}

/// Other members are detected, and parameters that are pushed instead of reached by address, or the other way round.
#[test]
fn other_parameters_fail() {
    for (module, is_by_address) in [(&shaders::DEVICE_COPY, false), (&shaders::SORT_SCATTER, true)] {
        let words = module.words();
        let given = parameters(&words).unwrap().unwrap();
        assert_eq!(given.is_by_address, is_by_address);
        check(&words, &given.members).unwrap();
        let mut other = given.members.clone();
        other[1].name = "other".to_owned();
        assert!(check(&words, &other).unwrap_err().contains("differently"));
        let mut other = given.members;
        other[1].shape.1 = if is_by_address { 0 } else { 100 };
        let other = if is_by_address { &other[..2] } else { &other[..] };
        assert!(check(&words, other).unwrap_err().contains("are pushed"));
    }
}

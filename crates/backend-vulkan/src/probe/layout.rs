//! The layout of the records in the committed SPIR-V compared with Rust's.

use std::mem::offset_of;

use bytemuck::Pod;
use photon_core::light_tree::LightNode;
use photon_core::{
    Anisotropy, Camera, ClearcoatNormal, DiffuseTransmission, Element, ErrorMoments, Estimate, Grid, Light, Material,
    MaterialTextures, Medium, PartialTransmission, Photon, PhotonRay, Portal, Primitive, ProjectionTarget, Query,
    SheenLayer, TextureUse,
};

use super::spirv::{Member, Shape, structs};
use crate::{Vulkan, shaders};

/// The layout of a record in Rust: name, size, members.
type Record = (&'static str, usize, Vec<Member>);

/// The shape of a member's type.
pub(crate) trait Shaped {
    const SHAPE: Shape;
}
impl Shaped for u32 {
    const SHAPE: Shape = (false, 4);
}
impl Shaped for f32 {
    const SHAPE: Shape = (true, 4);
}
impl Shaped for u64 {
    const SHAPE: Shape = (false, 8);
}
impl<T: Shaped, const N: usize> Shaped for [T; N] {
    const SHAPE: Shape = (T::SHAPE.0, T::SHAPE.1 * N as u32);
}

fn shape<R, T: Shaped>(_: fn(&R) -> &T) -> Shape {
    T::SHAPE
}

/// A struct that lists its members: declared by `host_struct!` or `parameters!`.
pub(crate) trait Listed: Pod {
    fn members() -> Vec<Member>;
}

/// The member of a struct.
pub(crate) fn member<T: Shaped>(name: &str, offset: usize) -> Member {
    Member { name: name.to_owned(), offset: offset as u32, shape: T::SHAPE }
}

/// Compares the members of a struct of the host with those in a module. The host's may end in padding, which makes its size a
/// multiple of its alignment.
pub(super) fn compare(listed: &[Member], found: &[Member]) -> Result<(), String> {
    let fills = |member: &Member| member.name.starts_with("pad") || member.name == "reserved";
    match listed.split_at_checked(found.len()) {
        Some((read, unread)) if read == found && unread.iter().all(fills) => Ok(()),
        _ => Err(format!("laid out differently in SPIR-V:\n{found:?}\nthan in Rust:\n{listed:?}")),
    }
}

/// The members of a struct, which has no other bytes.
pub(super) fn members_of<T: Listed>() -> Vec<Member> {
    let members = T::members();
    let sum: u32 = members.iter().map(|member| member.shape.1).sum();
    assert_eq!(sum as usize, size_of::<T>(), "bytes between members");
    members
}

/// Checks a struct of the host wherever kernels know it.
pub(crate) fn check_struct<T: Listed>(name: &str) {
    check_members(name, &members_of::<T>());
}

fn check_members(name: &str, members: &[Member]) {
    let mut seen = 0;
    for module in shaders::KERNELS.iter().chain(&shaders::TEST_KERNELS) {
        for (_, found) in structs(&module.words()).unwrap().iter().filter(|(found, _)| found == name) {
            compare(members, found).unwrap_or_else(|message| panic!("{}: {name} is {message}", module.name));
            seen += 1;
        }
    }
    assert!(seen > 0, "no kernel knows {name}");
}

macro_rules! members {
    ($record:ident: $($member:ident)+) => {
        [$(Member {
            name: stringify!($member).to_owned(),
            offset: offset_of!($record, $member) as u32,
            shape: shape(|record: &$record| &record.$member),
        }),+]
    };
}

macro_rules! record {
    ($record:ident: $($member:ident)+) => {
        ($record::GLSL_NAME, size_of::<$record>(), members!($record: $($member)+).to_vec())
    };
}

fn records() -> Vec<Record> {
    vec![
        record!(Photon: position normal power direction),
        record!(PhotonRay: origin path direction light power media),
        record!(Query: position radius normal pixel throughput media offset_or_wo path shading_normal coat),
        record!(Estimate: flux radius_squared photons flags power_sums),
        record!(ErrorMoments: wide power narrow power_squared slope quadrupole stray photons reserved),
        record!(Primitive: normal material),
        record!(Material: albedo kind emission flags medium ior textures metallic roughness specular alpha alpha_cutoff),
        record!(Medium: absorption ior priority dispersion terms scattering anisotropy phase draine),
        record!(Grid: x y z cells first),
        record!(Light: position kind direction primitive power versine_inner versine_outer radius area flags),
        record!(Camera: origin kind forward media right lens_radius up focus_distance),
        record!(TextureUse: transform texture_index uv_set),
        record!(MaterialTextures: base_color emission normal normal_scale metallic_roughness alpha specular specular_color
            specular_color_factor clearcoat_factor
            clearcoat_roughness_factor clearcoat clearcoat_roughness anisotropy),
        record!(Anisotropy: strength direction texture),
        record!(DiffuseTransmission: color factor color_texture factor_texture reserved),
        record!(SheenLayer: color roughness color_texture roughness_texture reserved),
        record!(ClearcoatNormal: is_own texture scale reserved),
        record!(PartialTransmission: factor factor_texture glass reserved),
        record!(LightNode: center radius intensity axis cone next),
    ]
}

/// Checks the layout of all records that a module contains, and returns their number.
fn check(words: &[u32], records: &[Record]) -> Result<usize, String> {
    let mut seen = 0;
    for (name, members) in structs(words)? {
        let Some((_, _, expected)) = records.iter().find(|(known, ..)| *known == name) else { continue };
        if members != *expected {
            return Err(format!("{name} is laid out differently in SPIR-V:\n{members:?}\nthan in Rust:\n{expected:?}"));
        }
        seen += 1;
    }
    Ok(seen)
}

/// Checks every struct with a record's name, in every module.
#[test]
fn records_lie_in_spirv_as_in_rust() {
    let records = records();
    for (name, size, members) in &records {
        // No member was omitted above: records have no padding.
        let sum: u32 = members.iter().map(|member| member.shape.1).sum();
        assert_eq!(sum as usize, *size, "{name}");
    }
    for module in shaders::KERNELS.iter().chain(&shaders::TEST_KERNELS) {
        check(&module.words(), &records).unwrap_or_else(|message| panic!("{}: {message}", module.name));
    }
    assert_eq!(check(&shaders::PROBE_LAYOUT.words(), &records).unwrap(), records.len());
}

/// Tables that are no records of a buffer.
#[test]
fn tables_lie_in_spirv_as_in_rust() {
    check_members("Portal", &members!(Portal: corner edges area));
    check_members("ProjectionTarget", &members!(ProjectionTarget: carried light first count point_bits direction_bits));
}

/// A changed offset, name or type in the module is detected.
#[test]
fn a_doctored_module_fails() {
    let words = shaders::PROBE_LAYOUT.words();
    let records = records();
    let offset_16 = |window: &[u32]| window[0] == (5 << 16 | 72) && window[3] == 35 && window[4] == 16;
    // The last one: the first belongs to the push constants.
    let at = words.windows(5).rposition(offset_16).unwrap();
    let mut doctored = words.clone();
    doctored[at + 4] = 20;
    assert!(check(&doctored, &records).unwrap_err().contains("differently"));

    let text = u32::from_le_bytes(*b"powe");
    let at = words.iter().position(|&word| word == text).unwrap();
    doctored.clone_from(&words);
    doctored[at] = u32::from_le_bytes(*b"towe");
    assert!(check(&doctored, &records).is_err());

    let mut fewer = records.clone();
    fewer[0].2[1].shape.0 = true;
    assert!(check(&words, &fewer).is_err());

    assert!(check(&words[1..], &records).is_err());
    doctored.clone_from(&words);
    doctored.push(9 << 16 | 5);
    assert!(check(&doctored, &records).unwrap_err().contains("9 words"));
}

parameters! {
    struct Push => PROBE_LAYOUT {
        from: u64,
        to: u64,
        count: u32,
        padding: u32,
    }
}

specialized!(layout_constants: LayoutConstants => PROBE_LAYOUT, 2 record: u32);

/// A struct of the host with another member, offset or type, or more or fewer of them, is detected; padding at its end is not.
#[test]
fn a_struct_of_other_members_fails() {
    let words = shaders::STAGES_TRACE.words();
    let (_, found) = structs(&words).unwrap().into_iter().find(|(name, _)| name == "Chunk").unwrap();
    let good = found.clone();
    compare(&good, &found).unwrap();
    let changes: [fn(&mut Vec<Member>); 6] = [
        |members| members[1].name = "endings_".to_owned(),
        |members| members[1].offset += 8,
        |members| members[3].shape.0 = true,
        |members| members[2].shape.1 = 4,
        |members| drop(members.pop()),
        |members| members.push(member::<u32>("more", 44)),
    ];
    for change in changes {
        let mut other = good.clone();
        change(&mut other);
        assert!(compare(&other, &found).unwrap_err().contains("differently"), "{other:?}");
    }
    let mut padded = good;
    padded.push(member::<u32>("pad", 44));
    compare(&padded, &found).unwrap();
}

/// The device copies arrays of each record: every byte is preserved, at the right stride.
#[test]
fn arrays_of_records_are_copied_whole() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    const COUNT: u32 = 100;
    for (number, (name, size, _)) in records().into_iter().enumerate() {
        // Words that are ordinary floats, since NaN bits might be changed.
        let sent: Vec<u32> = (0..COUNT * size as u32 / 4).map(|i| 0x3F00_0000 + i).collect();
        let from = on.memory("from", sent.len() as u64 * 4).unwrap();
        let to = on.memory("to", from.bytes()).unwrap();
        on.write(&from, 0, bytemuck::cast_slice(&sent)).unwrap();
        on.fill_words(&to, 0, to.bytes(), 0).unwrap();
        let kernel = on.kernel(&shaders::PROBE_LAYOUT, 64, &LayoutConstants { record: number as u32 });
        let push = Push { from: from.address(), to: to.address(), count: COUNT, padding: 0 };
        on.dispatch(&kernel, &push, u64::from(COUNT.div_ceil(64))).unwrap();
        let mut arrived = vec![0_u32; sent.len()];
        on.read(&to, 0, bytemuck::cast_slice_mut(&mut arrived)).unwrap();
        assert_eq!(arrived, sent, "{name}");
    }
}

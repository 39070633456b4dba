//! A minimal SPIR-V parser for the memory layout of structs.

use std::collections::BTreeMap;

/// Scalar type and size of a member: `true` for floats, and its size in bytes.
pub(super) type Shape = (bool, u32);

/// A member of a struct in memory.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Member {
    pub(super) name: String,
    pub(super) offset: u32,
    pub(super) shape: Shape,
}

const HEADER: usize = 5;
const OP_NAME: u32 = 5;
const OP_MEMBER_NAME: u32 = 6;
const OP_TYPE_INT: u32 = 21;
const OP_TYPE_FLOAT: u32 = 22;
const OP_TYPE_VECTOR: u32 = 23;
const OP_TYPE_ARRAY: u32 = 28;
const OP_TYPE_STRUCT: u32 = 30;
const OP_TYPE_POINTER: u32 = 32;
const OP_TYPE_FORWARD_POINTER: u32 = 39;
const OP_CONSTANT: u32 = 43;
const OP_SPEC_CONSTANT_TRUE: u32 = 48;
const OP_SPEC_CONSTANT_FALSE: u32 = 49;
const OP_VARIABLE: u32 = 59;
const OP_DECORATE: u32 = 71;
const OP_MEMBER_DECORATE: u32 = 72;
const DECORATION_SPEC_ID: u32 = 1;
const DECORATION_OFFSET: u32 = 35;
const STORAGE_PUSH_CONSTANT: u32 = 9;
const STORAGE_PHYSICAL: u32 = 5349;

/// The instructions of a module: opcode and operands.
///
/// # Errors
/// If the words are not valid SPIR-V.
pub(super) fn instructions(words: &[u32]) -> Result<Vec<(u32, &[u32])>, String> {
    if words.len() < HEADER || words[0] != 0x0723_0203 {
        return Err("not a SPIR-V module".to_owned());
    }
    let mut found = Vec::new();
    let mut rest = &words[HEADER..];
    while let Some(&first) = rest.first() {
        let length = (first >> 16) as usize;
        if length == 0 || length > rest.len() {
            return Err(format!("an instruction of {length} words where {} are left", rest.len()));
        }
        found.push((first & 0xFFFF, &rest[1..length]));
        rest = &rest[length..];
    }
    Ok(found)
}

/// The structs of a module with a memory layout, by name; one name may occur several times.
///
/// # Errors
/// If the words are not valid SPIR-V.
pub(super) fn structs(words: &[u32]) -> Result<Vec<(String, Vec<Member>)>, String> {
    let mut names = BTreeMap::new();
    let mut member_names = BTreeMap::new();
    let mut offsets = BTreeMap::new();
    let mut shapes: BTreeMap<u32, Shape> = BTreeMap::new();
    let mut constants = BTreeMap::new();
    let mut found = Vec::new();
    for (operation, operands) in instructions(words)? {
        // Names and decorations come before types, types before their uses.
        match (operation, operands) {
            (OP_NAME, [id, text @ ..]) => _ = names.insert(*id, string(text)),
            (OP_MEMBER_NAME, [id, member, text @ ..]) => _ = member_names.insert((*id, *member), string(text)),
            (OP_MEMBER_DECORATE, [id, member, DECORATION_OFFSET, offset]) => {
                _ = offsets.insert((*id, *member), *offset)
            }
            (OP_TYPE_INT, [id, bits, _]) => _ = shapes.insert(*id, (false, bits / 8)),
            (OP_TYPE_FLOAT, [id, bits, ..]) => _ = shapes.insert(*id, (true, bits / 8)),
            (OP_CONSTANT, [_, id, value]) => _ = constants.insert(*id, *value),
            (OP_TYPE_VECTOR, [id, of, count]) => {
                if let Some(&(float, bytes)) = shapes.get(of) {
                    shapes.insert(*id, (float, bytes * count));
                }
            }
            (OP_TYPE_ARRAY, [id, of, count]) => {
                if let (Some(&(float, bytes)), Some(count)) = (shapes.get(of), constants.get(count)) {
                    shapes.insert(*id, (float, bytes * count));
                }
            }
            (OP_TYPE_STRUCT, [id, types @ ..]) => {
                // A member that is itself a struct has no shape; it is not needed here.
                let members = types.iter().zip(0..).map(|(of, member)| {
                    Some(Member {
                        name: member_names.get(&(*id, member))?.clone(),
                        offset: *offsets.get(&(*id, member))?,
                        shape: *shapes.get(of)?,
                    })
                });
                if let (Some(members), Some(name)) = (members.collect(), names.get(id)) {
                    found.push((name.clone(), members));
                }
            }
            _ => {}
        }
    }
    Ok(found)
}

/// Name, offset and size in bytes.
pub(super) type PushMember = (String, u32, u32);

/// The push constants of a module: name, offset and size in bytes of each member; `None` if it has none.
///
/// # Errors
/// If the words are not valid SPIR-V, or a member has an unsupported type.
pub(super) fn push_members(words: &[u32]) -> Result<Option<Vec<PushMember>>, String> {
    let mut names = BTreeMap::new();
    let mut offsets = BTreeMap::new();
    let mut bytes = BTreeMap::new();
    let mut constants = BTreeMap::new();
    let mut members = BTreeMap::new();
    let mut pointed = BTreeMap::new();
    let mut block = None;
    for (operation, operands) in instructions(words)? {
        match (operation, operands) {
            (OP_MEMBER_NAME, [id, member, text @ ..]) => _ = names.insert((*id, *member), string(text)),
            (OP_MEMBER_DECORATE, [id, member, DECORATION_OFFSET, offset]) => {
                _ = offsets.insert((*id, *member), *offset);
            }
            (OP_TYPE_INT | OP_TYPE_FLOAT, [id, bits, ..]) => _ = bytes.insert(*id, bits / 8),
            (OP_CONSTANT, [_, id, value]) => _ = constants.insert(*id, *value),
            (OP_TYPE_VECTOR, [id, of, count]) => {
                _ = bytes.get(of).map(|of| of * count).map(|all| bytes.insert(*id, all))
            }
            (OP_TYPE_ARRAY, [id, of, count]) => {
                if let (Some(of), Some(count)) = (bytes.get(of), constants.get(count)) {
                    bytes.insert(*id, of * count);
                }
            }
            // A buffer address, which may be declared before the type it points to.
            (OP_TYPE_FORWARD_POINTER, [id, STORAGE_PHYSICAL]) | (OP_TYPE_POINTER, [id, STORAGE_PHYSICAL, _]) => {
                bytes.insert(*id, 8);
            }
            (OP_TYPE_POINTER, [id, _, to]) => _ = pointed.insert(*id, *to),
            (OP_TYPE_STRUCT, [id, types @ ..]) => _ = members.insert(*id, types.to_vec()),
            (OP_VARIABLE, [of, _, STORAGE_PUSH_CONSTANT, ..]) => block = pointed.get(of).copied(),
            _ => {}
        }
    }
    let Some(block) = block else { return Ok(None) };
    let types = members.remove(&block).ok_or("push constants that are no struct")?;
    let member = |(of, number): (u32, u32)| {
        let name = names.get(&(block, number)).cloned();
        Some((name?, *offsets.get(&(block, number))?, *bytes.get(&of)?))
    };
    let all: Option<Vec<_>> = types.into_iter().zip(0..).map(member).collect();
    all.map(Some).ok_or_else(|| "a push constant of an unknown type".to_owned())
}

/// The specialization constants of a module: id, name, and whether it is a `bool`.
///
/// # Errors
/// If the words are not valid SPIR-V.
pub(super) fn specialization_constants(words: &[u32]) -> Result<Vec<(u32, String, bool)>, String> {
    let mut names = BTreeMap::new();
    let mut ids = BTreeMap::new();
    let mut bools = Vec::new();
    for (operation, operands) in instructions(words)? {
        match (operation, operands) {
            (OP_NAME, [id, text @ ..]) => _ = names.insert(*id, string(text)),
            (OP_DECORATE, [id, DECORATION_SPEC_ID, number]) => _ = ids.insert(*number, *id),
            (OP_SPEC_CONSTANT_TRUE | OP_SPEC_CONSTANT_FALSE, [_, id]) => bools.push(*id),
            _ => {}
        }
    }
    let name = |id| names.get(id).cloned().unwrap_or_default();
    Ok(ids.iter().map(|(number, id)| (*number, name(id), bools.contains(id))).collect())
}

/// A null-terminated string packed in words.
fn string(words: &[u32]) -> String {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).take_while(|&byte| byte != 0).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

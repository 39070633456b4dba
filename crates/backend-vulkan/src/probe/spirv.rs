//! A minimal SPIR-V parser for the memory layout of structs.

use std::collections::BTreeMap;

/// Scalar type and size of a member: `true` for floats, and its size in bytes.
pub(crate) type Shape = (bool, u32);

const ADDRESS: Shape = (false, 8);

/// A member of a struct in memory.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Member {
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

/// The types of a module that matter for the layout of memory, by id.
#[derive(Default)]
struct Types {
    names: BTreeMap<u32, String>,
    member_names: BTreeMap<(u32, u32), String>,
    offsets: BTreeMap<(u32, u32), u32>,
    shapes: BTreeMap<u32, Shape>,
    /// Structs and the types of their members.
    structs: BTreeMap<u32, Vec<u32>>,
    /// Pointers and what they point to.
    pointers: BTreeMap<u32, u32>,
    /// The block of push constants.
    push: Option<u32>,
}

impl Types {
    fn of(words: &[u32]) -> Result<Self, String> {
        let mut types = Self::default();
        let mut constants = BTreeMap::new();
        for (operation, operands) in instructions(words)? {
            // Names and decorations come before types, types before their uses.
            match (operation, operands) {
                (OP_NAME, [id, text @ ..]) => _ = types.names.insert(*id, string(text)),
                (OP_MEMBER_NAME, [id, member, text @ ..]) => {
                    _ = types.member_names.insert((*id, *member), string(text));
                }
                (OP_MEMBER_DECORATE, [id, member, DECORATION_OFFSET, offset]) => {
                    _ = types.offsets.insert((*id, *member), *offset);
                }
                (OP_TYPE_INT, [id, bits, _]) => _ = types.shapes.insert(*id, (false, bits / 8)),
                (OP_TYPE_FLOAT, [id, bits, ..]) => _ = types.shapes.insert(*id, (true, bits / 8)),
                (OP_CONSTANT, [_, id, value]) => _ = constants.insert(*id, *value),
                (OP_TYPE_VECTOR, [id, of, count]) => types.add_many(*id, *of, Some(count)),
                (OP_TYPE_ARRAY, [id, of, count]) => types.add_many(*id, *of, constants.get(count)),
                // An address, which may be declared before the type it points to.
                (OP_TYPE_FORWARD_POINTER, [id, STORAGE_PHYSICAL]) => _ = types.shapes.insert(*id, ADDRESS),
                (OP_TYPE_POINTER, [id, storage, to]) => {
                    types.pointers.insert(*id, *to);
                    if *storage == STORAGE_PHYSICAL {
                        types.shapes.insert(*id, ADDRESS);
                    }
                }
                (OP_TYPE_STRUCT, [id, members @ ..]) => _ = types.structs.insert(*id, members.to_vec()),
                (OP_VARIABLE, [of, _, STORAGE_PUSH_CONSTANT, ..]) => types.push = types.pointers.get(of).copied(),
                _ => {}
            }
        }
        Ok(types)
    }

    fn add_many(&mut self, id: u32, of: u32, count: Option<&u32>) {
        if let (Some(&(float, bytes)), Some(count)) = (self.shapes.get(&of), count) {
            self.shapes.insert(id, (float, bytes * count));
        }
    }

    /// The members of a struct; `None` if one is itself a struct, or has no offset.
    fn members(&self, id: u32) -> Option<Vec<Member>> {
        let types = self.structs.get(&id)?.iter().zip(0..);
        let member = |(of, number)| {
            let name = self.member_names.get(&(id, number))?.clone();
            Some(Member { name, offset: *self.offsets.get(&(id, number))?, shape: *self.shapes.get(of)? })
        };
        types.map(member).collect()
    }
}

/// The structs of a module with a memory layout, by name; one name may occur several times.
///
/// # Errors
/// If the words are not valid SPIR-V.
pub(super) fn structs(words: &[u32]) -> Result<Vec<(String, Vec<Member>)>, String> {
    let types = Types::of(words)?;
    let named = |id: &u32| Some((types.names.get(id)?.clone(), types.members(*id)?));
    Ok(types.structs.keys().filter_map(named).collect())
}

/// The parameters of a kernel.
#[derive(Debug, PartialEq)]
pub(super) struct Given {
    /// Whether they are reached by their address.
    pub(super) is_by_address: bool,
    pub(super) members: Vec<Member>,
}

/// The parameters of a module: its push constants or, if they are only the address of a struct `Parameters`, its members;
/// `None` if it has none.
///
/// # Errors
/// If the words are not valid SPIR-V, or a member has an unsupported type.
pub(super) fn parameters(words: &[u32]) -> Result<Option<Given>, String> {
    let types = Types::of(words)?;
    let Some(block) = types.push else { return Ok(None) };
    let only = match types.structs.get(&block).ok_or("push constants that are no struct")?.as_slice() {
        [only] => types.pointers.get(only).filter(|to| types.names.get(to).is_some_and(|name| name == "Parameters")),
        _ => None,
    };
    let members = types.members(*only.unwrap_or(&block)).ok_or("a parameter of an unknown type")?;
    Ok(Some(Given { is_by_address: only.is_some(), members }))
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

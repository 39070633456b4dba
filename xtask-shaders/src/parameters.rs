//! Decorates the members of blocks of parameters with `NonWritable`, so that drivers may keep what was read from them.
//!
//! In GLSL, the addresses among the members of a `readonly` block cannot be passed to functions.

use crate::instructions::{before_types, instructions};

const NAME: u32 = 5;
const TYPE_STRUCT: u32 = 30;
const MEMBER_DECORATE: u32 = 72;
const NON_WRITABLE: u32 = 24;

/// The module with the decorations, for structs of the name `Parameters`.
pub(crate) fn decorate(words: &[u32]) -> Vec<u32> {
    // Text is padded by zeros to whole words.
    let name = [u32::from_le_bytes(*b"Para"), u32::from_le_bytes(*b"mete"), u32::from_le_bytes(*b"rs\0\0")];
    let mut blocks = Vec::new();
    let mut added = Vec::new();
    for (_, instruction) in instructions(words) {
        match (instruction[0] & 0xFFFF, &instruction[1..]) {
            (NAME, [id, text @ ..]) if text == name => blocks.push(*id),
            (TYPE_STRUCT, [id, members @ ..]) if blocks.contains(id) => {
                let all = 0..members.len() as u32;
                added.extend(all.flat_map(|member| [4 << 16 | MEMBER_DECORATE, *id, member, NON_WRITABLE]));
            }
            _ => {}
        }
    }
    before_types(words, &added)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instructions::{HEADER, op};

    #[test]
    fn only_members_of_parameters_are_decorated() {
        let named = |id: u32, text: &[u8; 12]| {
            let words = text.chunks(4).map(|part| u32::from_le_bytes([part[0], part[1], part[2], part[3]]));
            op(NAME, &[&[id], words.collect::<Vec<_>>().as_slice()].concat())
        };
        let module = |added: Vec<u32>| {
            let names = [named(7, b"Parameters\0\0"), named(8, b"Parameters2\0")].concat();
            let types = [op(21, &[1, 32, 0]), op(TYPE_STRUCT, &[7, 1, 1]), op(TYPE_STRUCT, &[8, 1])].concat();
            [vec![0; HEADER], names, added, types].concat()
        };
        let decorated = |member| op(MEMBER_DECORATE, &[7, member, NON_WRITABLE]);
        assert_eq!(decorate(&module(Vec::new())), module([decorated(0), decorated(1)].concat()));
    }
}

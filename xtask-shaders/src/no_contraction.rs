//! Decorates all arithmetic of a module with `NoContraction`.
//!
//! A driver may otherwise compute `a * b + c` with one rounding, and does so in one specialization of a kernel and not in
//! another: pictures would depend on features that the scene does not have, and differ from those of the CPU.

use std::collections::BTreeSet;

use crate::instructions::{before_types, instructions};

const DECORATE: u32 = 71;
const NO_CONTRACTION: u32 = 42;
/// `OpFNegate`, `OpFAdd`, `OpFSub`, `OpFMul`, `OpFDiv`, `OpFRem`, `OpFMod`, and `OpVectorTimesScalar` to `OpDot`.
const ARITHMETIC: [u32; 14] = [127, 129, 131, 133, 136, 140, 141, 142, 143, 144, 145, 146, 147, 148];

/// The module with the decorations.
pub(crate) fn decorate(words: &[u32]) -> Vec<u32> {
    let mut decorated = BTreeSet::new();
    let mut results = Vec::new();
    for (_, instruction) in instructions(words) {
        let op = instruction[0] & 0xFFFF;
        match instruction {
            [_, id, NO_CONTRACTION] if op == DECORATE => {
                decorated.insert(*id);
            }
            [_, _, result, ..] if ARITHMETIC.contains(&op) => results.push(*result),
            _ => {}
        }
    }
    let missing = results.into_iter().filter(|id| !decorated.contains(id));
    let added: Vec<u32> = missing.flat_map(|id| [3 << 16 | DECORATE, id, NO_CONTRACTION]).collect();
    before_types(words, &added)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instructions::{HEADER, op};

    #[test]
    fn what_is_not_decorated_yet_is_decorated_before_the_types() {
        let decorated = |ids: &[u32]| ids.iter().flat_map(|&id| op(DECORATE, &[id, NO_CONTRACTION])).collect();
        let module = |decorations: Vec<u32>| {
            let float = op(22, &[1, 32]);
            // 2 = a * b, 3 = 2 + c, 4 = an integer sum, 5 = 3 / c
            let body = [op(133, &[1, 2, 8, 9]), op(129, &[1, 3, 2, 7]), op(128, &[6, 4, 8, 9]), op(136, &[1, 5, 3, 7])];
            [vec![0; HEADER], op(DECORATE, &[2, 0]), decorations, float, body.concat()].concat()
        };
        assert_eq!(decorate(&module(Vec::new())), module(decorated(&[2, 3, 5])));
        assert_eq!(decorate(&module(decorated(&[3]))), module(decorated(&[3, 2, 5])));
        let whole = module(decorated(&[2, 3, 5]));
        assert_eq!(decorate(&whole), whole);
    }
}

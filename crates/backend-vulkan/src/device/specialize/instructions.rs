//! Instructions of a SPIR-V module.

/// The opcodes that this module has to know, by their names in the specification.
pub(super) mod op {
    pub(in crate::device::specialize) const NAME: u16 = 5;
    pub(in crate::device::specialize) const ENTRY_POINT: u16 = 15;
    pub(in crate::device::specialize) const TYPE_BOOL: u16 = 20;
    pub(in crate::device::specialize) const TYPE_INT: u16 = 21;
    pub(in crate::device::specialize) const CONSTANT_TRUE: u16 = 41;
    pub(in crate::device::specialize) const CONSTANT_FALSE: u16 = 42;
    pub(in crate::device::specialize) const CONSTANT: u16 = 43;
    pub(in crate::device::specialize) const CONSTANT_COMPOSITE: u16 = 44;
    pub(in crate::device::specialize) const SPEC_CONSTANT_TRUE: u16 = 48;
    pub(in crate::device::specialize) const SPEC_CONSTANT_FALSE: u16 = 49;
    pub(in crate::device::specialize) const SPEC_CONSTANT: u16 = 50;
    pub(in crate::device::specialize) const SPEC_CONSTANT_COMPOSITE: u16 = 51;
    pub(in crate::device::specialize) const SPEC_CONSTANT_OP: u16 = 52;
    pub(in crate::device::specialize) const FUNCTION: u16 = 54;
    pub(in crate::device::specialize) const FUNCTION_END: u16 = 56;
    pub(in crate::device::specialize) const FUNCTION_CALL: u16 = 57;
    pub(in crate::device::specialize) const VARIABLE: u16 = 59;
    pub(in crate::device::specialize) const LOAD: u16 = 61;
    pub(in crate::device::specialize) const ACCESS_CHAIN: u16 = 65;
    pub(in crate::device::specialize) const DECORATE: u16 = 71;
    pub(in crate::device::specialize) const COMPOSITE_EXTRACT: u16 = 81;
    pub(in crate::device::specialize) const COPY_OBJECT: u16 = 83;
    pub(in crate::device::specialize) const PHI: u16 = 245;
    pub(in crate::device::specialize) const LOOP_MERGE: u16 = 246;
    pub(in crate::device::specialize) const SELECTION_MERGE: u16 = 247;
    pub(in crate::device::specialize) const LABEL: u16 = 248;
    pub(in crate::device::specialize) const BRANCH: u16 = 249;
    pub(in crate::device::specialize) const BRANCH_CONDITIONAL: u16 = 250;
    pub(in crate::device::specialize) const SWITCH: u16 = 251;
    pub(in crate::device::specialize) const RETURN_VALUE: u16 = 254;
    pub(in crate::device::specialize) const UNREACHABLE: u16 = 255;
}

/// One instruction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instruction<'a> {
    pub(super) op: u16,
    /// All its words; the first has length and opcode.
    pub(super) words: &'a [u32],
}

/// All instructions of `words`, or nothing if a length is wrong.
pub(super) fn read(mut words: &[u32]) -> Option<Vec<Instruction<'_>>> {
    let mut found = Vec::new();
    while let Some(&first) = words.first() {
        let length = (first >> 16) as usize;
        if length == 0 || length > words.len() {
            return None;
        }
        let (own, others) = words.split_at(length);
        found.push(Instruction { op: (first & 0xFFFF) as u16, words: own });
        words = others;
    }
    Some(found)
}

/// An instruction of `op` and the words after its first.
pub(super) fn make(op: u16, operands: &[u32]) -> Vec<u32> {
    let first = (operands.len() as u32 + 1) << 16 | u32::from(op);
    [&[first], operands].concat()
}

impl Instruction<'_> {
    /// The id that an instruction of a function body defines. Those without one are the stores, copies and atomic
    /// stores, the barriers, and what structures and ends blocks.
    pub(super) fn result(&self) -> Option<u32> {
        match self.op {
            op::LABEL => Some(self.words[1]),
            8 | 56 | 62..=64 | 224 | 225 | 228 | 246 | 247 | 249..=257 | 317 => None,
            _ => self.words.get(2).copied(),
        }
    }

    /// Ends a block.
    pub(super) fn terminates(&self) -> bool {
        matches!(self.op, op::BRANCH..=op::UNREACHABLE)
    }
}

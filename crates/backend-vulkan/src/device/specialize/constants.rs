//! Specialization constants become constants, and what is computed from them too.

use std::collections::{HashMap, HashSet};

use super::instructions::{Instruction, make, op};

const DECORATION_SPEC_ID: u32 = 1;

/// Values that are known when a module is specialised, by id; a bool is 0 or 1.
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    pub(super) scalars: HashMap<u32, u32>,
    composites: HashMap<u32, Vec<u32>>,
    /// The types of such values.
    types: HashSet<u32>,
    /// Constants by type and value.
    constants: HashMap<(u32, u32), u32>,
    /// Values of the functions that always return the same and do nothing else.
    functions: HashMap<u32, u32>,
}

/// What precedes the functions, with the specialization constants `values` (id, value) set, and the known values.
pub(super) fn set(declarations: &[Instruction<'_>], values: &[(u32, u32)]) -> (Vec<Vec<u32>>, Known) {
    let mut known = Known::default();
    let mut spec_ids = HashMap::new();
    let mut bool_type = None;
    let mut done = Vec::new();
    for instruction in declarations {
        let words = instruction.words;
        let value = |id: u32, default: u32| {
            let spec_id = spec_ids.get(&id);
            values.iter().find(|(candidate, _)| Some(candidate) == spec_id).map_or(default, |&(_, value)| value)
        };
        let scalar = match instruction.op {
            op::DECORATE if words[2] == DECORATION_SPEC_ID => {
                spec_ids.insert(words[1], words[3]);
                continue;
            }
            op::TYPE_BOOL => {
                bool_type = Some(words[1]);
                known.types.insert(words[1]);
                None
            }
            op::TYPE_INT if words[2] == 32 => {
                known.types.insert(words[1]);
                None
            }
            op::CONSTANT_TRUE => Some(1),
            op::CONSTANT_FALSE => Some(0),
            op::CONSTANT if words.len() == 4 => Some(words[3]),
            op::SPEC_CONSTANT_TRUE => Some(u32::from(value(words[2], 1) != 0)),
            op::SPEC_CONSTANT_FALSE => Some(u32::from(value(words[2], 0) != 0)),
            op::SPEC_CONSTANT if words.len() == 4 => Some(value(words[2], words[3])),
            op::SPEC_CONSTANT_OP => known.evaluate(words[1], words[3] as u16, &words[4..]),
            op::CONSTANT_COMPOSITE | op::SPEC_CONSTANT_COMPOSITE => {
                known.composites.insert(words[2], words[3..].to_vec());
                done.push(make(op::CONSTANT_COMPOSITE, &words[1..]));
                continue;
            }
            _ => None,
        };
        let Some(scalar) = scalar else {
            done.push(words.to_vec());
            continue;
        };
        known.scalars.insert(words[2], scalar);
        known.constants.entry((words[1], scalar)).or_insert(words[2]);
        done.push(match (bool_type == Some(words[1]), scalar) {
            (true, 0) => make(op::CONSTANT_FALSE, &words[1..3]),
            (true, _) => make(op::CONSTANT_TRUE, &words[1..3]),
            (false, _) => make(op::CONSTANT, &[words[1], words[2], scalar]),
        });
    }
    (done, known)
}

impl Known {
    /// Adds functions that always return the same value; whether one of them was not known.
    pub(super) fn learn(&mut self, functions: impl Iterator<Item = (u32, u32)>) -> bool {
        let before = self.functions.len();
        self.functions.extend(functions);
        self.functions.len() > before
    }

    /// The value of a call, and a constant that has it, if the function always returns that.
    pub(super) fn value_of(&self, call: &Instruction<'_>) -> Option<(u32, u32)> {
        let value = *self.functions.get(&call.words[3])?;
        Some((value, *self.constants.get(&(call.words[1], value))?))
    }

    /// The result, of type `kind`, of the operation `code` on scalars, if it is known.
    pub(super) fn evaluate(&self, kind: u32, code: u16, operands: &[u32]) -> Option<u32> {
        if !self.types.contains(&kind) {
            return None;
        }
        if code == op::COMPOSITE_EXTRACT {
            let &[composite, index] = operands else { return None };
            let part = self.composites.get(&composite)?.get(index as usize)?;
            return self.scalars.get(part).copied();
        }
        let value = |at: usize| operands.get(at).and_then(|id| self.scalars.get(id)).copied();
        // One operand may decide.
        match (code, value(0), value(1)) {
            (166, Some(1), _) | (166, _, Some(1)) => return Some(1), // OpLogicalOr
            (167, Some(0), _) | (167, _, Some(0)) => return Some(0), // OpLogicalAnd
            (168, Some(a), _) => return Some(1 - a),                 // OpLogicalNot
            (200, Some(a), _) => return Some(!a),                    // OpNot
            (169, Some(a), _) => return if a == 1 { value(1) } else { value(2) }, // OpSelect
            _ => {}
        }
        let (a, b) = (value(0)?, value(1)?);
        let (signed_a, signed_b) = (a as i32, b as i32);
        Some(match code {
            128 => a.wrapping_add(b),
            130 => a.wrapping_sub(b),
            132 => a.wrapping_mul(b),
            134 if b != 0 => a / b,
            137 if b != 0 => a % b,
            164 | 170 => u32::from(a == b), // OpLogicalEqual, OpIEqual
            165 | 171 => u32::from(a != b),
            166 => a | b,
            167 => a & b,
            172 => u32::from(a > b),
            173 => u32::from(signed_a > signed_b),
            174 => u32::from(a >= b),
            175 => u32::from(signed_a >= signed_b),
            176 => u32::from(a < b),
            177 => u32::from(signed_a < signed_b),
            178 => u32::from(a <= b),
            179 => u32::from(signed_a <= signed_b),
            194 if b < 32 => a >> b,
            195 if b < 32 => (signed_a >> b) as u32,
            196 if b < 32 => a << b,
            197 => a | b,
            198 => a ^ b,
            199 => a & b,
            _ => return None,
        })
    }
}

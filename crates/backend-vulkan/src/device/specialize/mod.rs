//! SPIR-V with its specialization constants set, and without the code that they exclude.
//!
//! A driver would do the same, but some inline and optimise all functions before they look at the constants:
//! lavapipe compiles what this module returns two to three times as fast. Only instructions are removed, except that
//! a conditional branch becomes an unconditional one, and the call of a function that always returns the same a copy of a
//! constant; the numbers that a kernel computes do not change.
//!
//! Opcodes and their layouts are those of the SPIR-V specification, version 1.5, section 3.

mod branches;
mod constants;
mod instructions;

use std::collections::{BTreeSet, HashSet};

use branches::Function;
use constants::Known;
use instructions::op;

/// Words of the header, before the first instruction.
const HEADER: usize = 5;

/// The module `words` with the specialization constants `values`, pairs of id and value; others have their defaults.
///
/// Words that are not a module of one entry point, with 32-bit constants, are returned as they are.
pub(super) fn specialize(words: &[u32], values: &[(u32, u32)]) -> Vec<u32> {
    attempt(words, values).unwrap_or_else(|| words.to_vec())
}

fn attempt(words: &[u32], values: &[(u32, u32)]) -> Option<Vec<u32>> {
    let all = instructions::read(words.get(HEADER..)?)?;
    let bodies = all.iter().position(|i| i.op == op::FUNCTION)?;
    let (declarations, bodies) = all.split_at(bodies);
    let (declarations, mut known) = constants::set(declarations, values);
    let reduced = |known: &Known| -> Option<Vec<Function>> {
        bodies.split_inclusive(|i| i.op == op::FUNCTION_END).map(|body| Function::of(body, known)).collect()
    };
    let mut functions = reduced(&known)?;
    while known.learn(functions.iter().filter_map(|function| Some((function.id, function.constant?)))) {
        match reduced(&known) {
            Some(fewer) => functions = fewer,
            None => break,
        }
    }
    let entry = declarations.iter().find(|i| i[0] & 0xFFFF == u32::from(op::ENTRY_POINT))?[2];
    let called = called(&functions, entry);
    let (kept, dropped): (Vec<_>, Vec<_>) = functions.into_iter().partition(|function| called.contains(&function.id));
    let mut lost: HashSet<u32> = dropped.iter().flat_map(Function::results).collect();
    lost.extend(kept.iter().flat_map(|function| &function.lost));

    let mut done = words[..HEADER].to_vec();
    for declaration in &declarations {
        let names = [op::NAME, op::DECORATE].iter().any(|&known| declaration[0] & 0xFFFF == u32::from(known));
        if !(names && lost.contains(&declaration[1])) {
            done.extend(declaration);
        }
    }
    done.extend(kept.iter().flat_map(|function| function.kept.iter().flatten()));
    Some(done)
}

/// Functions that are reached from `entry` by calls in the code that remains.
fn called(functions: &[Function], entry: u32) -> BTreeSet<u32> {
    let mut found = BTreeSet::from([entry]);
    let mut open = vec![entry];
    while let Some(id) = open.pop() {
        for &callee in functions.iter().filter(|function| function.id == id).flat_map(|function| &function.calls) {
            if found.insert(callee) {
                open.push(callee);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests;

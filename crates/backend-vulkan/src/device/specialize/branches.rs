//! A function without the blocks that known values exclude.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use super::constants::Known;
use super::instructions::{Instruction, make, op};

/// A function as it remains.
#[derive(Debug)]
pub(super) struct Function {
    pub(super) id: u32,
    pub(super) kept: Vec<Vec<u32>>,
    /// Ids of the functions that it calls.
    pub(super) calls: Vec<u32>,
    /// Ids that the removed instructions defined.
    pub(super) lost: Vec<u32>,
    /// Value that it always returns, if it does nothing else.
    pub(super) constant: Option<u32>,
    results: Vec<u32>,
}

/// Blocks of a function: label and range of instructions, label and terminator included.
struct Blocks<'a> {
    all: Vec<(u32, Range<usize>)>,
    body: &'a [Instruction<'a>],
    by_label: HashMap<u32, usize>,
}

impl Function {
    /// The function `body`, from `OpFunction` to `OpFunctionEnd`; nothing if its structure is not understood.
    pub(super) fn of(body: &[Instruction<'_>], known: &Known) -> Option<Self> {
        let blocks = Blocks::of(body)?;
        let (reached, known) = blocks.reached(known);
        let mut function = Self {
            id: body.first()?.result()?,
            kept: body.iter().take_while(|i| i.op != op::LABEL).map(|i| i.words.to_vec()).collect(),
            calls: Vec::new(),
            lost: Vec::new(),
            constant: blocks.constant(&reached, &known),
            results: body.iter().filter_map(Instruction::result).collect(),
        };
        let edges = blocks.edges(&reached, &known);
        let merges = blocks.merges(&reached, &known);
        for (at, (label, range)) in blocks.all.iter().enumerate() {
            let instructions = &body[range.clone()];
            if !reached[at] {
                // What a merge instruction names must exist, and the target of `continue` must lead to its loop.
                let role = merges.get(label);
                function
                    .lost
                    .extend(instructions[usize::from(role.is_some())..].iter().filter_map(Instruction::result));
                if let Some(role) = role {
                    let end = role.map_or(make(op::UNREACHABLE, &[]), |header| make(op::BRANCH, &[header]));
                    function.kept.extend([make(op::LABEL, &[*label]), end]);
                }
                continue;
            }
            for (place, instruction) in instructions.iter().enumerate() {
                function.kept.extend(match instruction.op {
                    op::PHI => {
                        // A loop whose `continue` is removed would need a value from there.
                        let continues = merges.iter().filter(|(_, role)| **role == Some(*label));
                        if continues.into_iter().any(|(target, _)| !reached[blocks.by_label[target]]) {
                            return None;
                        }
                        let from = |pair: &&[u32]| edges.contains(&(pair[1], *label));
                        let pairs = instruction.words[3..].chunks_exact(2).filter(from).flatten();
                        let operands: Vec<u32> = instruction.words[1..3].iter().chain(pairs).copied().collect();
                        Some(make(op::PHI, &operands))
                    }
                    op::SELECTION_MERGE => {
                        let next = &instructions[place + 1];
                        decided(next, &known).is_none().then(|| instruction.words.to_vec())
                    }
                    op::BRANCH_CONDITIONAL => Some(
                        decided(instruction, &known)
                            .map_or_else(|| instruction.words.to_vec(), |target| make(op::BRANCH, &[target])),
                    ),
                    op::FUNCTION_CALL => Some(match known.value_of(instruction) {
                        Some((_, constant)) => make(op::COPY_OBJECT, &[&instruction.words[1..3], &[constant]].concat()),
                        None => {
                            function.calls.push(instruction.words[3]);
                            instruction.words.to_vec()
                        }
                    }),
                    _ => Some(instruction.words.to_vec()),
                });
            }
        }
        function.kept.push(make(op::FUNCTION_END, &[]));
        Some(function)
    }

    /// The ids that the function defined before anything was removed.
    pub(super) fn results(&self) -> impl Iterator<Item = u32> {
        self.results.iter().copied()
    }
}

/// Where a conditional branch leads if its condition is known.
fn decided(branch: &Instruction<'_>, known: &Known) -> Option<u32> {
    if branch.op != op::BRANCH_CONDITIONAL {
        return None;
    }
    let condition = known.scalars.get(&branch.words[1])?;
    Some(branch.words[if *condition == 0 { 3 } else { 2 }])
}

impl<'a> Blocks<'a> {
    fn of(body: &'a [Instruction<'a>]) -> Option<Self> {
        let mut all = Vec::new();
        let mut from = body.iter().position(|i| i.op == op::LABEL)?;
        while body.get(from)?.op == op::LABEL {
            let end = from + body[from..].iter().position(Instruction::terminates)? + 1;
            all.push((body[from].words[1], from..end));
            from = end;
        }
        let by_label = all.iter().enumerate().map(|(at, (label, _))| (*label, at)).collect();
        (body[from].op == op::FUNCTION_END).then_some(Self { all, body, by_label })
    }

    /// Labels that a block branches to.
    fn targets(&self, at: usize, known: &Known) -> Vec<u32> {
        let end = &self.body[self.all[at].1.end - 1];
        if let Some(target) = decided(end, known) {
            return vec![target];
        }
        match end.op {
            op::BRANCH => vec![end.words[1]],
            op::BRANCH_CONDITIONAL => end.words[2..4].to_vec(),
            // The default, then pairs of a literal and a label.
            op::SWITCH => end.words[2..].iter().copied().step_by(2).collect(),
            _ => Vec::new(),
        }
    }

    /// Pairs of labels: every branch of a reached block.
    fn edges(&self, reached: &[bool], known: &Known) -> HashSet<(u32, u32)> {
        let sources = (0..self.all.len()).filter(|&at| reached[at]);
        sources.flat_map(|at| self.targets(at, known).into_iter().map(move |to| (self.all[at].0, to))).collect()
    }

    /// The blocks that can be reached, and the values known there. Starts from all of them and removes what cannot
    /// be, so that every state on the way is true of the function.
    fn reached(&self, global: &Known) -> (Vec<bool>, Known) {
        let mut reached = vec![true; self.all.len()];
        let mut known = global.clone();
        loop {
            let edges = self.edges(&reached, &known);
            for (label, range) in self.all.iter().zip(&reached).filter(|(_, reached)| **reached).map(|(block, _)| block)
            {
                for instruction in &self.body[range.clone()] {
                    let value = match instruction.op {
                        op::PHI => {
                            let mut values = instruction.words[3..]
                                .chunks_exact(2)
                                .filter(|pair| edges.contains(&(pair[1], *label)))
                                .map(|pair| known.scalars.get(&pair[0]).copied());
                            let first = values.next().flatten();
                            first.filter(|first| values.all(|value| value == Some(*first)))
                        }
                        op::FUNCTION_CALL => known.value_of(instruction).map(|(value, _)| value),
                        128..=200 => known.evaluate(instruction.words[1], instruction.op, &instruction.words[3..]),
                        _ => None,
                    };
                    if let (Some(value), Some(id)) = (value, instruction.result()) {
                        known.scalars.insert(id, value);
                    }
                }
            }
            let mut now = vec![false; self.all.len()];
            let mut open = vec![0];
            while let Some(at) = open.pop() {
                if !std::mem::replace(&mut now[at], true) {
                    open.extend(self.targets(at, &known).iter().filter_map(|label| self.by_label.get(label)));
                }
            }
            if now == reached {
                return (reached, known);
            }
            reached = now;
        }
    }

    /// The value that the blocks that are reached always return, if they do nothing else and end.
    fn constant(&self, reached: &[bool], known: &Known) -> Option<u32> {
        let ranges = self.all.iter().zip(reached).filter(|(_, reached)| **reached).map(|((_, range), _)| range.clone());
        let mut returned = None;
        for instruction in ranges.flat_map(|range| &self.body[range]) {
            match instruction.op {
                op::RETURN_VALUE => {
                    let value = *known.scalars.get(&instruction.words[1])?;
                    if *returned.get_or_insert(value) != value {
                        return None;
                    }
                }
                op::FUNCTION_CALL if known.value_of(instruction).is_some() => {}
                // Conversions, arithmetic, comparisons, reads, and branches without loops.
                op::VARIABLE | op::LOAD | op::ACCESS_CHAIN | op::COMPOSITE_EXTRACT | op::COPY_OBJECT | 109..=205 => {}
                op::PHI | op::SELECTION_MERGE | op::LABEL | op::BRANCH | op::BRANCH_CONDITIONAL | op::UNREACHABLE => {}
                _ => return None,
            }
        }
        returned
    }

    /// Labels that the remaining merge instructions name: with the header of its loop for the target of `continue`.
    fn merges(&self, reached: &[bool], known: &Known) -> HashMap<u32, Option<u32>> {
        let mut found = HashMap::new();
        for ((label, range), _) in self.all.iter().zip(reached).filter(|(_, reached)| **reached) {
            let end = &self.body[range.end - 1];
            let Some(merge) = range.len().checked_sub(2).map(|before| &self.body[range.start + before]) else {
                continue;
            };
            match merge.op {
                op::LOOP_MERGE => {
                    found.insert(merge.words[1], None);
                    found.insert(merge.words[2], Some(*label));
                }
                op::SELECTION_MERGE if decided(end, known).is_none() => {
                    found.insert(merge.words[1], None);
                }
                _ => {}
            }
        }
        found
    }
}

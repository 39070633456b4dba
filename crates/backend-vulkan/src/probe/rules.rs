//! Rules for every committed module, so that it runs on every device that meets the baseline.

use super::spirv::instructions;
use crate::shaders;

const OP_CAPABILITY: u32 = 17;
const OP_DECORATE: u32 = 71;
const DECORATION_SPEC_ID: u32 = 1;

/// Capabilities that a module may declare; `device/choose.rs` rejects devices without them.
const CAPABILITIES: [(u32, &str); 9] = [
    (1, "Shader"),
    (11, "Int64"),
    (61, "GroupNonUniform"),
    (62, "GroupNonUniformVote"),
    (63, "GroupNonUniformArithmetic"),
    (64, "GroupNonUniformBallot"),
    (65, "GroupNonUniformShuffle"),
    (66, "GroupNonUniformShuffleRelative"),
    (5347, "PhysicalStorageBufferAddresses"),
];

/// Returns the first rule that a module violates.
fn check(words: &[u32]) -> Result<(), String> {
    let instructions = instructions(words)?;
    for (operation, operands) in &instructions {
        if *operation == OP_CAPABILITY && !CAPABILITIES.iter().any(|(number, _)| operands == &[*number]) {
            return Err(format!("declares capability {operands:?}, which is not in the baseline"));
        }
    }
    let sized = |(operation, operands): &(u32, &[u32])| {
        *operation == OP_DECORATE && operands.get(1..) == Some(&[DECORATION_SPEC_ID, 1])
    };
    if !instructions.iter().any(sized) {
        return Err("its workgroup size is not specialization constant 1".to_owned());
    }
    Ok(())
}

#[test]
fn every_module_keeps_the_rules() {
    // The example's kernel belongs to a host, which runs it without this backend.
    for module in
        shaders::KERNELS.iter().chain(&shaders::TEST_KERNELS).filter(|module| !module.name.starts_with("example_"))
    {
        check(&module.words()).unwrap_or_else(|message| panic!("{}: {message}", module.name));
    }
}

#[test]
fn modules_that_break_them_are_found() {
    let good = shaders::DEVICE_COPY.words();
    // Insert Float64 between the header and the rest.
    let mut doubles = good.clone();
    doubles.splice(5..5, [2 << 16 | OP_CAPABILITY, 10]);
    assert!(check(&doubles).unwrap_err().contains("[10]"));
    let mut fixed = good.clone();
    let at =
        good.windows(4).position(|w| w[0] == (4 << 16 | OP_DECORATE) && w[2..] == [DECORATION_SPEC_ID, 1]).unwrap();
    fixed[at + 3] = 3;
    assert!(check(&fixed).unwrap_err().contains("workgroup"));
}

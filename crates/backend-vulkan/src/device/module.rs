//! Compiled shaders as embedded in the program, and as passed to a device.

/// The SPIR-V of one kernel.
#[derive(Debug)]
pub(crate) struct Module {
    /// Folder and stem of its source file, joined by `_`.
    pub(crate) name: &'static str,
    /// SPIR-V as little-endian words.
    pub(crate) bytes: &'static [u8],
}

/// Words of the SPIR-V header, before the first instruction.
const HEADER: usize = 5;
const OP_ENTRY_POINT: u32 = 15;
const OP_EXECUTION_MODE: u32 = 16;
const OP_CAPABILITY: u32 = 17;
const CAPABILITY_DENORM_PRESERVE: u32 = 4464;
const MODE_DENORM_PRESERVE: u32 = 4459;

impl Module {
    /// The module as words.
    pub(crate) fn words(&self) -> Vec<u32> {
        let word = |chunk: &[u8]| u32::from_le_bytes([chunk[0], chunk[1], chunk[2], chunk[3]]);
        self.bytes.chunks_exact(4).map(word).collect()
    }

    /// The words for a device that supports preserving 32-bit denormals: the committed module with the request
    /// for it added, which would be an error on a device without that support.
    pub(crate) fn words_that_keep_denormals(&self) -> Vec<u32> {
        let mut words = self.words();
        let mut at = HEADER;
        while let Some(&first) = words.get(at) {
            let length = (first >> 16) as usize;
            if first & 0xFFFF == OP_ENTRY_POINT && length >= 3 {
                // Execution modes follow the entry points, of which a kernel has one.
                let main = words[at + 2];
                let mode = [4 << 16 | OP_EXECUTION_MODE, main, MODE_DENORM_PRESERVE, 32];
                words.splice(at + length..at + length, mode);
                // Capabilities come first.
                words.splice(HEADER..HEADER, [2 << 16 | OP_CAPABILITY, CAPABILITY_DENORM_PRESERVE]);
                break;
            }
            at += length.max(1);
        }
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shaders;

    /// Instructions of a module, with the header words.
    fn instructions(words: &[u32]) -> Vec<Vec<u32>> {
        let mut found = Vec::new();
        let mut rest = &words[HEADER..];
        while let Some(&first) = rest.first() {
            let (instruction, others) = rest.split_at((first >> 16) as usize);
            found.push(instruction.to_vec());
            rest = others;
        }
        found
    }

    /// Only the request is added, at the position that SPIR-V requires.
    #[test]
    fn the_request_to_keep_denormals_is_all_that_is_added() {
        for module in shaders::KERNELS.iter().chain(&shaders::TEST_KERNELS) {
            let plain = module.words();
            // Part of core SPIR-V, without an extension, since version 1.4.
            assert!(plain[1] >= 0x0001_0400, "{}", module.name);
            let asking = module.words_that_keep_denormals();
            assert_eq!(plain[..HEADER], asking[..HEADER]);
            let (mut before, after) = (instructions(&plain), instructions(&asking));
            let entry = before.iter().position(|i| i[0] & 0xFFFF == OP_ENTRY_POINT).unwrap();
            let main = before[entry][2];
            before.insert(entry + 1, vec![4 << 16 | OP_EXECUTION_MODE, main, MODE_DENORM_PRESERVE, 32]);
            before.insert(0, vec![2 << 16 | OP_CAPABILITY, CAPABILITY_DENORM_PRESERVE]);
            assert!(before == after, "{}", module.name);
        }
    }
}

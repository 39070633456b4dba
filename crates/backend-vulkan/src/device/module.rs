//! Compiled shaders as they lie in the program, and as a device gets them.

/// The SPIR-V of one kernel.
#[derive(Debug)]
pub(crate) struct Module {
    /// Folder and stem of its source, joined by `_`.
    pub(crate) name: &'static str,
    /// Little-endian words.
    pub(crate) bytes: &'static [u8],
}

/// Words before the first instruction.
const HEADER: usize = 5;
const OP_ENTRY_POINT: u32 = 15;
const OP_EXECUTION_MODE: u32 = 16;
const OP_CAPABILITY: u32 = 17;
const CAPABILITY_DENORM_PRESERVE: u32 = 4464;
const MODE_DENORM_PRESERVE: u32 = 4459;

impl Module {
    /// The words.
    pub(crate) fn words(&self) -> Vec<u32> {
        let word = |chunk: &[u8]| u32::from_le_bytes([chunk[0], chunk[1], chunk[2], chunk[3]]);
        self.bytes.chunks_exact(4).map(word).collect()
    }

    /// The words for a device that keeps 32-bit floats below the normal range where it is asked to: the committed
    /// module and that request, which is an error on a device that does not offer it.
    pub(crate) fn words_that_keep_denormals(&self) -> Vec<u32> {
        let mut words = self.words();
        let mut at = HEADER;
        while let Some(&first) = words.get(at) {
            let length = (first >> 16) as usize;
            if first & 0xFFFF == OP_ENTRY_POINT && length >= 3 {
                // Execution modes come right after the entry points, of which a kernel has one.
                let main = words[at + 2];
                let mode = [4 << 16 | OP_EXECUTION_MODE, main, MODE_DENORM_PRESERVE, 32];
                words.splice(at + length..at + length, mode);
                // And capabilities first of all.
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

    /// Instructions of a module, first words included.
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

    /// Nothing but the request is added, and it stands where SPIR-V wants it.
    #[test]
    fn the_request_to_keep_denormals_is_all_that_is_added() {
        for module in shaders::ALL {
            let plain = module.words();
            // Part of the core, without an extension, since SPIR-V 1.4.
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

//! Compiled shaders as they lie in the program.

/// The SPIR-V of one kernel.
#[derive(Debug)]
pub(crate) struct Module {
    /// Folder and stem of its source, joined by `_`.
    pub(crate) name: &'static str,
    /// Little-endian words.
    pub(crate) bytes: &'static [u8],
}

impl Module {
    /// The words.
    pub(crate) fn words(&self) -> Vec<u32> {
        let word = |chunk: &[u8]| u32::from_le_bytes([chunk[0], chunk[1], chunk[2], chunk[3]]);
        self.bytes.chunks_exact(4).map(word).collect()
    }
}

//! The memory that loading may take.

use std::cell::Cell;
use std::path::Path;

use crate::error::SceneError;

/// Options of [`crate::load_builder_with`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadOptions {
    /// Limit in bytes on what loading holds at any time; `None`, the default: no limit other than the fixed ones.
    ///
    /// It counts scene files and buffers while they are read, the vertices, triangles and texels that the
    /// [`crate::SceneBuilder`] keeps, and the largest image while it is decoded. It does not count the
    /// descriptions of materials and nodes, a few kB each, nor the tables that [`crate::SceneBuilder::build`] makes.
    ///
    /// Sizes are known from headers before anything is decoded. Textures that do not fit are reduced: the largest are
    /// halved until all fit, down to 64 texels on the shorter side, and the report says which. If that is not enough,
    /// the error is [`SceneError::Memory`]. Images without a header in their first 16 MiB are left out.
    pub memory: Option<u64>,
}

impl LoadOptions {
    /// The same with this limit on memory, in bytes.
    #[must_use]
    pub fn with_memory(self, bytes: Option<u64>) -> Self {
        Self { memory: bytes }
    }
}

/// What is left of [`LoadOptions::memory`].
#[derive(Debug)]
pub(crate) struct Budget {
    limit: Option<u64>,
    taken: Cell<u64>,
}

impl Budget {
    pub(crate) fn new(options: &LoadOptions) -> Self {
        Self { limit: options.memory, taken: Cell::new(0) }
    }

    /// Without a limit.
    pub(crate) fn unlimited() -> Self {
        Self::new(&LoadOptions::default())
    }

    /// Bytes that are left, if there is a limit.
    pub(crate) fn left(&self) -> Option<u64> {
        self.limit.map(|limit| limit.saturating_sub(self.taken.get()))
    }

    /// Checks that `object` may take that many bytes, to be called before it does.
    pub(crate) fn check(&self, bytes: u64, object: impl FnOnce() -> String) -> Result<(), Shortage> {
        match self.left() {
            Some(left) if bytes > left => Err(self.shortage(object(), bytes)),
            _ => Ok(()),
        }
    }

    /// As [`Self::check`], and it goes on taking them.
    pub(crate) fn take(&self, bytes: u64, object: impl FnOnce() -> String) -> Result<(), Shortage> {
        self.check(bytes, object)?;
        self.taken.set(self.taken.get().saturating_add(bytes));
        Ok(())
    }

    /// `object` needs more bytes than are left.
    pub(crate) fn shortage(&self, object: String, needed: u64) -> Shortage {
        let limit = self.limit.unwrap_or(u64::MAX);
        Shortage { object, needed, left: self.left().unwrap_or(u64::MAX), limit }
    }
}

/// An object that needs more memory than is left.
#[derive(Debug)]
pub(crate) struct Shortage {
    object: String,
    needed: u64,
    left: u64,
    limit: u64,
}

impl Shortage {
    /// The error of the file at `path`.
    pub(crate) fn in_file(self, path: &Path) -> SceneError {
        let Self { object, needed, left, limit } = self;
        SceneError::Memory { path: path.to_owned(), object, needed, left, limit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_is_no_longer_left() {
        let budget = Budget::new(&LoadOptions::default().with_memory(Some(100)));
        assert!(budget.take(60, || unreachable!()).is_ok());
        assert!(budget.check(40, || unreachable!()).is_ok());
        let error = budget.check(41, || "mesh 'a'".to_owned()).unwrap_err().in_file(Path::new("b.gltf"));
        let text = error.to_string();
        assert!(
            text.starts_with("b.gltf: mesh 'a' needs 41 bytes of memory, but 40 bytes are left of the 100"),
            "{text}"
        );
        assert!(Budget::unlimited().take(u64::MAX, || unreachable!()).is_ok());
    }
}

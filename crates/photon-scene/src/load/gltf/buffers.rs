//! The binary data of a file: buffers, read on first use, and views into them.

use std::borrow::Cow;
use std::cell::{Cell, OnceCell};
use std::collections::BTreeSet;
use std::path::Path;

use gltf::json::Root;
use photon_core::FileKind;

use super::fault::{AGAIN, COPY_AGAIN, Fault, label};
use super::meshopt::Compressed;
use super::uri;
use crate::load::budget::Budget;
use crate::report::LoadReport;

/// The buffers of a file.
pub(super) struct Buffers<'a> {
    root: &'a Root,
    folder: &'a Path,
    bin: Option<&'a [u8]>,
    loaded: Vec<OnceCell<Cow<'a, [u8]>>>,
    /// The compressed views that were read.
    decoded: Vec<OnceCell<Vec<u8>>>,
    /// Their length in bytes.
    decoded_length: Cell<u64>,
    budget: &'a Budget,
}

/// More decoded bytes than this are treated as damage: a few views of the same compressed bytes could otherwise request
/// all available memory.
const MAX_DECODED: u64 = 1 << 32;

impl<'a> Buffers<'a> {
    /// The buffers of `root`, whose files are in `folder` and whose GLB chunk is `bin`.
    pub(super) fn new(root: &'a Root, folder: &'a Path, bin: Option<&'a [u8]>, budget: &'a Budget) -> Self {
        let loaded = root.buffers.iter().map(|_| OnceCell::new()).collect();
        let decoded = root.buffer_views.iter().map(|_| OnceCell::new()).collect();
        Self { root, folder, bin, loaded, decoded, decoded_length: Cell::new(0), budget }
    }

    /// What is left of the memory.
    pub(super) fn budget(&self) -> &'a Budget {
        self.budget
    }

    /// The folder of the scene's files.
    pub(super) fn folder(&self) -> &'a Path {
        self.folder
    }

    /// Bytes that reading all buffers that views refer to would still take, and decoding compressed views.
    pub(super) fn unread(&self) -> u64 {
        let mut needed = vec![false; self.loaded.len()];
        let mut decoded = 0_u64;
        for (view, known) in self.root.buffer_views.iter().zip(&self.decoded) {
            let compressed = Compressed::of(view, "").ok().flatten();
            if let Some(compressed) = compressed.as_ref().filter(|_| known.get().is_none()) {
                decoded = decoded.saturating_add(compressed.decoded_length());
            }
            let buffer = compressed.map_or(view.buffer.value(), |compressed| compressed.buffer);
            if let Some(needed) = needed.get_mut(buffer) {
                *needed = true;
            }
        }
        let missing = self.root.buffers.iter().zip(needed).zip(&self.loaded);
        let missing = missing.filter(|((_, needed), loaded)| *needed && loaded.get().is_none());
        let length = |uri| uri::length(uri, self.folder).unwrap_or(0);
        missing.filter_map(|((buffer, _), _)| buffer.uri.as_deref().map(length)).fold(decoded, u64::saturating_add)
    }

    /// Bytes of the document, and of the buffers in files beside it.
    pub(super) fn file_bytes(&self, document: u64) -> u64 {
        let uris = self.root.buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
        let files: BTreeSet<&str> = uris.filter(|uri| uri::data_of(uri).is_none()).collect();
        files.iter().map(|uri| uri::length(uri, self.folder).unwrap_or(0)).fold(document, u64::saturating_add)
    }

    /// Reports files that are found although their URIs have backslashes, which a URI has not.
    pub(super) fn report_backslashes(&self, report: &mut LoadReport) {
        let buffers = self.root.buffers.iter().map(|buffer| buffer.uri.as_deref());
        let uris = buffers.chain(self.root.images.iter().map(|image| image.uri.as_deref())).flatten();
        for uri in uris.filter(|uri| uri::has_backslashes(uri, self.folder)) {
            report.note(format!("the file {uri}"), "is named with backslashes, which are read as slashes");
        }
    }

    /// The bytes of a buffer view; `user` is named in errors.
    pub(super) fn view(&self, index: usize, user: &str) -> Result<&[u8], Fault> {
        let views = &self.root.buffer_views;
        let view = views.get(index).ok_or_else(|| Fault::dangling(user, "buffer view", index, views.len()))?;
        let part = label("buffer view", index, view.name.as_deref());
        if let Some(bytes) = self.decoded[index].get() {
            return Ok(bytes);
        }
        if let Some(compressed) = Compressed::of(view, &part)? {
            let bytes = self.decode(&compressed, &part)?;
            return Ok(self.decoded[index].get_or_init(|| bytes));
        }
        self.range(view.buffer.value(), view.byte_offset.map_or(0, |offset| offset.0), view.byte_length.0, &part)
    }

    /// The bytes of a compressed view.
    fn decode(&self, compressed: &Compressed, part: &str) -> Result<Vec<u8>, Fault> {
        let length = self.decoded_length.get().saturating_add(compressed.decoded_length());
        if length > MAX_DECODED {
            let why = format!("brings the decoded buffer views to over {MAX_DECODED} bytes");
            return Err(Fault::new(part, why, "split the scene"));
        }
        self.budget.take(compressed.decoded_length(), || part.to_owned())?;
        self.decoded_length.set(length);
        let bytes = self.range(compressed.buffer, compressed.offset, compressed.length, part)?;
        compressed.decode(bytes).map_err(|why| Fault::new(part, format!("is no valid stream: {why}"), AGAIN))
    }

    /// Bytes of a buffer; `part` is named in errors.
    fn range(&self, index: usize, offset: u64, length: u64, part: &str) -> Result<&[u8], Fault> {
        let buffer = self.buffer(index, part)?;
        let end = offset.checked_add(length);
        let bytes = end
            .and_then(|end| usize::try_from(end).ok())
            .and_then(|end| buffer.get(usize::try_from(offset).ok()?..end));
        bytes.ok_or_else(|| {
            let has = buffer.len();
            let why = format!("takes {length} bytes from byte {offset} of buffer {index}, which has {has}");
            Fault::new(part, why, AGAIN)
        })
    }

    fn buffer(&self, index: usize, user: &str) -> Result<&[u8], Fault> {
        let dangling = || Fault::dangling(user, "buffer", index, self.loaded.len());
        let cell = self.loaded.get(index).ok_or_else(dangling)?;
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let bytes = self.load(index)?;
        Ok(cell.get_or_init(|| bytes))
    }

    fn load(&self, index: usize) -> Result<Cow<'a, [u8]>, Fault> {
        let buffer = &self.root.buffers[index];
        let part = label("buffer", index, buffer.name.as_deref());
        let bytes = match (&buffer.uri, self.bin) {
            (Some(uri), _) => {
                let wrong = |(why, hint)| Fault::new(&part, why, hint);
                self.budget.take(uri::length(uri, self.folder).map_err(wrong)?, || part.clone())?;
                Cow::Owned(uri::read(uri, self.folder).map_err(wrong)?)
            }
            (None, Some(bin)) if index == 0 => Cow::Borrowed(bin),
            (None, _) => {
                return Err(Fault::new(
                    part,
                    "has no URI, and there is no GLB chunk for it",
                    "export the file again, without compression",
                ));
            }
        };
        let needed = buffer.byte_length.0;
        if (bytes.len() as u64) < needed {
            if let Some(kind) = FileKind::of(&bytes).filter(|kind| kind.extension.is_none()) {
                let uri = buffer.uri.as_deref().unwrap_or_default();
                return Err(Fault::new(part, format!("is in the file {uri}, which is {}", kind.name), kind.remedy));
            }
            let place = match buffer.uri.as_deref() {
                Some(uri) if uri::data_of(uri).is_none() => format!("the file {uri}"),
                Some(_) => "its data URI".to_owned(),
                None => "the GLB chunk".to_owned(),
            };
            return Err(Fault::new(part, format!("needs {needed} bytes, but {place} has {}", bytes.len()), COPY_AGAIN));
        }
        Ok(bytes)
    }
}

//! Reads numbers from buffers; every read is bounds-checked.

use std::cell::Cell;

use gltf::json::Root;
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;

use super::buffers::Buffers;
use super::fault::{AGAIN, Fault, label};

/// An accessor without data stands for zeros; more elements than this, over all of its uses, are treated as damage, since a
/// few bytes of JSON could otherwise request all available memory.
const MAX_ZEROS: u64 = 1 << 22;

/// Reads the accessors of a file.
pub(super) struct Accessors<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    /// Elements without data that were read.
    zeros: Cell<u64>,
}

/// Layout of the elements of an accessor in its bytes.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: ComponentType,
    normalized: bool,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        Self { root, buffers, zeros: Cell::new(0) }
    }

    /// Number of elements, without reading them.
    pub(super) fn count(&self, index: usize, user: &str) -> Result<u64, Fault> {
        Ok(self.find(index, user)?.count.0)
    }

    /// Reads vectors of three numbers, of any component type; `user` is named in errors.
    pub(super) fn vectors(&self, index: usize, user: &str) -> Result<Vec<[f64; 3]>, Fault> {
        self.read(index, user, Type::Vec3, &[], [0.0; 3], |elements, at| {
            std::array::from_fn(|axis| elements.number(at, axis))
        })
    }

    /// Reads vectors of one of several lengths, at most `N`; components beyond are those of `rest`.
    pub(super) fn tuples<const N: usize>(
        &self,
        index: usize,
        shapes: &[Type],
        rest: [f64; N],
        user: &str,
    ) -> Result<Vec<[f64; N]>, Fault> {
        let found = match self.find(index, user)?.type_ {
            Checked::Valid(found) if shapes.contains(&found) => found,
            _ => shapes[0],
        };
        let length = found.multiplicity();
        let take = |elements: &Elements<'_>, at: usize| {
            std::array::from_fn(|axis| if axis < length { elements.number(at, axis) } else { rest[axis] })
        };
        // An accessor without data stands for zeros.
        let zeros = std::array::from_fn(|axis| if axis < length { 0.0 } else { rest[axis] });
        self.read(index, user, found, &[], zeros, take)
    }

    /// Reads vertex indices, of any unsigned type; `user` is named in errors.
    pub(super) fn indices(&self, index: usize, user: &str) -> Result<Vec<u32>, Fault> {
        let unsigned = [ComponentType::U8, ComponentType::U16, ComponentType::U32];
        self.read(index, user, Type::Scalar, &unsigned, 0, |elements, at| elements.unsigned(at, 0))
    }

    /// Reads groups of four unsigned integers, as joint numbers are; `user` is named in errors.
    pub(super) fn joints(&self, index: usize, user: &str) -> Result<Vec<[u32; 4]>, Fault> {
        let unsigned = [ComponentType::U8, ComponentType::U16, ComponentType::U32];
        self.read(index, user, Type::Vec4, &unsigned, [0; 4], |elements, at| {
            std::array::from_fn(|axis| elements.unsigned(at, axis))
        })
    }

    /// Reads a whole buffer view as vectors of 64-bit floats, which glTF accessors cannot describe.
    pub(super) fn doubles<const N: usize>(&self, view: usize, user: &str) -> Result<Vec<[f64; N]>, Fault> {
        let number = |bytes: &[u8], axis: usize| f64::from_le_bytes(std::array::from_fn(|byte| bytes[8 * axis + byte]));
        let bytes = self.buffers.view(view, user)?;
        Ok(bytes.chunks_exact(8 * N).map(|vertex| std::array::from_fn(|axis| number(vertex, axis))).collect())
    }

    fn find(&self, index: usize, user: &str) -> Result<&'a Accessor, Fault> {
        let accessors = &self.root.accessors;
        accessors.get(index).ok_or_else(|| Fault::dangling(user, "accessor", index, accessors.len()))
    }

    /// Reads all elements with `take`; an empty `allowed` admits every component type. `zero` is the element of an
    /// accessor without data.
    fn read<T: Copy>(
        &self,
        index: usize,
        user: &str,
        shape: Type,
        allowed: &[ComponentType],
        zero: T,
        take: impl Fn(&Elements<'_>, usize) -> T,
    ) -> Result<Vec<T>, Fault> {
        let accessor = self.find(index, user)?;
        let part = label("accessor", index, accessor.name.as_deref());
        let wrong = |why: String| Fault::new(&part, why, AGAIN);
        let component = match accessor.component_type {
            Checked::Valid(component) if allowed.is_empty() || allowed.contains(&component.0) => component.0,
            _ => {
                return Err(wrong(format!("has a component type that {user} cannot use")));
            }
        };
        match accessor.type_ {
            Checked::Valid(found) if found == shape => {}
            _ => return Err(wrong(format!("must be of type {shape:?} for {user}"))),
        }

        let count = accessor.count.0;
        let size = component.size() * shape.multiplicity();
        let normalized = accessor.normalized;
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                let stride = self.stride(view.value(), size, &part)?;
                let bytes = self.span(view.value(), offset, count, stride, size, &part)?;
                let elements = Elements { bytes, stride, component, normalized };
                (0..count as usize).map(|at| take(&elements, at)).collect()
            }
            None => {
                self.zeros.set(self.zeros.get().saturating_add(count));
                if self.zeros.get() > MAX_ZEROS {
                    let why = format!("has {count} elements but no data, and brings such elements to over {MAX_ZEROS}");
                    return Err(Fault::new(part, why, "export the file again, without compression"));
                }
                vec![zero; count as usize]
            }
        };

        if let Some(sparse) = &accessor.sparse {
            let indices = &sparse.indices;
            let Checked::Valid(kind) = indices.component_type else {
                return Err(wrong("has sparse indices of an unknown type".into()));
            };
            let (entries, width) = (sparse.count.0, kind.0.size());
            let view = indices.buffer_view.value();
            let bytes = self.span(view, indices.byte_offset.0, entries, width, width, &part)?;
            let places = Elements { bytes, stride: width, component: kind.0, normalized: false };
            let view = sparse.values.buffer_view.value();
            let bytes = self.span(view, sparse.values.byte_offset.0, entries, size, size, &part)?;
            let elements = Elements { bytes, stride: size, component, normalized };
            for entry in 0..entries as usize {
                let place = places.unsigned(entry, 0);
                let value = values.get_mut(place as usize).ok_or_else(|| {
                    wrong(format!("replaces element {place} (sparse entry {entry}), but has only {count}"))
                })?;
                *value = take(&elements, entry);
            }
        }
        Ok(values)
    }

    /// Stride in bytes of elements of `size` bytes in a view.
    fn stride(&self, view: usize, size: usize, part: &str) -> Result<usize, Fault> {
        match self.root.buffer_views.get(view).and_then(|view| view.byte_stride) {
            Some(stride) if stride.0 < size => Err(Fault::new(
                part,
                format!("has elements of {size} bytes, but buffer view {view} puts them {} apart", stride.0),
                AGAIN,
            )),
            Some(stride) => Ok(stride.0),
            None => Ok(size),
        }
    }

    /// The bytes from the first element on, checked to hold all `count` elements.
    fn span(
        &self,
        view: usize,
        offset: u64,
        count: u64,
        stride: usize,
        size: usize,
        part: &str,
    ) -> Result<&[u8], Fault> {
        let bytes = self.buffers.view(view, part)?;
        let Some(last) = count.checked_sub(1) else {
            return Ok(&[]);
        };
        let needed = u128::from(offset) + u128::from(last) * stride as u128 + size as u128;
        usize::try_from(offset)
            .ok()
            .filter(|_| needed <= bytes.len() as u128)
            .and_then(|offset| bytes.get(offset..))
            .ok_or_else(|| {
                Fault::new(
                    part,
                    format!(
                        "needs {needed} bytes for its {count} elements, but buffer view {view} has {}",
                        bytes.len()
                    ),
                    AGAIN,
                )
            })
    }
}

impl Elements<'_> {
    fn component<const N: usize>(&self, at: usize, axis: usize) -> [u8; N] {
        let start = at * self.stride + axis * N;
        std::array::from_fn(|byte| self.bytes[start + byte])
    }

    /// One component; normalised integers follow section 3.11 of the glTF 2.0 specification.
    fn number(&self, at: usize, axis: usize) -> f64 {
        let (value, full) = match self.component {
            ComponentType::I8 => (f64::from(i8::from_le_bytes(self.component(at, axis))), 127.0),
            ComponentType::U8 => (f64::from(u8::from_le_bytes(self.component(at, axis))), 255.0),
            ComponentType::I16 => (f64::from(i16::from_le_bytes(self.component(at, axis))), 32767.0),
            ComponentType::U16 => (f64::from(u16::from_le_bytes(self.component(at, axis))), 65535.0),
            ComponentType::U32 => (f64::from(u32::from_le_bytes(self.component(at, axis))), 1.0),
            ComponentType::F32 => (f64::from(f32::from_le_bytes(self.component(at, axis))), 1.0),
        };
        if self.normalized { (value / full).max(-1.0) } else { value }
    }

    /// One unsigned integer.
    fn unsigned(&self, at: usize, axis: usize) -> u32 {
        match self.component.size() {
            1 => u32::from(u8::from_le_bytes(self.component(at, axis))),
            2 => u32::from(u16::from_le_bytes(self.component(at, axis))),
            _ => u32::from_le_bytes(self.component(at, axis)),
        }
    }
}

//! How much memory the rest of a file takes, before its textures are planned: they get what is left.

use gltf::json::Root;

use super::accessor::Accessors;
use super::buffers::Buffers;
use super::{nodes, primitive};

/// Bytes of the meshes that nodes refer to, and of the buffers that are not read yet; what is damaged counts nothing, and is an
/// error where it is read.
pub(super) fn geometry<'a>(root: &'a Root, buffers: &'a Buffers<'a>) -> u64 {
    let accessors = Accessors::new(root, buffers);
    let mesh = |node: usize| root.meshes.get(root.nodes[node].mesh?.value());
    let bytes = |source| match primitive::is_surface(source, "") {
        Ok(true) => primitive::bytes(&accessors, source, "").unwrap_or(0),
        _ => 0,
    };
    let placed = nodes::place(root).unwrap_or_default();
    let primitives = placed.iter().filter_map(|placed| mesh(placed.node)).flat_map(|mesh| &mesh.primitives);
    primitives.map(bytes).fold(buffers.unread(), u64::saturating_add)
}

/// Upper bound on the bytes that a JSON text takes up while it is parsed and as it is kept.
///
/// Every value and every key of it follows one of the counted characters. In a list that may be half empty, a key or a number
/// takes up to 128 bytes, an object with the fields of a node up to 1024.
pub(super) fn json(text: &[u8]) -> u64 {
    let bytes = |byte: &u8| match byte {
        b'{' => 1024,
        b',' | b'[' | b':' => 128,
        _ => 2,
    };
    text.iter().map(bytes).sum()
}

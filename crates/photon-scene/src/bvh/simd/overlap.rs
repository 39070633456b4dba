//! The triangles whose boxes overlap a box.

use glam::Vec3;

use super::node::{Child, Node, WIDTH};
use super::traverse::STACK;
use super::triangle::Packet;

/// The triangles of all leaves that the box from `low` to `high` overlaps; `None` if they are more than `room` has.
pub(crate) fn overlapping<'a>(
    nodes: &[Node],
    packets: &[Packet],
    (low, high): (Vec3, Vec3),
    room: &'a mut [u32],
) -> Option<&'a [u32]> {
    let mut stack = [Child::default(); STACK];
    let (mut top, mut count) = (usize::from(!nodes.is_empty()), 0);
    while top > 0 {
        top -= 1;
        let child = stack[top];
        if child.packets > 0 {
            let leaf = &packets[child.first as usize..(child.first + child.packets) as usize];
            for &id in leaf.iter().flat_map(|packet| &packet.ids).filter(|id| **id != u32::MAX) {
                *room.get_mut(count)? = id;
                count += 1;
            }
            continue;
        }
        let node = &nodes[child.first as usize];
        let mut mask = overlaps(node, low, high);
        while mask != 0 {
            stack[top] = node.children[mask.trailing_zeros() as usize % WIDTH];
            top += 1;
            mask &= mask - 1;
        }
    }
    Some(&room[..count])
}

/// Bit mask of the children whose boxes the box overlaps; all of them, where it has a bound that is NaN. Empty slots do not.
#[inline(always)]
fn overlaps(node: &Node, low: Vec3, high: Vec3) -> u32 {
    let (low, high) = (low.to_array(), high.to_array());
    let mut apart = [false; WIDTH];
    for axis in 0..3 {
        for (lane, apart) in apart.iter_mut().enumerate() {
            let empty = node.bounds[2 * axis][lane] == f32::INFINITY;
            *apart |=
                empty | (node.bounds[2 * axis][lane] > high[axis]) | (node.bounds[2 * axis + 1][lane] < low[axis]);
        }
    }
    (0..WIDTH).fold(0, |mask, lane| mask | u32::from(!apart[lane]) << lane)
}

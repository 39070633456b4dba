//! Checks a map against the photons it was built from.

use photon_core::Photon;

use super::super::WIDTH;
use crate::map::VulkanMap;
use crate::vulkan::Vulkan;

/// A map, downloaded to the host.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub(super) ids: Vec<u32>,
    pub(super) positions: Vec<[u32; 4]>,
    pub(super) power: Vec<[u32; 4]>,
    /// Lower corner, first, upper corner, count.
    pub(super) nodes: Vec<[u32; 8]>,
    pub(super) totals: Vec<u32>,
}

impl Seen {
    pub(super) fn of(on: &mut Vulkan, map: &VulkanMap) -> Self {
        let (n, nodes) = (map.length as usize, map.node_count as usize);
        let mut seen = Self {
            ids: vec![0; n],
            positions: vec![[0; 4]; n],
            power: vec![[0; 4]; n],
            nodes: vec![[0; 8]; nodes],
            totals: vec![0; nodes],
        };
        on.read(&map.ids, 0, bytemuck::cast_slice_mut(&mut seen.ids)).unwrap();
        on.read(&map.positions, 0, bytemuck::cast_slice_mut(&mut seen.positions)).unwrap();
        on.read(&map.power, 0, bytemuck::cast_slice_mut(&mut seen.power)).unwrap();
        on.read(&map.nodes, 0, bytemuck::cast_slice_mut(&mut seen.nodes)).unwrap();
        on.read(&map.totals, 0, bytemuck::cast_slice_mut(&mut seen.totals)).unwrap();
        seen
    }
}

/// The bits of a coordinate, with −0 as 0.
fn bits(c: f32) -> u32 {
    if c == 0.0 { 0 } else { c.to_bits() }
}

/// Checks a map against the photons and their expected order.
pub(super) fn check(seen: &Seen, photons: &[Photon], order: &[u32]) -> Result<(), String> {
    if let Some(slot) = (0..order.len()).find(|&slot| seen.ids[slot] != order[slot]) {
        return Err(format!("photon {} instead of {} in slot {slot}", seen.ids[slot], order[slot]));
    }
    for (slot, &id) in order.iter().enumerate() {
        let photon = &photons[id as usize];
        let [x, y, z] = photon.position.map(bits);
        let [r, g, b] = photon.power.map(f32::to_bits);
        if seen.positions[slot] != [x, y, z, photon.normal] || seen.power[slot] != [r, g, b, photon.direction] {
            return Err(format!("slot {slot} does not hold photon {id}"));
        }
    }
    if order.is_empty() {
        return Ok(());
    }
    let mut covered = 0;
    let total = node(seen, 0, &mut covered, 0)?;
    if covered != order.len() || total.2 as usize != order.len() {
        return Err(format!("{covered} of {} slots in leaves", order.len()));
    }
    Ok(())
}

/// The box and the number of points of a subtree; its leaves begin at slot `covered`.
fn node(seen: &Seen, number: usize, covered: &mut usize, depth: u32) -> Result<([f32; 3], [f32; 3], u32), String> {
    let fault = |what: &str| Err(format!("node {number}: {what}: {:?}", seen.nodes[number]));
    if depth > 64 {
        return fault("too deep");
    }
    let [lx, ly, lz, first, hx, hy, hz, count] = seen.nodes[number];
    let (leaf, count) = (count >> 31 != 0, (count & 0x7fff_ffff) as usize);
    if count == 0 || count > WIDTH as usize {
        return fault("children");
    }
    let (mut low, mut high, mut total) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3], 0);
    let mut grow = |l: [f32; 3], h: [f32; 3]| {
        for axis in 0..3 {
            low[axis] = low[axis].min(l[axis]);
            high[axis] = high[axis].max(h[axis]);
        }
    };
    if leaf {
        if first as usize != *covered || *covered + count > seen.ids.len() {
            return fault("slots");
        }
        for slot in *covered..*covered + count {
            let [x, y, z, _] = seen.positions[slot];
            grow([x, y, z].map(f32::from_bits), [x, y, z].map(f32::from_bits));
        }
        *covered += count;
        total = count as u32;
    } else {
        if first as usize <= number || first as usize + count > seen.nodes.len() {
            return fault("index of children");
        }
        for child in 0..count {
            let (l, h, t) = node(seen, first as usize + child, covered, depth + 1)?;
            grow(l, h);
            total += t;
        }
    }
    let tight = [lx, ly, lz] == low.map(bits) && [hx, hy, hz] == high.map(bits);
    if !tight || seen.totals[number] != total {
        return fault("box or photon count");
    }
    Ok((low, high, total))
}

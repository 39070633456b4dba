//! Photon maps built on the host, in the order of backend-cpu's index.

use backend_cpu::index::PointIndex;
use bytemuck::{Pod, Zeroable};
use photon_core::{Backend, IndexKind, Photon};

use crate::map::VulkanMap;
use crate::vulkan::Vulkan;

const LEAF: u32 = 1 << 31;
const WIDTH: usize = 16;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct BoxNode {
    low: [f32; 3],
    first: u32,
    high: [f32; 3],
    count: u32,
}

impl BoxNode {
    const EMPTY: Self = Self { low: [f32::INFINITY; 3], first: 0, high: [f32::NEG_INFINITY; 3], count: 0 };

    fn join(&mut self, low: [f32; 3], high: [f32; 3]) {
        for axis in 0..3 {
            self.low[axis] = self.low[axis].min(low[axis]);
            self.high[axis] = self.high[axis].max(high[axis]);
        }
    }
}

/// Builds a map of the photons without validating them.
pub(super) fn map(on: &mut Vulkan, photons: &[Photon], kind: IndexKind) -> VulkanMap {
    let points: Vec<[f32; 3]> = photons.iter().map(|photon| photon.position).collect();
    let index = PointIndex::build(&points, kind).unwrap();
    let order = index.order();
    let slots = |vector: fn(&Photon) -> [f32; 3], word: fn(&Photon) -> u32| -> Vec<[f32; 4]> {
        let slot = |&id: &u32| {
            let photon = &photons[id as usize];
            let [x, y, z] = vector(photon).map(|c| c + 0.0);
            [x, y, z, f32::from_bits(word(photon))]
        };
        order.iter().map(slot).collect()
    };
    let positions = slots(|photon| photon.position, |photon| photon.normal);
    let power = slots(|photon| photon.power, |photon| photon.direction);
    let (nodes, totals) = nodes(&positions);
    let mut put = |label: &str, bytes: &[u8]| {
        let memory = on.memory(label, bytes.len() as u64).unwrap();
        on.write(&memory, 0, bytes).unwrap();
        memory
    };
    VulkanMap {
        kind,
        length: photons.len() as u32,
        positions: put("positions", bytemuck::cast_slice(&positions)),
        power: put("power", bytemuck::cast_slice(&power)),
        ids: put("ids", bytemuck::cast_slice(order)),
        nodes: put("nodes", bytemuck::cast_slice(&nodes)),
        totals: put("totals", bytemuck::cast_slice(&totals)),
        node_count: nodes.len() as u32,
        photons: on.upload("photons: global", photons).unwrap(),
    }
}

/// Leaves of sixteen slots, sixteen nodes per parent, level by level, the root first.
fn nodes(positions: &[[f32; 4]]) -> (Vec<BoxNode>, Vec<u32>) {
    let mut levels: Vec<(Vec<BoxNode>, Vec<u32>)> = Vec::new();
    let leaf = |(number, points): (usize, &[[f32; 4]])| {
        let mut node = BoxNode { first: (number * WIDTH) as u32, count: LEAF | points.len() as u32, ..BoxNode::EMPTY };
        points.iter().for_each(|&[x, y, z, _]| node.join([x, y, z], [x, y, z]));
        (node, points.len() as u32)
    };
    levels.push(positions.chunks(WIDTH).enumerate().map(leaf).unzip());
    while let Some((below, totals)) = levels.last().filter(|(nodes, _)| nodes.len() > 1) {
        let node = |(number, (nodes, totals)): (usize, (&[BoxNode], &[u32]))| {
            let mut node = BoxNode { first: (number * WIDTH) as u32, count: nodes.len() as u32, ..BoxNode::EMPTY };
            nodes.iter().for_each(|child| node.join(child.low, child.high));
            (node, totals.iter().sum::<u32>())
        };
        let above = below.chunks(WIDTH).zip(totals.chunks(WIDTH)).enumerate().map(node).unzip();
        levels.push(above);
    }
    let (mut nodes, mut totals) = (Vec::new(), Vec::new());
    for (level, below) in levels.into_iter().rev() {
        let base = (nodes.len() + level.len()) as u32;
        nodes.extend(level.into_iter().map(|mut node| {
            if node.count & LEAF == 0 {
                node.first += base;
            }
            node
        }));
        totals.extend(below);
    }
    (nodes, totals)
}

//! Builds the tree from above: each node is split where the sum of its children's costs is least, among 12 bins on each
//! axis.

use glam::DVec3;

use super::bounds::{LightBounds, is_infinite};
use super::{LEAF, LightNode, LightTree};
use crate::scene::SceneView;

/// Bins on an axis.
const BINS: usize = 12;
/// From this depth on, nodes are halved: less than 2³⁰ lights then end within [`super::MAX_DEPTH`].
const MAX_UNEVEN_DEPTH: u32 = 32;

pub(super) fn tree(scene: &SceneView<'_>) -> LightTree {
    let bounds: Vec<LightBounds> = scene.lights.iter().map(|light| LightBounds::of(scene, light)).collect();
    let mut building = Building { bounds, nodes: Vec::new(), trails: vec![0; scene.lights.len()] };
    let all = 0..scene.lights.len() as u32;
    let (infinite, finite): (Vec<u32>, Vec<u32>) = all.partition(|&index| is_infinite(&scene.lights[index as usize]));
    if infinite.is_empty() || finite.is_empty() {
        let is_infinite = finite.is_empty();
        building.add(if is_infinite { infinite } else { finite }, is_infinite, (0, 0));
    } else {
        // No bounds of the root are read: lights nearby and lights at infinity have no common ones.
        building.nodes.push(LightNode::default());
        building.add(infinite, true, (0, 1));
        building.nodes[0].next = building.nodes.len() as u32;
        building.add(finite, false, (1, 1));
    }
    LightTree { nodes: building.nodes, trails: building.trails }
}

struct Building {
    bounds: Vec<LightBounds>,
    nodes: Vec<LightNode>,
    trails: Vec<u64>,
}

impl Building {
    /// Appends the tree of these lights, at least one, at the end of a trail of `depth` bits.
    fn add(&mut self, lights: Vec<u32>, infinite: bool, (trail, depth): (u64, u32)) {
        let mut all = self.bounds[lights[0] as usize];
        for &light in &lights[1..] {
            all = all.union(&self.bounds[light as usize]);
        }
        let at = self.nodes.len();
        self.nodes.push(all.node(infinite, LEAF | lights[0]));
        if let [light] = lights[..] {
            self.trails[light as usize] = trail;
            return;
        }
        let (first, second) = self.split(lights, depth);
        self.add(first, infinite, (trail, depth + 1));
        self.nodes[at].next = self.nodes.len() as u32;
        self.add(second, infinite, (trail | 1 << depth, depth + 1));
    }

    /// Splits two or more lights into two parts with at least one each; the lights stay in order.
    fn split(&self, mut lights: Vec<u32>, depth: u32) -> (Vec<u32>, Vec<u32>) {
        let centroid = |light: &u32| self.bounds[*light as usize].centroid();
        let low = lights.iter().map(centroid).fold(DVec3::INFINITY, DVec3::min);
        let high = lights.iter().map(centroid).fold(DVec3::NEG_INFINITY, DVec3::max);
        let extent = high - low;
        let mut best: Option<(f64, usize, usize)> = None;
        if depth < MAX_UNEVEN_DEPTH {
            for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
                let (cost, after) = self.best_on_axis(&lights, |light| bin(centroid(light), low, extent, axis));
                let cost = cost * (extent.max_element() / extent[axis]);
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, after));
                }
            }
        }
        match best {
            Some((_, axis, after)) => {
                lights.into_iter().partition(|light| bin(centroid(light), low, extent, axis) < after)
            }
            // All in one place, or too deep.
            None => {
                let second = lights.split_off(lights.len() / 2);
                (lights, second)
            }
        }
    }

    /// Least cost of a split after a bin, and the number of bins before it. The first and the last bin have lights.
    fn best_on_axis(&self, lights: &[u32], bin: impl Fn(&u32) -> usize) -> (f64, usize) {
        let mut bins: [Option<LightBounds>; BINS] = [None; BINS];
        for light in lights {
            let bounds = &self.bounds[*light as usize];
            let bin = &mut bins[bin(light)];
            *bin = Some(bin.map_or(*bounds, |bin| bin.union(bounds)));
        }
        let join = |sum: Option<LightBounds>, bin: Option<LightBounds>| match (sum, bin) {
            (Some(sum), Some(bin)) => Some(sum.union(&bin)),
            (sum, bin) => sum.or(bin),
        };
        // Costs of the bins from each one to the last.
        let mut after = [0.0; BINS];
        let mut sum = None;
        for place in (1..BINS).rev() {
            sum = join(sum, bins[place]);
            after[place] = sum.map_or(0.0, |sum| sum.cost());
        }
        let mut best = (f64::INFINITY, 1);
        let mut sum = None;
        for place in 1..BINS {
            sum = join(sum, bins[place - 1]);
            let cost = sum.map_or(0.0, |sum| sum.cost()) + after[place];
            if cost < best.0 {
                best = (cost, place);
            }
        }
        best
    }
}

fn bin(centroid: DVec3, low: DVec3, extent: DVec3, axis: usize) -> usize {
    let at = (centroid[axis] - low[axis]) / extent[axis] * BINS as f64;
    (at as usize).min(BINS - 1)
}

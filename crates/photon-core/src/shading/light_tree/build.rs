//! Builds the tree from above: of the lights of a node, the part with the largest cost is split in two, where the sum of the
//! costs is least among 12 bins on each axis, until there are as many parts as a node has children, or until each part has as
//! few lights.

use std::cmp::Ordering;

use glam::DVec3;

use super::bounds::{LightBounds, is_infinite};
use super::{LEAF, LightNodes, LightTree, MAX_DEPTH, TRAIL_BITS, WIDTH};
use crate::scene::SceneView;

/// Bins on an axis.
const BINS: usize = 12;
/// From this depth on, the part with most lights is halved: less than 2³⁰ lights then end within [`MAX_DEPTH`].
const MAX_UNEVEN_DEPTH: u32 = 10;

// Trails have 64 bits.
const _: () = assert!(MAX_DEPTH * TRAIL_BITS <= 64);

pub(super) fn tree(scene: &SceneView<'_>) -> LightTree {
    assert!((2..1 << 30).contains(&scene.lights.len()), "a light tree has from 2 to 2³⁰ − 1 lights");
    let bounds: Vec<LightBounds> = scene.lights.iter().map(|light| LightBounds::of(scene, light)).collect();
    let mut building = Building { bounds, nodes: Vec::new(), trails: vec![0; scene.lights.len()] };
    let all = 0..scene.lights.len() as u32;
    let (infinite, finite): (Vec<u32>, Vec<u32>) = all.partition(|&index| is_infinite(&scene.lights[index as usize]));
    // Lights nearby and lights at infinity have no common bounds.
    let parts = [(infinite, true), (finite, false)].into_iter().filter(|(lights, _)| !lights.is_empty());
    let parts = parts.map(|(lights, infinite)| building.part(lights, infinite)).collect();
    building.add(parts, 0, 0);
    LightTree { nodes: building.nodes, trails: building.trails }
}

/// Lights below one node.
struct Part {
    lights: Vec<u32>,
    bounds: LightBounds,
    infinite: bool,
}

struct Building {
    bounds: Vec<LightBounds>,
    nodes: Vec<LightNodes>,
    trails: Vec<u64>,
}

impl Building {
    fn part(&self, lights: Vec<u32>, infinite: bool) -> Part {
        let mut bounds = self.bounds[lights[0] as usize];
        for &light in &lights[1..] {
            bounds = bounds.union(&self.bounds[light as usize]);
        }
        Part { lights, bounds, infinite }
    }

    /// Appends the children of a node at the end of a trail of `depth` levels, and all nodes below them; returns their
    /// index.
    fn add(&mut self, mut parts: Vec<Part>, trail: u64, depth: u32) -> u32 {
        let uneven = depth < MAX_UNEVEN_DEPTH;
        while parts.len() < WIDTH {
            let Some(at) = next_to_split(&parts, uneven) else { break };
            let infinite = parts[at].infinite;
            let (first, second) = self.split(std::mem::take(&mut parts[at].lights), uneven);
            parts.splice(at..=at, [self.part(first, infinite), self.part(second, infinite)]);
        }
        let index = self.nodes.len();
        self.nodes.push(LightNodes::NONE);
        for (child, part) in parts.into_iter().enumerate() {
            let (bounds, infinite) = (part.bounds, part.infinite);
            let trail = trail | (child as u64) << (TRAIL_BITS * depth);
            let next = match part.lights[..] {
                [light] => {
                    self.trails[light as usize] = trail;
                    LEAF | light
                }
                _ => self.add(vec![part], trail, depth + 1),
            };
            self.nodes[index].set(child, &bounds.node(infinite, next));
        }
        index as u32
    }

    /// Splits two or more lights into two parts with at least one each; the lights stay in order.
    fn split(&self, mut lights: Vec<u32>, uneven: bool) -> (Vec<u32>, Vec<u32>) {
        let centroid = |light: &u32| self.bounds[*light as usize].centroid();
        let low = lights.iter().map(centroid).fold(DVec3::INFINITY, DVec3::min);
        let high = lights.iter().map(centroid).fold(DVec3::NEG_INFINITY, DVec3::max);
        let extent = high - low;
        let mut best: Option<(f64, usize, usize)> = None;
        if uneven {
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

/// The part to split: that of the largest cost, of lights nearby before those at infinity; if not `uneven`, that with most
/// lights. Only parts with more lights than a node has children, so that the last nodes are full, unless the lights of all
/// parts are as few. `None` if there is none.
fn next_to_split(parts: &[Part], uneven: bool) -> Option<usize> {
    let lights: usize = parts.iter().map(|part| part.lights.len()).sum();
    let is_last = parts.len() == 1 || lights <= WIDTH;
    let large = parts.iter().enumerate().filter(|(_, part)| part.lights.len() > if is_last { 1 } else { WIDTH });
    let order = |part: &Part| (!part.infinite, if uneven { part.bounds.cost() } else { 0.0 }, part.lights.len());
    let best = large.reduce(|a, b| if order(a.1).partial_cmp(&order(b.1)) == Some(Ordering::Less) { b } else { a });
    best.map(|(at, _)| at)
}

fn bin(centroid: DVec3, low: DVec3, extent: DVec3, axis: usize) -> usize {
    let at = (centroid[axis] - low[axis]) / extent[axis] * BINS as f64;
    (at as usize).min(BINS - 1)
}

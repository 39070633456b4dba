//! The children of a node of the light tree, which are weighed together.

use glam::Vec3;

use super::{LightNode, NO_CHILD};

/// Maximum number of children of a node.
pub const WIDTH: usize = 8;
/// The largest `f32` below 2³¹: at most this many random words select a child that is not the largest one.
pub const MAX_WORDS: f32 = 2_147_483_520.0;

/// Children of a node, one array for each member of [`LightNode`]. At least the first two exist; the others may not.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
#[non_exhaustive]
pub struct LightNodes {
    /// [`LightNode::center`], one array for each coordinate.
    pub center: [[f32; WIDTH]; 3],
    /// [`LightNode::radius`].
    pub radius: [f32; WIDTH],
    /// [`LightNode::intensity`].
    pub intensity: [f32; WIDTH],
    /// [`LightNode::axis`].
    pub axis: [u32; WIDTH],
    /// [`LightNode::cone`].
    pub cone: [u32; WIDTH],
    /// [`LightNode::next`].
    pub next: [u32; WIDTH],
}

impl LightNodes {
    /// No children. They count as emitting in all directions.
    pub(super) const NONE: Self = Self {
        center: [[0.0; WIDTH]; 3],
        radius: [0.0; WIDTH],
        intensity: [0.0; WIDTH],
        axis: [0; WIDTH],
        cone: [0x8001; WIDTH],
        next: [NO_CHILD; WIDTH],
    };

    /// One of the children. `child` must be below [`WIDTH`].
    #[inline(always)]
    #[must_use]
    pub fn node(&self, child: usize) -> LightNode {
        LightNode {
            center: [self.center[0][child], self.center[1][child], self.center[2][child]],
            radius: self.radius[child],
            intensity: self.intensity[child],
            axis: self.axis[child],
            cone: self.cone[child],
            next: self.next[child],
        }
    }

    pub(super) fn set(&mut self, child: usize, node: &LightNode) {
        for axis in 0..3 {
            self.center[axis][child] = node.center[axis];
        }
        self.radius[child] = node.radius;
        self.intensity[child] = node.intensity;
        self.axis[child] = node.axis;
        self.cone[child] = node.cone;
        self.next[child] = node.next;
    }

    /// Numbers of the 2³² random words that select each child: in proportion to [`LightNode::importance`], to rounding,
    /// at least 1; 0 where there is no child. Their sum is 2³².
    #[inline(always)]
    #[must_use]
    pub fn words(&self, position: Vec3, normal: Vec3) -> [u32; WIDTH] {
        let mut weights = self.importances(position, normal);
        let mut total = sum(&weights);
        if !is_usable(total) {
            (weights, total) = self.weights_anywhere();
        }
        let mut parts = [0.0; WIDTH];
        for child in 0..WIDTH {
            parts[child] = smaller(larger(weights[child] / total * 4_294_967_296.0, 1.0), MAX_WORDS);
        }
        let mut words = [0; WIDTH];
        for child in 0..WIDTH {
            let all_bits = u32::from(self.next[child] == NO_CHILD).wrapping_sub(1);
            words[child] = truncated(parts[child]) & all_bits;
        }
        // The largest part takes what the others leave: 1 minus a rounded quotient near 1 would have few correct digits.
        let largest = largest(&weights);
        let rest = words.iter().fold(0, |sum: u32, &part| sum.wrapping_add(part)).wrapping_neg();
        for child in 0..WIDTH {
            words[child] = words[child].wrapping_add(if child == largest { rest } else { 0 });
        }
        words
    }

    /// [`LightNode::importance`] of each child; 0 where there is none.
    #[inline(always)]
    pub(super) fn importances(&self, position: Vec3, normal: Vec3) -> [f32; WIDTH] {
        let mut importances = [0.0; WIDTH];
        let (mut has_cones, mut is_infinite) = (false, false);
        for child in 0..WIDTH {
            let node = self.node(child);
            has_cones |= !node.is_everywhere();
            is_infinite |= node.radius < 0.0;
        }
        if has_cones {
            for child in 0..WIDTH {
                importances[child] = self.node(child).importance_nearby::<true>(position, normal);
            }
        } else {
            for child in 0..WIDTH {
                importances[child] = self.node(child).importance_nearby::<false>(position, normal);
            }
        }
        if is_infinite { self.with_infinity(importances, normal) } else { importances }
    }

    /// The importances with those of directional lights and the environment.
    #[cold]
    fn with_infinity(&self, mut importances: [f32; WIDTH], normal: Vec3) -> [f32; WIDTH] {
        for child in (0..WIDTH).filter(|&child| self.radius[child] < 0.0) {
            importances[child] = self.node(child).importance_from_infinity(normal);
        }
        importances
    }

    /// Weights where importances are of no use, and their sum.
    #[cold]
    fn weights_anywhere(&self) -> ([f32; WIDTH], f32) {
        let total = sum(&self.intensity);
        if is_usable(total) {
            return (self.intensity, total);
        }
        let weights = self.next.map(|next| f32::from(u8::from(next != NO_CHILD)));
        (weights, sum(&weights))
    }
}

/// Whether a sum of weights can be divided by.
#[inline(always)]
fn is_usable(sum: f32) -> bool {
    (f32::MIN_POSITIVE..=f32::MAX).contains(&sum)
}

/// The sum, in an order that needs few steps of vector instructions.
#[inline(always)]
fn sum(of: &[f32; WIDTH]) -> f32 {
    let [a, b, c, d, e, f, g, h] = *of;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

// Nothing here is NaN, which the methods of `f32` ignore by further instructions.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The whole part of a number from 1 to below 2³¹, by operations that compilers vectorize, unlike the conversion.
#[inline(always)]
fn truncated(of: f32) -> u32 {
    let bits = of.to_bits();
    let exponent = (bits >> 23).wrapping_sub(127);
    let significand = bits & 0x7F_FFFF | 0x80_0000;
    significand.wrapping_shr(23_u32.saturating_sub(exponent)).wrapping_shl(exponent.saturating_sub(23))
}

/// The index of the largest, of the first of them if there are several.
#[inline(always)]
fn largest(of: &[f32; WIDTH]) -> usize {
    let [a, b, c, d, e, f, g, h] = *of;
    let largest = larger(larger(larger(a, e), larger(c, g)), larger(larger(b, f), larger(d, h)));
    let mut all = 0_u32;
    for (index, &value) in of.iter().enumerate() {
        all |= u32::from(value >= largest) << index;
    }
    all.trailing_zeros() as usize % WIDTH
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn truncation_is_the_conversion() {
        let mut of = 1.0_f32;
        while of <= MAX_WORDS {
            assert_eq!(truncated(of), of as u32);
            of = (of * 1.000_3).next_up();
        }
        assert_eq!((truncated(1.0), truncated(MAX_WORDS)), (1, 2_147_483_520));
    }
}

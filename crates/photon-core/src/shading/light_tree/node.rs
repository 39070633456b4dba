//! A node of the light tree: bounds of lights, and how much light a surface may get from them.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

#[cfg(doc)]
use super::{LEAF, LightTree, NO_CHILD};
use crate::shading::{octahedral, offset};

/// Steps from 0 to 1 of the cosines in [`LightNode::cone`].
pub const COSINE_STEPS: f32 = 32_767.0;
/// Minimum of the squared distance to a node, relative to its squared half diagonal. With 1, as in Conty Estevez and
/// Kulla 2018, the variance under 10⁵ point lights is 2.2 times as large, and inside a luminous sphere two thirds as large.
pub const MIN_DISTANCE_SHARE: f32 = 0.5;
/// Minimum of the squared distance to a light: shadow rays start this far off their surface.
pub const MIN_SQUARED: f32 = offset::STEP * offset::STEP;

/// A node: bounds of the lights below it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[non_exhaustive]
pub struct LightNode {
    /// Centre of the bounding box, normalised space.
    pub center: [f32; 3],
    /// Half the diagonal of that box; −1 for directional lights and the environment.
    pub radius: f32,
    /// Sum of the lights' peak radiant intensities, mean of RGB; of directional lights and of the environment, their
    /// irradiance on a surface that faces them.
    pub intensity: f32,
    /// Axis of the cone that contains the normals of all lights, packed by [`octahedral::pack`]; of directional lights,
    /// the axis towards them.
    pub axis: u32,
    /// Low half: cosine of the half angle of that cone. High half: cosine of the angle about the normals within which
    /// the lights emit. Both in steps of 1/[`COSINE_STEPS`], signed, rounded down.
    pub cone: u32,
    /// Index of its children in [`LightTree::nodes`]; of a leaf, [`LEAF`] and the index of its light; [`NO_CHILD`] if there is
    /// no such node.
    pub next: u32,
}

impl LightNode {
    /// Estimated irradiance on a surface at `position` from all lights of the node: intensity times cosine at the
    /// surface times cosine at the lights, each for the most favourable direction that the bounds allow, divided by
    /// the squared distance of the centre, at least [`MIN_DISTANCE_SHARE`] of the squared half diagonal.
    #[inline]
    #[must_use]
    pub fn importance(&self, position: Vec3, normal: Vec3) -> f32 {
        if self.radius < 0.0 {
            return self.importance_from_infinity(normal);
        }
        self.importance_nearby::<true>(position, normal)
    }

    /// Whether the lights emit in all directions, as point lights do.
    #[inline(always)]
    pub(super) fn is_everywhere(&self) -> bool {
        self.spread() <= -COSINE_STEPS
    }

    /// [`Self::importance`] of directional lights and of the environment.
    pub(super) fn importance_from_infinity(&self, normal: Vec3) -> f32 {
        self.intensity * if self.is_everywhere() { 1.0 } else { self.off_axis(normal).cosine().max(0.0) }
    }

    /// [`Self::importance`] of all others, without branches, so that the compiler can vectorize a loop over nodes. With
    /// `CONES` false, only of nodes that emit in all directions.
    #[inline(always)]
    pub(super) fn importance_nearby<const CONES: bool>(&self, position: Vec3, normal: Vec3) -> f32 {
        let gap = Vec3::from(self.center) - position;
        let squared = gap.length_squared();
        let reach = self.radius * self.radius;
        let divisor = squared.max(reach * MIN_DISTANCE_SHARE).max(MIN_SQUARED);
        let is_inside = squared <= reach.max(MIN_SQUARED);
        // Half angle under which the bounding sphere is seen; not a number inside it.
        let seen = Angle { cos: (squared - reach).sqrt(), sin: self.radius };
        let received = Angle::between(normal, gap).minus(seen);
        let (mut cosines, mut is_lit) = (received.cosine(), received.cos > 0.0);
        if CONES {
            let emitted = self.off_axis(-gap).minus(seen).or(Angle::ZERO, self.is_everywhere());
            cosines = received.cos * emitted.cos / (received.length() * emitted.length());
            is_lit &= (emitted.cos > 0.0) & emitted.is_within(f32::from((self.cone >> 16) as u16 as i16));
        }
        let cosines = if is_inside {
            1.0
        } else if is_lit {
            cosines
        } else {
            0.0
        };
        self.intensity * cosines / divisor
    }

    #[inline(always)]
    fn spread(&self) -> f32 {
        f32::from(self.cone as u16 as i16)
    }

    /// The angle between the cone of normals and a direction.
    #[inline(always)]
    fn off_axis(&self, direction: Vec3) -> Angle {
        let axis = octahedral::unpack_unnormalized(self.axis);
        Angle::between(axis, direction).minus(Angle::with_cosine(self.spread()))
    }
}

/// An angle between 0 and π: its cosine and its sine, both times the same positive number.
///
/// Both are computed from vectors, not one from the other: 1 − cos² would turn the rounding error of a cosine near 1
/// into a relative error of the sine that is thousands of times as large.
#[derive(Clone, Copy)]
struct Angle {
    cos: f32,
    sin: f32,
}

impl Angle {
    const ZERO: Self = Self { cos: 1.0, sin: 0.0 };

    /// The angle between two vectors of any length.
    #[inline(always)]
    fn between(a: Vec3, b: Vec3) -> Self {
        Self { cos: a.dot(b), sin: a.cross(b).length() }
    }

    /// The angle whose cosine is `steps` of 1/[`COSINE_STEPS`]; whole numbers, so that the product is exact to rounding.
    #[inline(always)]
    fn with_cosine(steps: f32) -> Self {
        Self { cos: steps, sin: ((COSINE_STEPS - steps) * (COSINE_STEPS + steps)).sqrt() }
    }

    /// The difference, 0 if `other` is larger. `other` is below π.
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        let sin = self.sin * other.cos - self.cos * other.sin;
        Self { cos: self.cos * other.cos + self.sin * other.sin, sin }.or(Self::ZERO, sin < 0.0)
    }

    /// `other` under a condition.
    #[inline(always)]
    fn or(self, other: Self, condition: bool) -> Self {
        if condition { other } else { self }
    }

    /// The factor of cosine and sine.
    #[inline(always)]
    fn length(self) -> f32 {
        (self.cos * self.cos + self.sin * self.sin).sqrt()
    }

    #[inline(always)]
    fn cosine(self) -> f32 {
        self.cos / self.length()
    }

    /// For an angle below π/2, whether it is at most the one whose cosine is `steps` of 1/[`COSINE_STEPS`].
    #[inline(always)]
    fn is_within(self, steps: f32) -> bool {
        let squares = (COSINE_STEPS - steps) * (COSINE_STEPS + steps);
        (steps <= 0.0) | (self.sin * self.sin * (steps * steps) <= self.cos * self.cos * squares)
    }
}

//! Which of a few lights are parts of one area light.

use crate::light_sampler::MAX_LIGHTS;
use crate::scene::SceneView;
use crate::scene::light::Light;

/// Groups of consecutive lights: the triangles of an area light, or another light alone. A shadow ray to each group tells
/// which of them are occluded; triangles of a group are mostly occluded together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightGroups(u32);

impl LightGroups {
    /// The groups of a scene's lights. Triangles of one group are consecutive, have the same material, and are connected by
    /// corners. Empty if there is one group, or more than [`MAX_LIGHTS`] lights.
    #[must_use]
    pub fn new(scene: &SceneView<'_>) -> Self {
        let count = scene.lights.len();
        if count > MAX_LIGHTS {
            return Self::default();
        }
        let (mut starts, mut first) = (0, 0);
        for index in 0..count {
            if index == 0 || !(first..index).any(|before| are_connected(scene, before, index)) {
                (starts, first) = (starts | 1 << index, index);
            }
        }
        Self::from_starts(starts)
    }

    /// From the lights that start a group, as bits. Empty if only one does.
    #[must_use]
    pub const fn from_starts(starts: u32) -> Self {
        if starts.count_ones() < 2 { Self(0) } else { Self(starts) }
    }

    /// Bit `i` is set if light `i` starts a group; 0 without groups.
    #[must_use]
    pub const fn starts(self) -> u32 {
        self.0
    }

    /// The groups of this many lights, at most 32: the first light and the end of each.
    #[inline]
    pub fn of(self, lights: usize) -> impl Iterator<Item = [usize; 2]> {
        let mut next = 0;
        std::iter::from_fn(move || {
            let first = next;
            (first < lights).then(|| {
                next = (first + 1..lights).find(|&light| self.0 >> light & 1 != 0).unwrap_or(lights);
                [first, next]
            })
        })
    }
}

/// Whether two lights are triangles of one material with a corner in the same place.
fn are_connected(scene: &SceneView<'_>, one: usize, other: usize) -> bool {
    let triangle = |index: usize| {
        let light = scene.lights[index];
        let primitive = (light.kind == Light::TRIANGLE).then_some(light.primitive as usize)?;
        let corners = scene.triangles[primitive].map(|vertex| scene.positions[vertex as usize]);
        Some((corners, scene.primitives[primitive].material))
    };
    match (triangle(one), triangle(other)) {
        (Some((corners, material)), Some((others, like))) => {
            material == like && corners.iter().any(|corner| others.contains(corner))
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::material::Primitive;

    fn starts(materials: [u32; 3], apart: f32, points: usize) -> u32 {
        let corner = |x: f32| [[x, 0.0, 0.0], [x, 0.1, 0.0], [x + 0.1, 0.0, 0.0], [x + 0.1, 0.1, 0.0]];
        // Two triangles of a square, and a third with corners of its own.
        let positions: Vec<[f32; 3]> = corner(0.0).into_iter().chain(corner(0.1 + apart)).collect();
        let triangles = [[0, 1, 2], [1, 2, 3], [4, 5, 6]];
        let primitives = materials.map(|material| Primitive { material, ..Primitive::default() });
        let light = |primitive| Light { kind: Light::TRIANGLE, primitive, ..Light::default() };
        let point = Light { kind: Light::POINT, primitive: u32::MAX, ..Light::default() };
        let lights: Vec<Light> = (0..3).map(light).chain(std::iter::repeat_n(point, points)).collect();
        let view = SceneView {
            positions: &positions,
            triangles: &triangles,
            primitives: &primitives,
            lights: &lights,
            ..SceneView::default()
        };
        LightGroups::new(&view).starts()
    }

    #[test]
    fn connected_triangles_of_one_material_are_a_group() {
        assert_eq!(starts([0, 0, 0], 0.0, 0), 0, "one group is none");
        assert_eq!(starts([0, 0, 0], 0.0, 2), 0b1_1001);
        assert_eq!(starts([0, 0, 0], 0.1, 0), 0b101, "apart");
        assert_eq!(starts([0, 0, 1], 0.0, 0), 0b101);
        assert_eq!(starts([0, 1, 0], 0.0, 1), 0b1111);
        assert_eq!(starts([0, 0, 0], 0.0, MAX_LIGHTS - 2), 0, "too many");
    }
}

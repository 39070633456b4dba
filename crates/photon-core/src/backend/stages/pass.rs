//! What a stage is called for: a range of paths, a pass, a picture.

use std::ops::Range;

use crate::scene::SceneView;
use crate::scene::camera::Camera;
use crate::scene::solids::Solids;
use crate::settings::{RandomKind, Settings};

/// A range of paths of one pass.
#[derive(Clone, Debug, PartialEq)]
// Exhaustive: written as a literal by callers of stages, which must state every field.
pub struct Batch {
    /// The pass.
    pub pass: Pass,
    /// Indices of the paths within the pass.
    pub paths: Range<u32>,
}

/// The key of a pass's random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Exhaustive: as `Batch`.
pub struct Pass {
    /// Key of all random numbers.
    pub seed: u64,
    /// Index of the pass, from 0.
    pub index: u32,
    /// Which random numbers photon paths use.
    pub random: RandomKind,
    /// Camera sample of each pixel, from 0: photons, estimates and final gathering are those of sample 0.
    pub sample: u32,
    /// Number of camera samples, from that one on, which are traced together:
    /// [`crate::TransportBackend::samples_together`].
    pub samples: u32,
}

impl Pass {
    /// Camera sample 0 of pass `index`.
    #[must_use]
    pub fn new(settings: &Settings, index: u32) -> Self {
        Self { seed: settings.seed, index, random: settings.random, sample: 0, samples: 1 }
    }
}

/// A camera and the size of its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: as `Batch`.
pub struct View {
    /// The camera, its right and up vectors scaled to the aspect ratio of the picture.
    pub camera: Camera,
    /// Width in pixels, ≥ 1.
    pub width: u32,
    /// Height in pixels, ≥ 1.
    pub height: u32,
}

impl View {
    /// The same view, with the media of `scene` that the camera lies in. [`crate::Pipeline`] calls this; a
    /// caller that runs [`crate::EyeTracer`] directly has to call it once.
    #[must_use]
    pub fn within(mut self, scene: &SceneView<'_>) -> Self {
        self.camera.media = Solids::of(scene).at(self.camera.origin).bits();
        self
    }
}

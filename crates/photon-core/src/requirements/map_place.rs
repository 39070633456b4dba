//! Places of photons, and what reads them.

/// Place of the photons of a map. With the [`crate::MapKind`], it tells apart all maps of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MapPlace {
    /// On surfaces that scatter light diffusely, read where camera paths end.
    Surface,
    /// On glossy surfaces, read through their reflection: [`crate::GlossCaustics`].
    Reflection,
    /// In media that scatter light, read along segments of camera paths: [`crate::MediaStages`].
    Medium,
}

impl MapPlace {
    /// All places, in the order in which maps are built and read.
    pub const ALL: [Self; 3] = [Self::Surface, Self::Reflection, Self::Medium];
}

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
    /// On surfaces, where light arrives that was last scattered in a medium: final-gather rays do not find it, so that it is read
    /// where camera paths end. These photons are in the map of all scattered light too.
    FromMedium,
}

impl MapPlace {
    /// Whether the photons are on surfaces, and read where camera paths end.
    #[must_use]
    pub const fn is_on_visible_surfaces(self) -> bool {
        matches!(self, Self::Surface | Self::FromMedium)
    }

    /// All places, in the order in which maps are built and read.
    pub const ALL: [Self; 4] = [Self::Surface, Self::Reflection, Self::Medium, Self::FromMedium];
}

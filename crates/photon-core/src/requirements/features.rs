//! Features of a scene that kernels have to support.

use std::fmt;

/// A set of features that kernels support.
///
/// CPU kernels take it as a const generic, Vulkan kernels as specialization constant 0: features that are
/// not in it are not compiled in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Features(u32);

impl Features {
    /// No features.
    pub const NONE: Self = Self(0);
    /// Lambertian surfaces.
    pub const DIFFUSE: Self = Self(1);
    /// Perfect mirrors.
    pub const MIRROR: Self = Self(1 << 1);
    /// Boundaries of refracting solids.
    pub const DIELECTRIC: Self = Self(1 << 2);
    /// Refracting sheets without thickness.
    pub const THIN: Self = Self(1 << 3);
    /// Absorption inside solids.
    pub const ABSORPTION: Self = Self(1 << 4);
    /// Emissive triangles.
    pub const AREA_LIGHTS: Self = Self(1 << 5);
    /// Point lights.
    pub const POINT_LIGHTS: Self = Self(1 << 6);
    /// Spot lights.
    pub const SPOT_LIGHTS: Self = Self(1 << 7);
    /// Directional lights.
    pub const DIRECTIONAL_LIGHTS: Self = Self(1 << 8);
    /// Textures on colours or on emission.
    pub const TEXTURES: Self = Self(1 << 9);
    /// Shading normals that differ from the geometric ones: vertex normals or normal maps.
    pub const SHADING_NORMALS: Self = Self(1 << 10);
    /// Normal maps.
    pub const NORMAL_MAPS: Self = Self(1 << 11);
    /// Vertex colours.
    pub const VERTEX_COLORS: Self = Self(1 << 12);
    /// Area lights whose emission is textured.
    pub const TEXTURED_LIGHTS: Self = Self(1 << 13);
    /// All features.
    pub const ALL: Self = Self((1 << 14) - 1);
    /// All that shading reads vertex attributes or textures for.
    pub const SHADED: Self =
        Self(Self::TEXTURES.0 | Self::SHADING_NORMALS.0 | Self::NORMAL_MAPS.0 | Self::VERTEX_COLORS.0);
    /// All lobes that are not diffuse.
    pub const SPECULAR: Self = Self(Self::MIRROR.0 | Self::DIELECTRIC.0 | Self::THIN.0);

    const NAMES: [&'static str; 14] = [
        "diffuse",
        "mirror",
        "dielectric",
        "thin",
        "absorption",
        "area-lights",
        "point-lights",
        "spot-lights",
        "directional-lights",
        "textures",
        "shading-normals",
        "normal-maps",
        "vertex-colors",
        "textured-lights",
    ];

    /// The bits, for a const generic or a specialization constant.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The set with these bits; unknown bits are ignored.
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits & Self::ALL.0)
    }

    /// Whether all features of `other` are included.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether any feature of `other` is included.
    #[must_use]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether camera paths may split in two: at glass, which reflects and transmits.
    #[must_use]
    pub const fn splits_camera_paths(self) -> bool {
        self.intersects(Self::DIELECTRIC.union(Self::THIN))
    }

    /// The union of both sets.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The features that are not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Names of the included features, in fixed order.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::NAMES.into_iter().enumerate().filter(move |(bit, _)| self.0 >> bit & 1 == 1).map(|(_, name)| name)
    }
}

impl fmt::Display for Features {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut between = "";
        for name in self.names() {
            write!(f, "{between}{name}")?;
            between = ", ";
        }
        if self.0 == 0 { write!(f, "nothing") } else { Ok(()) }
    }
}

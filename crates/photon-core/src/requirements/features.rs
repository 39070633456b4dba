//! What a scene can ask a kernel to do.

use std::fmt;

/// A set of things that kernels model.
///
/// CPU kernels take it as a const generic, Vulkan kernels as specialization constant 0: what is
/// not in it is not compiled in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Features(u32);

impl Features {
    /// Nothing.
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
    /// All of them.
    pub const ALL: Self = Self((1 << 9) - 1);
    /// Every lobe that is not diffuse.
    pub const SPECULAR: Self = Self(Self::MIRROR.0 | Self::DIELECTRIC.0 | Self::THIN.0);

    const NAMES: [&'static str; 9] = [
        "diffuse",
        "mirror",
        "dielectric",
        "thin",
        "absorption",
        "area-lights",
        "point-lights",
        "spot-lights",
        "directional-lights",
    ];

    /// The bits, for a const generic or a specialization constant.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The set with these bits; unknown ones are dropped.
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits & Self::ALL.0)
    }

    /// Whether all of `other` is in it.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether any of `other` is in it.
    #[must_use]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether camera paths may split in two, where glass reflects and transmits.
    #[must_use]
    pub const fn splits_camera_paths(self) -> bool {
        self.intersects(Self::DIELECTRIC.union(Self::THIN))
    }

    /// Both sets.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// What is in it and not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Names of its members, in fixed order.
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

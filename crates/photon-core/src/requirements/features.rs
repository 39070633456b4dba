//! Features of a scene that kernels have to support.

use std::fmt;

use bitflags::{Flags, bitflags};

bitflags! {
    /// A set of features that kernels support.
    ///
    /// CPU kernels take its bits as a const generic, Vulkan kernels as specialization constant 0: features that are
    /// not in it are not compiled in.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Features: u32 {
        /// Lambertian surfaces.
        const DIFFUSE = 1;
        /// Perfect mirrors.
        const MIRROR = 1 << 1;
        /// Boundaries of refracting solids.
        const DIELECTRIC = 1 << 2;
        /// Refracting sheets without thickness.
        const THIN = 1 << 3;
        /// Absorption inside solids.
        const ABSORPTION = 1 << 4;
        /// Emissive triangles.
        const AREA_LIGHTS = 1 << 5;
        /// Point lights.
        const POINT_LIGHTS = 1 << 6;
        /// Spot lights.
        const SPOT_LIGHTS = 1 << 7;
        /// Directional lights.
        const DIRECTIONAL_LIGHTS = 1 << 8;
        /// Textures on colours or on emission.
        const TEXTURES = 1 << 9;
        /// Shading normals that differ from the geometric ones: vertex normals or normal maps.
        const SHADING_NORMALS = 1 << 10;
        /// Normal maps.
        const NORMAL_MAPS = 1 << 11;
        /// Vertex colours.
        const VERTEX_COLORS = 1 << 12;
        /// Area lights whose emission varies over their surface: by a texture, or by alpha.
        const TEXTURED_LIGHTS = 1 << 13;
        /// An environment map.
        const ENVIRONMENT = 1 << 14;
        /// Glossy reflection: rough metals and coats.
        const GLOSSY = 1 << 15;
        /// Rough glass: GGX reflection and transmission.
        const ROUGH_GLASS = 1 << 16;
        /// Surfaces that are only partly there: alpha coverage.
        const ALPHA = 1 << 17;
        /// More lights than shadow rays weigh one by one: [`crate::light_tree`].
        const LIGHT_TREE = 1 << 18;
        /// A camera with a lens: decided with the view, not with the scene.
        const THIN_LENS = 1 << 19;
        /// Coats with a specular colour.
        const SPECULAR_COLORS = 1 << 20;
        /// Clearcoats.
        const CLEARCOAT = 1 << 21;
        /// A directional light with a disc, which camera rays see and which softens shadows.
        const SUN = 1 << 22;
        /// Anisotropic reflection.
        const ANISOTROPY = 1 << 23;
        /// Diffuse transmission through sheets: leaves, paper, cloth.
        const DIFFUSE_TRANSMISSION = 1 << 24;
        /// Clearcoats with normals of their own.
        const CLEARCOAT_NORMALS = 1 << 25;
        /// Emission under clearcoats.
        const COATED_LIGHTS = 1 << 26;
        /// Sheen: cloth.
        const SHEEN = 1 << 27;
        /// Surfaces that are partly glass: [`crate::partial_transmission`].
        const PARTIAL_TRANSMISSION = 1 << 28;
        /// Portals, and a light infinitely far away: [`crate::portals`].
        const PORTALS = 1 << 29;
    }
}

impl Features {
    /// No features.
    pub const NONE: Self = Self::empty();
    /// All features.
    pub const ALL: Self = Self::all();
    /// Those of [`Self::SHADED`] that diffuse surfaces may have.
    pub const MATTE: Self =
        Self::TEXTURES.union(Self::SHADING_NORMALS).union(Self::NORMAL_MAPS).union(Self::VERTEX_COLORS);
    /// All that shading reads tables for: vertex attributes, textures, and the albedos of glossy surfaces.
    pub const SHADED: Self = Self::TEXTURES
        .union(Self::SHADING_NORMALS)
        .union(Self::NORMAL_MAPS)
        .union(Self::VERTEX_COLORS)
        .union(Self::GLOSSY)
        .union(Self::ROUGH_GLASS)
        .union(Self::SPECULAR_COLORS)
        .union(Self::CLEARCOAT)
        .union(Self::ANISOTROPY)
        .union(Self::DIFFUSE_TRANSMISSION)
        .union(Self::CLEARCOAT_NORMALS)
        .union(Self::SHEEN);
    /// Where a random word of the ray decides what it meets: whether a surface is there, or which of its materials.
    pub const RANDOM_SURFACES: Self = Self::ALPHA.union(Self::PARTIAL_TRANSMISSION);
    /// Where camera paths sample lights, and go on.
    pub const FOLLOWED: Self = Self::GLOSSY.union(Self::ROUGH_GLASS);
    /// Light from infinitely far away.
    pub const INFINITE_LIGHTS: Self = Self::ENVIRONMENT.union(Self::DIRECTIONAL_LIGHTS);
    /// All lobes that are not diffuse.
    pub const SPECULAR: Self = Self::MIRROR.union(Self::DIELECTRIC).union(Self::THIN).union(Self::GLOSSY);

    /// Of each flag, in the order of the bits.
    const NAMES: [&'static str; Self::FLAGS.len()] = [
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
        "environment",
        "glossy",
        "rough-glass",
        "alpha",
        "light-tree",
        "thin-lens",
        "specular-colors",
        "clearcoat",
        "sun",
        "anisotropy",
        "diffuse-transmission",
        "clearcoat-normals",
        "coated-lights",
        "sheen",
        "partial-transmission",
        "portals",
    ];

    /// Whether camera paths may split in two: at glass, which reflects and transmits, and at glossy surfaces, where a
    /// query for the base is one branch, and the reflection the other.
    #[must_use]
    pub const fn splits_camera_paths(self) -> bool {
        self.intersects(Self::DIELECTRIC.union(Self::THIN).union(Self::GLOSSY))
    }

    /// Lights that no camera path can find: without extent.
    pub const DELTA_LIGHTS: Self = Self::POINT_LIGHTS.union(Self::SPOT_LIGHTS).union(Self::DIRECTIONAL_LIGHTS);

    /// The features that are not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        self.difference(other)
    }

    /// Names of the included features, in fixed order.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::NAMES.into_iter().zip(Self::ALL).filter(move |&(_, flag)| self.contains(flag)).map(|(name, _)| name)
    }
}

impl fmt::Display for Features {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut between = "";
        for name in self.names() {
            write!(f, "{between}{name}")?;
            between = ", ";
        }
        if self.is_empty() { write!(f, "nothing") } else { Ok(()) }
    }
}

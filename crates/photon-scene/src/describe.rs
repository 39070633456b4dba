//! What a user describes, in user space, in f64.
//!
//! Units are radiometric and per channel of linear RGB; lengths are whatever the user calls one
//! metre.

/// How a surface scatters light. Colours are linear RGB in `[0, 1]`.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// Scatters evenly on whichever side the light arrives.
    Lambert {
        /// Fraction of the light that is scattered.
        albedo: [f64; 3],
    },
    /// A perfect mirror on both sides.
    Mirror {
        /// Fraction of the light that is reflected.
        reflectance: [f64; 3],
    },
    /// The smooth boundary of a solid; its triangles must close it, and their fronts (where the
    /// vertices run counter-clockwise) face outwards.
    Dielectric {
        /// Refractive index inside, against the vacuum; finite and > 0. What is around the solid counts by itself, be it
        /// air or another solid.
        ior: f64,
        /// Absorption coefficient inside (Beer–Lambert), per user length, finite and ≥ 0.
        absorption: [f64; 3],
        /// Multiplies what is transmitted each time it crosses the boundary.
        tint: [f64; 3],
    },
    /// A smooth sheet without thickness, which light passes straight through.
    Thin {
        /// Refractive index of the sheet, finite and > 0.
        ior: f64,
        /// Multiplies what is transmitted.
        tint: [f64; 3],
    },
}

/// A named material: a surface, and what it emits.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDesc {
    /// What messages and override files call it; need not be unique.
    pub name: String,
    /// How it scatters.
    pub surface: Surface,
    /// Radiance that leaves it, the same in all directions, W/(m²·sr), finite and ≥ 0.
    pub emission: [f64; 3],
    /// Whether the back emits as well as the front.
    pub emits_both_sides: bool,
    /// Where solids overlap, the one of the highest priority is there; of equals, the one that light entered last. For
    /// [`Surface::Dielectric`] alone.
    pub priority: u32,
}

impl MaterialDesc {
    /// Any surface, dark.
    #[must_use]
    pub fn new(name: impl Into<String>, surface: Surface) -> Self {
        Self { name: name.into(), surface, emission: [0.0; 3], emits_both_sides: false, priority: 0 }
    }

    /// A diffuse surface.
    #[must_use]
    pub fn lambert(name: impl Into<String>, albedo: [f64; 3]) -> Self {
        Self::new(name, Surface::Lambert { albedo })
    }

    /// A mirror.
    #[must_use]
    pub fn mirror(name: impl Into<String>, reflectance: [f64; 3]) -> Self {
        Self::new(name, Surface::Mirror { reflectance })
    }

    /// Clear glass that fills a closed mesh.
    #[must_use]
    pub fn glass(name: impl Into<String>, ior: f64) -> Self {
        Self::new(name, Surface::Dielectric { ior, absorption: [0.0; 3], tint: [1.0; 3] })
    }

    /// A clear pane without thickness.
    #[must_use]
    pub fn thin(name: impl Into<String>, ior: f64) -> Self {
        Self::new(name, Surface::Thin { ior, tint: [1.0; 3] })
    }

    /// A diffuse surface whose front emits `radiance`, W/(m²·sr).
    #[must_use]
    pub fn emissive(name: impl Into<String>, albedo: [f64; 3], radiance: [f64; 3]) -> Self {
        Self { emission: radiance, ..Self::lambert(name, albedo) }
    }

    /// Whether it emits at all.
    #[must_use]
    pub fn is_emissive(&self) -> bool {
        self.emission != [0.0; 3]
    }

    /// Whether light passes it as if it were not there: an index of 1 that absorbs, tints and emits
    /// nothing.
    #[must_use]
    pub fn is_invisible(&self) -> bool {
        let clear = match self.surface {
            Surface::Dielectric { ior, absorption, tint } => ior == 1.0 && absorption == [0.0; 3] && tint == [1.0; 3],
            Surface::Thin { ior, tint } => ior == 1.0 && tint == [1.0; 3],
            Surface::Lambert { .. } | Surface::Mirror { .. } => false,
        };
        clear && !self.is_emissive()
    }
}

/// A light that is not a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum LightDesc {
    /// Shines evenly in all directions; its flux is `4π · intensity`.
    Point {
        /// User space.
        position: [f64; 3],
        /// Radiant intensity, W/sr, finite and ≥ 0.
        intensity: [f64; 3],
    },
    /// Shines within a cone. Between the two angles the intensity falls as the glTF extension
    /// `KHR_lights_punctual` defines: the square of
    /// `(cos θ − cos outer) / (cos inner − cos outer)`, clamped to `[0, 1]`.
    Spot {
        /// User space.
        position: [f64; 3],
        /// Axis of the cone, along which the light travels; not zero, need not be unit.
        direction: [f64; 3],
        /// Radiant intensity within the inner cone, W/sr, finite and ≥ 0.
        intensity: [f64; 3],
        /// Angle from the axis up to which the intensity is full, radians, ≥ 0.
        inner_angle: f64,
        /// Angle from the axis at which it has fallen to zero, radians, ≥ inner, in `(0, π/2]`.
        outer_angle: f64,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// Along which the light travels; not zero, need not be unit.
        direction: [f64; 3],
        /// Irradiance on a plane that faces it, W/m², finite and ≥ 0.
        irradiance: [f64; 3],
    },
}

/// How a camera maps directions or points to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays leave one point.
    Perspective {
        /// Angle between the picture's lower and upper edge, radians, in `(0, π)`.
        vertical_fov: f64,
    },
    /// Rays are parallel.
    Orthographic {
        /// Half the height of what the picture shows, user length, > 0.
        half_height: f64,
    },
}

/// A camera. The picture's width follows from its height and its shape in pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDesc {
    /// Where rays start, user space; may lie outside the scene.
    pub position: [f64; 3],
    /// Where it looks; not zero, need not be unit.
    pub direction: [f64; 3],
    /// What is upwards in the picture; not parallel to `direction`, need not be unit or at a right
    /// angle to it.
    pub up: [f64; 3],
    /// Perspective or orthographic.
    pub projection: Projection,
}

impl CameraDesc {
    /// A perspective camera at `from` that looks at `to`; `vertical_fov` in radians.
    #[must_use]
    pub fn look_at(from: [f64; 3], to: [f64; 3], up: [f64; 3], vertical_fov: f64) -> Self {
        let direction = std::array::from_fn(|axis| to[axis] - from[axis]);
        Self { position: from, direction, up, projection: Projection::Perspective { vertical_fov } }
    }
}

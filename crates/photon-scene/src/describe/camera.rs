//! Cameras.

/// How a camera maps directions or points to pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Projection {
    /// All rays start at one point.
    Perspective {
        /// Angle between the picture's lower and upper edge, radians, in `(0, π)`.
        vertical_fov: f64,
    },
    /// Rays are parallel.
    Orthographic {
        /// Half the height of the visible region, user length, > 0.
        half_height: f64,
    },
}

/// A camera. The width of the view follows from its height and the aspect ratio of the picture.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CameraDesc {
    /// Origin of the rays, user space; may lie outside the scene.
    pub position: [f64; 3],
    /// View direction; not zero, need not be unit.
    pub direction: [f64; 3],
    /// Up direction in the picture; not parallel to `direction`, need not be unit or perpendicular
    /// to it.
    pub up: [f64; 3],
    /// Perspective or orthographic.
    pub projection: Projection,
    /// A lens in place of the pinhole; perspective only.
    pub lens: Option<ThinLens>,
}

/// A thin lens around the position of a camera, perpendicular to its direction: what is not at the distance of focus is
/// blurred to discs. At distance z, their diameter is `diameter · |z − focus_distance| / focus_distance`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ThinLens {
    /// Diameter of the lens, length of the scene, at least 0; 0 is a pinhole.
    pub diameter: f64,
    /// Distance along the direction of view of the plane that is in focus, length of the scene, above 0.
    pub focus_distance: f64,
}

impl ThinLens {
    /// A lens with the given fields.
    #[must_use]
    pub const fn new(diameter: f64, focus_distance: f64) -> Self {
        Self { diameter, focus_distance }
    }
}

impl CameraDesc {
    /// A camera with the given fields.
    #[must_use]
    pub fn new(position: [f64; 3], direction: [f64; 3], up: [f64; 3], projection: Projection) -> Self {
        Self { position, direction, up, projection, lens: None }
    }

    /// A perspective camera at `from` that looks at `to`; `vertical_fov` in radians.
    #[must_use]
    pub fn look_at(from: [f64; 3], to: [f64; 3], up: [f64; 3], vertical_fov: f64) -> Self {
        let direction = std::array::from_fn(|axis| to[axis] - from[axis]);
        Self::new(from, direction, up, Projection::Perspective { vertical_fov })
    }

    /// The camera with another projection.
    #[must_use]
    pub fn with_projection(self, projection: Projection) -> Self {
        Self { projection, ..self }
    }

    /// The camera with a lens.
    #[must_use]
    pub fn with_lens(self, lens: ThinLens) -> Self {
        Self { lens: Some(lens), ..self }
    }
}

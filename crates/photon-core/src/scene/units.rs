//! Conversion between user space and watts, and normalised space and power.

/// The similarity transform between user space and normalised space, and the scene's total power.
///
/// Geometry is recentred and scaled to a unit box in f64 before it is converted to f32, and photons carry
/// fractions of the total power; both are converted back here, in f64. Therefore a scene of 10⁻¹⁸ or 10¹⁸
/// metres, or of 10²⁰ watts, is rendered as accurately as one of one metre and one watt.
// Exhaustive: written as a literal by callers that fill in a `SceneView`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Centre of the scene's bounding box, user space.
    pub center: [f64; 3],
    /// User-space length of one normalised unit, > 0.
    pub scale: f64,
    /// Total flux of the lights, mean of RGB, watts; > 0.
    pub power: f64,
}

impl Default for Units {
    /// User space is normalised space, and the lights emit one watt.
    fn default() -> Self {
        Self { center: [0.0; 3], scale: 1.0, power: 1.0 }
    }
}

impl Units {
    /// Converts a point from user space to normalised space.
    #[must_use]
    pub fn point(&self, user: [f64; 3]) -> [f32; 3] {
        std::array::from_fn(|axis| ((user[axis] - self.center[axis]) / self.scale) as f32)
    }

    /// Converts a point from normalised space to user space.
    #[must_use]
    pub fn point_to_user(&self, point: [f32; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| f64::from(point[axis]) * self.scale + self.center[axis])
    }

    /// Converts a length from user space to normalised space.
    #[must_use]
    pub fn length(&self, user: f64) -> f32 {
        (user / self.scale) as f32
    }

    /// Converts a length from normalised space to user space.
    #[must_use]
    pub fn length_to_user(&self, length: f32) -> f64 {
        f64::from(length) * self.scale
    }

    /// Factor from normalised radiance or irradiance to W/(m²·sr) or W/m².
    #[must_use]
    pub fn radiance_to_user(&self) -> f64 {
        // Two divisions, since the square of an extreme scale may overflow or underflow.
        self.power / self.scale / self.scale
    }
}

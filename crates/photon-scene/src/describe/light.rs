//! Lights that are not surfaces.

/// A light that is not a surface: point, spot or directional.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LightDesc {
    /// Emits equally in all directions; its flux is `4π · intensity`.
    Point {
        /// Position, user space.
        position: [f64; 3],
        /// Radiant intensity, W/sr, finite and ≥ 0.
        intensity: [f64; 3],
    },
    /// Emits within a cone. Between the two angles the intensity falls off as the glTF extension
    /// `KHR_lights_punctual` defines: the square of
    /// `(cos θ − cos outer) / (cos inner − cos outer)`, clamped to `[0, 1]`.
    Spot {
        /// Position, user space.
        position: [f64; 3],
        /// Axis of the cone, in which light travels; not zero, need not be unit.
        direction: [f64; 3],
        /// Radiant intensity within the inner cone, W/sr, finite and ≥ 0.
        intensity: [f64; 3],
        /// Angle from the axis up to which the intensity is full, radians, ≥ 0.
        inner_angle: f64,
        /// Angle from the axis at which the intensity reaches zero, radians, ≥ inner, in `(0, π/2]`.
        outer_angle: f64,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// Direction in which light travels; not zero, need not be unit.
        direction: [f64; 3],
        /// Irradiance on a plane perpendicular to the direction, W/m², finite and ≥ 0.
        irradiance: [f64; 3],
    },
}

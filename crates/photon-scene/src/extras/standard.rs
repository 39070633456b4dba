//! Vertex attributes as glTF has them: single precision, unit normals and tangents, finite numbers.
//!
//! The loader compares a file's attributes with these functions of the exact ones, to see whether they still agree.

use crate::shading::unit;

/// A unit vector; nearly unit ones are kept, others without a direction are 0.
pub(crate) fn normal(vector: [f64; 3]) -> [f32; 3] {
    const NEARLY: f64 = 5e-4;
    let length = glam::DVec3::from(vector).length();
    if (length - 1.0).abs() <= NEARLY {
        return vector.map(|part| part as f32);
    }
    unit(vector).map_or([0.0; 3], |unit| unit.as_vec3().to_array())
}

pub(crate) fn tangent([x, y, z, sign]: [f64; 4]) -> [f32; 4] {
    let [x, y, z] = normal([x, y, z]);
    [x, y, z, if sign < 0.0 { -1.0 } else { 1.0 }]
}

pub(crate) fn color(color: [f64; 4]) -> [f32; 4] {
    color.map(|part| part.clamp(0.0, 1.0) as f32)
}

pub(crate) fn uv(uv: [f64; 2]) -> [f32; 2] {
    // Coordinates that are not finite count as 0.
    uv.map(|part| if part.is_finite() { (part as f32).clamp(f32::MIN, f32::MAX) } else { 0.0 })
}

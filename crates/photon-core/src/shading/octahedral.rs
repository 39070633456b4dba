//! Unit vectors in 32 bits: octahedral mapping onto a square (Cigolle, Donow, Evangelakos, Mara, McGuire
//! and Meyer 2014), stored as two 16-bit signed numbers.

use glam::Vec3;

/// Steps from 0 to 1 in each coordinate of the square.
pub const STEPS: f32 = 32_767.0;

/// Packs a unit vector; vectors without a direction become +z.
#[inline]
#[must_use]
pub fn pack(v: Vec3) -> u32 {
    let sum = v.x.abs() + v.y.abs() + v.z.abs();
    if !(sum > 0.0 && sum.is_finite()) {
        return 0;
    }
    let (x, y) = (v.x / sum, v.y / sum);
    let (x, y) = if v.z < 0.0 {
        ((1.0 - y.abs()) * 1.0_f32.copysign(v.x), (1.0 - x.abs()) * 1.0_f32.copysign(v.y))
    } else {
        (x, y)
    };
    let quantise = |f: f32| (f.clamp(-1.0, 1.0) * STEPS + 0.5_f32.copysign(f)) as i32 as u32 & 0xFFFF;
    quantise(x) | quantise(y) << 16
}

/// Unpacks a unit vector; within 6.5·10⁻⁵ radians (√2 half steps at the centre of a face) of the original.
#[inline]
#[must_use]
pub fn unpack(packed: u32) -> Vec3 {
    let v = unpack_unnormalized(packed);
    v / v.length()
}

/// A vector of that direction with a length between 1/√3 and 1, without a division or a root: the same on every device.
#[inline]
#[must_use]
pub fn unpack_unnormalized(packed: u32) -> Vec3 {
    let x = f32::from(packed as u16 as i16) * (1.0 / STEPS);
    let y = f32::from((packed >> 16) as u16 as i16) * (1.0 / STEPS);
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    Vec3::new(x - fold.copysign(x), y - fold.copysign(y), z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_trip_is_close_everywhere() {
        let mut worst = 0.0_f64;
        for i in 0..200_000_u32 {
            // A spiral over the sphere.
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / 200_000.0;
            let angle = f64::from(i) * 2.399_963;
            let r = (1.0 - z * z).sqrt();
            let v = Vec3::new((r * angle.cos()) as f32, (r * angle.sin()) as f32, z as f32);
            let cross = v.as_dvec3().cross(unpack(pack(v)).as_dvec3()).length();
            worst = worst.max(cross);
        }
        assert!(worst < 6.5e-5, "{worst}");
    }

    #[test]
    fn axes_are_exact_and_nonsense_is_tame() {
        for v in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert_eq!(unpack(pack(v)), v);
        }
        for v in [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::INFINITY)] {
            assert_eq!(unpack(pack(v)), Vec3::Z);
        }
    }
}

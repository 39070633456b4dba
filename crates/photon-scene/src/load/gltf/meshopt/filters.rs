//! Filters of decoded attributes. Values outside of what the specification defines decode to some number.

/// Octahedral unit vectors of 8 or 16 bits for each component; the fourth component is kept.
pub(super) fn octahedral(bytes: &mut [u8], stride: usize) {
    match stride {
        4 => each(
            bytes,
            |v: [i8; 4]| octahedron(v.map(f32::from), 127.0).map(|x| x as i8),
            i8::from_le_bytes,
            i8::to_le_bytes,
        ),
        _ => each(
            bytes,
            |v: [i16; 4]| octahedron(v.map(f32::from), 32767.0).map(|x| x as i16),
            i16::from_le_bytes,
            i16::to_le_bytes,
        ),
    }
}

/// Unit quaternions without their largest component, of 16 bits for each component.
pub(super) fn quaternion(bytes: &mut [u8]) {
    each(bytes, unit_quaternion, i16::from_le_bytes, i16::to_le_bytes);
}

/// Floats as 8 bits of exponent and 24 of mantissa, both signed.
pub(super) fn exponential(bytes: &mut [u8]) {
    for value in bytes.as_chunks_mut::<4>().0 {
        let code = i32::from_le_bytes(*value);
        let (exponent, mantissa) = (code >> 24, code << 8 >> 8);
        // Exact: both powers of two are within the range of f64.
        let power = f64::from_bits(((1023 + exponent) as u64) << 52);
        *value = ((f64::from(mantissa) * power) as f32).to_le_bytes();
    }
}

/// Colours as luma and two chroma components, of 8 or 16 bits each.
pub(super) fn color(bytes: &mut [u8], stride: usize) {
    match stride {
        4 => each(
            bytes,
            |v: [u8; 4]| {
                let [y, co, cg, a] = v;
                rgb([i32::from(y), i32::from(co as i8), i32::from(cg as i8), i32::from(a)], 255.0).map(|x| x as u8)
            },
            u8::from_le_bytes,
            u8::to_le_bytes,
        ),
        _ => each(
            bytes,
            |v: [u16; 4]| {
                let [y, co, cg, a] = v;
                rgb([i32::from(y), i32::from(co as i16), i32::from(cg as i16), i32::from(a)], 65535.0).map(|x| x as u16)
            },
            u16::from_le_bytes,
            u16::to_le_bytes,
        ),
    }
}

/// Replaces each group of four numbers of `N` bytes.
fn each<T: Copy + Default, const N: usize>(
    bytes: &mut [u8],
    filter: impl Fn([T; 4]) -> [T; 4],
    read: fn([u8; N]) -> T,
    write: fn(T) -> [u8; N],
) {
    let mut numbers = bytes.as_chunks_mut::<N>().0.chunks_exact_mut(4);
    for group in &mut numbers {
        let filtered = filter(std::array::from_fn(|at| read(group[at])));
        group.iter_mut().zip(filtered).for_each(|(bytes, number)| *bytes = write(number));
    }
}

/// The unit vector of octahedral coordinates; the third component is 1 in their scale, `full` is 1 in that of the result.
fn octahedron([x, y, one, w]: [f32; 4], full: f32) -> [f32; 4] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let scale = full / (x * x + y * y + z * z).sqrt();
    [(x * scale).round(), (y * scale).round(), (z * scale).round(), w]
}

/// The quaternion whose largest component is left out; the fourth number is 1 in the scale of the others, its two lowest
/// bits are the number of that component.
fn unit_quaternion(code: [i16; 4]) -> [i16; 4] {
    let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(code[3] | 3);
    let [x, y, z] = [0, 1, 2].map(|at| f32::from(code[at]) * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let largest = (code[3] & 3) as usize;
    let mut quaternion = [0; 4];
    for (at, part) in [w, x, y, z].into_iter().enumerate() {
        quaternion[(largest + at) % 4] = (part * 32767.0).round() as i16;
    }
    quaternion
}

/// Red, green, blue and alpha of a colour as luma, orange, green and alpha; the highest bit of the latter is the scale of
/// all. `full` is 1 in the scale of the result.
fn rgb([y, co, cg, alpha]: [i32; 4], full: f32) -> [f32; 4] {
    let bits = 32 - alpha.leading_zeros();
    let one = (1 << bits.min(30)) - 1;
    let kept = alpha & (one >> 1);
    let alpha = kept << 1 | (kept & 1);
    let scale = full / one.max(1) as f32;
    [y + co - cg, y + cg, y - co - cg, alpha].map(|part| (part as f32 * scale).round())
}

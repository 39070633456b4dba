//! Colour spaces of FLIP. Linear RGB has the primaries and the white point (D65) of sRGB.

/// Linear RGB to CIE XYZ (IEC 61966-2-1).
const TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// Its inverse, by cofactors.
const FROM_XYZ: [[f64; 3]; 3] = {
    let m = TO_XYZ;
    let determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    let mut inverse = [[0.0; 3]; 3];
    let mut row = 0;
    while row < 3 {
        let mut column = 0;
        while column < 3 {
            let (a, b) = ((column + 1) % 3, (column + 2) % 3);
            let (c, d) = ((row + 1) % 3, (row + 2) % 3);
            inverse[row][column] = (m[a][c] * m[b][d] - m[a][d] * m[b][c]) / determinant;
            column += 1;
        }
        row += 1;
    }
    inverse
};

fn apply(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// XYZ relative to the white point.
fn relative_xyz(rgb: [f64; 3]) -> [f64; 3] {
    let (xyz, white) = (apply(TO_XYZ, rgb), apply(TO_XYZ, [1.0; 3]));
    std::array::from_fn(|axis| xyz[axis] / white[axis])
}

/// The linear opponent space YCxCz (Flohr et al. 1993).
pub(super) fn opponent(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The inverse of [`opponent`].
pub(super) fn opponent_to_rgb([luminance, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (luminance + 16.0) / 116.0;
    let white = apply(TO_XYZ, [1.0; 3]);
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    apply(FROM_XYZ, std::array::from_fn(|axis| relative[axis] * white[axis]))
}

/// CIE Lab with Hunt's adjustment: colours of dark pixels count less (equation 8).
pub(super) fn hunt_lab(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let curve = |t: f64| {
        if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [x, y, z] = relative_xyz(rgb).map(curve);
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// The distance HyAB of two colours in Lab (equation 9).
pub(super) fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_opponent_space_is_inverted() {
        for rgb in [[0.0; 3], [1.0; 3], [0.2, 0.5, 0.9], [1.0, 0.0, 0.0]] {
            for (back, there) in opponent_to_rgb(opponent(rgb)).into_iter().zip(rgb) {
                assert!((back - there).abs() < 1e-6, "{rgb:?}: {back}");
            }
        }
    }

    /// CIE 15: white has L* 100 and no chroma; the values of sRGB green and blue are known.
    #[test]
    fn lab_has_the_known_values() {
        let lab = |rgb| {
            let [l, a, b] = hunt_lab(rgb);
            [l, a / (0.01 * l), b / (0.01 * l)]
        };
        for (rgb, known) in [
            ([1.0; 3], [100.0, 0.0, 0.0]),
            ([0.0, 1.0, 0.0], [87.735, -86.18, 83.18]),
            ([0.0, 0.0, 1.0], [32.297, 79.19, -107.86]),
        ] {
            for (ours, theirs) in lab(rgb).into_iter().zip(known) {
                assert!((ours - theirs).abs() < 0.02, "{rgb:?}: {ours} {theirs}");
            }
        }
    }
}

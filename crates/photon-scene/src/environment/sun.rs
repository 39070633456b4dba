//! Irradiance from the sun through a clear atmosphere, after the appendix of Preetham, Shirley and Smits, "A Practical
//! Analytic Model for Daylight" (SIGGRAPH 1999).
//!
//! Left out are water vapour and mixed gases, which absorb above 690 nm, where the eye is nearly blind.

/// Solid angle of the sun's disc, of 0.5338° diameter.
const SOLID_ANGLE: f64 = 6.82e-5;

/// First wavelength of [`SPECTRUM`] and the distance between two, nm.
const WAVELENGTHS: (f64, f64) = (380.0, 10.0);

/// Radiance of the sun outside of the atmosphere, 100 W/(m²·sr·nm), and the absorption coefficient of ozone, 1/cm, from
/// 380 to 750 nm (tables 2 of the paper).
const SPECTRUM: [(f64, f64); 38] = [
    (165.5, 0.0),
    (162.3, 0.0),
    (211.2, 0.0),
    (258.8, 0.0),
    (258.2, 0.0),
    (242.3, 0.0),
    (267.6, 0.0),
    (296.6, 0.003),
    (305.4, 0.006),
    (300.6, 0.009),
    (306.6, 0.014),
    (288.3, 0.021),
    (287.1, 0.030),
    (278.2, 0.040),
    (271.0, 0.048),
    (272.3, 0.063),
    (263.6, 0.075),
    (255.0, 0.085),
    (250.6, 0.103),
    (253.1, 0.120),
    (253.5, 0.120),
    (251.3, 0.115),
    (246.3, 0.125),
    (241.7, 0.120),
    (236.8, 0.105),
    (232.1, 0.090),
    (228.2, 0.079),
    (223.4, 0.067),
    (219.7, 0.057),
    (215.3, 0.048),
    (211.0, 0.036),
    (207.3, 0.028),
    (202.4, 0.023),
    (198.7, 0.018),
    (194.3, 0.014),
    (190.7, 0.011),
    (186.3, 0.010),
    (182.6, 0.009),
];

/// Irradiance on a plane facing the sun, W/m², weighted by the CIE 1931 colour matching functions and converted from XYZ
/// to linear sRGB, with negative values set to 0. `elevation` in radians.
pub(super) fn irradiance(elevation: f64, turbidity: f64) -> [f64; 3] {
    // Relative optical mass (Kasten), from the angle to the zenith.
    let degrees = (90.0 - elevation.to_degrees()).clamp(0.0, 90.0);
    let mass = 1.0 / (libm::sin(elevation).max(0.0) + 0.15 * libm::pow(93.885 - degrees, -1.253));
    let aerosols = 0.046_083_658_220_5 * turbidity - 0.045_860_259_285_22;
    let (first, step) = WAVELENGTHS;
    let mut xyz = [0.0; 3];
    for (index, &(radiance, ozone)) in SPECTRUM.iter().enumerate() {
        let wavelength = first + step * index as f64;
        let micrometres = wavelength / 1000.0;
        let rayleigh = 0.008_735 * libm::pow(micrometres, -4.08);
        let mie = aerosols * libm::pow(micrometres, -1.3);
        // 0.35 cm of ozone at normal pressure.
        let transmitted = libm::exp(-mass * (rayleigh + mie + 0.35 * ozone));
        let matching = color_matching(wavelength);
        let spectral = 100.0 * radiance * transmitted * SOLID_ANGLE * step;
        xyz = std::array::from_fn(|c| xyz[c] + spectral * matching[c]);
    }
    linear_srgb(xyz).map(|c| c.max(0.0))
}

/// The CIE 1931 colour matching functions at a wavelength in nm, in the fit of Wyman, Sloan and Shirley, "Simple Analytic
/// Approximations to the CIE XYZ Color Matching Functions" (JCGT 2013).
fn color_matching(wavelength: f64) -> [f64; 3] {
    let lobe = |height: f64, center: f64, below: f64, above: f64| {
        let t = (wavelength - center) / if wavelength < center { below } else { above };
        height * libm::exp(-0.5 * t * t)
    };
    [
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    ]
}

/// Conversion from XYZ to linear RGB (IEC 61966-2-1).
fn linear_srgb([x, y, z]: [f64; 3]) -> [f64; 3] {
    [3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z, 0.0557 * x - 0.2040 * y + 1.0570 * z]
}

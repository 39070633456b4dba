//! Variance of shadow rays to environment maps: the table of `docs/studies/lights.md`.
//!
//! `environment FILE...` samples each image, and a dim map with one bright texel, as shadow rays do, and compares the
//! irradiance of planes that face along the axes with the integral over the texels.
#![expect(clippy::print_stdout, reason = "a program for measuring")]

use std::f64::consts::PI;
use std::path::Path;
use std::process::ExitCode;

use photon_core::EnvironmentMap;
use photon_core::glam::DVec3;
use photon_scene::{EnvironmentDesc, LoadReport};
use photonmap_cli::fault::{self, Fault};

/// Directions that are sampled of each map.
const SAMPLES: u32 = 1 << 20;
/// Solid angle of a small light source, sr, and the share of the flux from which on it would be a light of its own.
const SMALL: f64 = 1e-3;

/// Bound on the weight of a direction over the mean weight: a corner is at most four times as bright as the mean of its cell's
/// corners, and one 64th of the probability of rows and of columns is the same for all.
const BOUND: f64 = 4.0 * (64.0 / 63.0) * (64.0 / 63.0);

const AXES: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

fn main() -> ExitCode {
    fault::run(|| {
        println!("| map | in {SMALL} sr | bound | weight, largest | deviation of a ray, worst | greatest z |");
        println!("|---|---:|---:|---:|---:|---:|");
        for name in std::env::args().skip(1) {
            let desc = EnvironmentDesc::read(Path::new(&name), &mut LoadReport::default())?;
            let stem = Path::new(&name).file_stem().unwrap_or_default().to_string_lossy().into_owned();
            row(&stem, &desc.bake()?.map);
        }
        let (width, height) = (1024, 512);
        let mut texels = vec![[0.1_f32; 3]; width * height];
        texels[width * 150 + 700] = [1e5; 3];
        row("one bright texel", &EnvironmentMap::new(width, &texels, 0.0).map_err(Fault::from)?);
        Ok(())
    })
}

fn mean(color: [f32; 4]) -> f64 {
    f64::from(color[0] + color[1] + color[2]) / 3.0
}

fn row(name: &str, map: &EnvironmentMap) {
    let whole = 4.0 * PI * map.mean_radiance().iter().sum::<f64>() / 3.0;
    let mut random = 0x9E37_79B9_7F4A_7C15_u64;
    let mut word = || {
        random = random.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (random ^ random >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    };
    let (mut sums, mut squares, mut largest) = ([0.0; 6], [0.0; 6], 0.0_f64);
    for _ in 0..SAMPLES {
        let word = word();
        let sample = map.sample([word as u32, (word >> 32) as u32]);
        let weight = f64::from(sample.weight.element_sum()) / 3.0;
        largest = largest.max(weight / whole);
        for (axis, normal) in AXES.iter().enumerate() {
            let value = weight * normal.dot(sample.direction.as_dvec3()).max(0.0);
            sums[axis] += value;
            squares[axis] += value * value;
        }
    }
    let count = f64::from(SAMPLES);
    let (mut worst, mut greatest) = (0.0_f64, 0.0_f64);
    for axis in 0..6 {
        let truth = quadrature(map, AXES[axis]);
        let found = sums[axis] / count;
        let deviation = (squares[axis] / count - found * found).max(0.0).sqrt();
        worst = worst.max(deviation / truth);
        greatest = greatest.max((found - truth).abs() / (deviation / count.sqrt()));
    }
    println!(
        "| {name} | {:.1} % | {BOUND:.2} | {largest:.2} | {worst:.2} | {greatest:.2} |",
        100.0 * brightest(map) / whole
    );
}

/// Irradiance of a plane by the midpoint rule, with 3² points in each texel.
fn quadrature(map: &EnvironmentMap, normal: DVec3) -> f64 {
    let (width, height) = (3 * map.width(), 3 * map.height());
    let mut sum = 0.0;
    for row in 0..height {
        let v = (f64::from(row) + 0.5) / f64::from(height);
        let (sin, cos) = (PI * v).sin_cos();
        for column in 0..width {
            let u = (f64::from(column) + 0.5) / f64::from(width);
            let phi = 2.0 * PI * (u - f64::from(map.rotation()) - 0.5);
            let cosine = normal.dot(DVec3::new(phi.sin() * sin, cos, -phi.cos() * sin));
            if cosine > 0.0 {
                sum += cosine * sin * f64::from(map.bilinear(u as f32, v as f32).element_sum()) / 3.0;
            }
        }
    }
    sum * (PI / f64::from(height)) * (2.0 * PI / f64::from(width))
}

/// Flux per area of the brightest texels that together span [`SMALL`] steradians.
fn brightest(map: &EnvironmentMap) -> f64 {
    let (width, height) = (map.width() as usize, f64::from(map.height()));
    let solid = |row: usize| (PI * (row as f64 + 0.5) / height).sin() * (PI / height) * (2.0 * PI / width as f64);
    let mut texels: Vec<(f64, f64)> =
        map.texels().iter().enumerate().map(|(i, &texel)| (mean(texel), solid(i / width))).collect();
    texels.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let (mut flux, mut left) = (0.0, SMALL);
    for (radiance, solid) in texels {
        let part = solid.min(left);
        flux += radiance * part;
        left -= part;
        if left <= 0.0 {
            break;
        }
    }
    flux
}

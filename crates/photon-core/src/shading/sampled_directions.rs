//! G6: χ² of sampled directions against the integral of their density, for metals and rough glass.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec3;

use crate::random::{SplitMix64, unit_f32};
use crate::scene::material::{Material, MaterialKind};
use crate::shading::fresnel::{fresnel, refract};
use crate::shading::glossy::Glossy;
use crate::shading::layers::Layers;
use crate::shading::rough_glass::RoughGlass;
use crate::shading::rough_glass::tests::{boundary, material, table};
use crate::shading::sampling;

const ROWS: usize = 12;
const COLUMNS: usize = 8;
/// Points of the midpoint rule along each side of a cell.
const FINE: usize = 24;
const SAMPLES: u32 = 200_000;

/// Cells of all directions around an axis: of equal azimuth, and of equal ψ, where the tangent of half the angle from the axis
/// is `width` tan ψ, so that half of the cells are within about two widths.
struct Cells {
    axis: Vec3,
    width: f32,
    counts: [f64; ROWS * COLUMNS],
}

impl Cells {
    fn new(axis: Vec3, width: f32) -> Self {
        Self { axis, width, counts: [0.0; ROWS * COLUMNS] }
    }

    fn count(&mut self, direction: Vec3) {
        let (x, y) = sampling::basis(self.axis);
        let (along, across) = (direction.dot(self.axis), direction.cross(self.axis).length());
        let psi = (across / (1.0 + along) / self.width).atan();
        let turns = direction.dot(y).atan2(direction.dot(x)) / TAU;
        let row = ((psi / FRAC_PI_2 * ROWS as f32) as usize).min(ROWS - 1);
        let column = (((turns + 1.0).fract() * COLUMNS as f32) as usize).min(COLUMNS - 1);
        self.counts[row * COLUMNS + column] += 1.0;
    }

    /// Σ (n − e)²/e of all samples for this density, and a bound: the number of cells plus 4.5 standard deviations, √(2 cells), which
    /// one seed in 16 000 exceeds with 97 cells, and one in 2500 with 20 (Wilson and Hilferty 1931). Cells of fewer than 10 expected directions count as one.
    fn statistic(&self, density: impl Fn(Vec3) -> f32) -> (f64, f64) {
        let (x, y) = sampling::basis(self.axis);
        let (mut sum, mut cells, mut rest) = (0.0, 0.0_f64, [0.0, 0.0]);
        let mut add = |count: f64, expected: f64| {
            sum += (count - expected) * (count - expected) / expected;
            cells += 1.0;
        };
        for (cell, &count) in self.counts.iter().enumerate() {
            let mut expected = 0.0;
            for k in 0..FINE * FINE {
                let part = |at: usize, k: usize, of: usize| (at as f32 + (k as f32 + 0.5) / FINE as f32) / of as f32;
                let psi = FRAC_PI_2 * part(cell / COLUMNS, k / FINE, ROWS);
                let (sin, cos) = (TAU * part(cell % COLUMNS, k % FINE, COLUMNS)).sin_cos();
                // Of t = tan(γ/2): sin γ dγ = 4 t / (1 + t²)² dt, and dt = (w² + t²)/w dψ.
                let t = self.width * psi.tan();
                let scale = 1.0 / (1.0 + t * t);
                let direction = self.axis * ((1.0 - t * t) * scale) + (x * cos + y * sin) * (2.0 * t * scale);
                let solid = 4.0 * t * scale * scale * (self.width * self.width + t * t) / self.width;
                expected += f64::from(density(direction.normalize_or_zero()) * solid);
            }
            let area = f64::from(FRAC_PI_2 * TAU) / (ROWS * COLUMNS * FINE * FINE) as f64;
            expected *= area * f64::from(SAMPLES);
            if expected < 10.0 {
                rest = [rest[0] + count, rest[1] + expected];
            } else {
                add(count, expected);
            }
        }
        if rest[1] > 0.0 {
            add(rest[0], rest[1].max(1.0));
        }
        (sum, cells + 4.5 * (2.0 * cells).sqrt())
    }

    /// Asserts that the directions are of this density, and not of one that is larger by 20/√n, 20 standard errors of their
    /// number, nor of `other`.
    fn assert_of(&self, what: &str, density: impl Fn(Vec3) -> f32, other: impl Fn(Vec3) -> f32) {
        let (found, most) = self.statistic(&density);
        assert!(found < most, "{what}: {found} of {most}");
        let larger = 1.0 + 20.0 / self.counts.iter().sum::<f64>().sqrt() as f32;
        for (found, most) in [self.statistic(|w| larger * density(w)), self.statistic(other)] {
            assert!(found > most, "{what}: a density that is off is found: {found} of {most}");
        }
    }
}

fn towards(cosine: f32) -> Vec3 {
    sampling::about(Vec3::Z, 1.0 - cosine, 0.2)
}

#[test]
fn reflected_directions_have_their_density() {
    for alpha in [0.01_f32, 0.25, 1.0] {
        for cosine in [0.9_f32, 0.3] {
            let metal = |alpha: f32| {
                let (kind, metallic, roughness) = (MaterialKind::Glossy as u32, 1.0, alpha.sqrt());
                let material =
                    Material { kind, albedo: [0.9; 3], metallic, roughness, ior: 1.5, ..Material::default() };
                Glossy::new(&material, &Layers::NONE, cosine)
            };
            let (wo, found, other) = (towards(cosine), metal(alpha), metal(0.9 * alpha));
            let mut cells = Cells::new(Vec3::new(-wo.x, -wo.y, wo.z), alpha);
            let mut numbers = SplitMix64(3);
            let mut number = || unit_f32(numbers.word() as u32);
            for _ in 0..SAMPLES {
                let (wi, _) = found.sample(wo, Vec3::Z, number(), number());
                // Those below the surface are lost.
                if wi.z > 0.0 {
                    cells.count(wi);
                }
            }
            let density = |glossy: Glossy| move |wi| glossy.evaluate(wo, wi, Vec3::Z).pdf;
            cells.assert_of(&format!("{alpha} {cosine}"), density(found), density(other));
        }
    }
}

#[test]
fn directions_at_rough_glass_have_their_density() {
    let table = table(1.5);
    for (kind, eta) in
        [(MaterialKind::Dielectric, 1.5), (MaterialKind::Dielectric, 1.0 / 1.5), (MaterialKind::Thin, 1.5)]
    {
        for alpha in [0.01_f32, 0.25, 1.0] {
            let cosine = 0.8;
            let wo = towards(cosine);
            let glass = |alpha: f32| {
                let material = material(kind, alpha.sqrt(), 1.5);
                RoughGlass::new(&table, &material, cosine, &boundary(eta)).expect("rough")
            };
            let (found, other) = (glass(alpha), glass(0.9 * alpha));
            let straight = if kind == MaterialKind::Thin {
                -wo
            } else {
                refract(-wo, Vec3::Z, eta, fresnel(cosine, eta).cos_transmitted)
            };
            let axes = [Vec3::new(-wo.x, -wo.y, wo.z), straight];
            // A microfacet turns what it transmits by less than what it reflects.
            let mut cells = [Cells::new(axes[0], alpha), Cells::new(axes[1], 0.3 * alpha)];
            let mut numbers = SplitMix64(5);
            let mut number = || unit_f32(numbers.word() as u32);
            for _ in 0..SAMPLES {
                let sampled = found.sample(&table, wo, Vec3::Z, [number(), number(), number()]);
                if sampled.found.pdf > 0.0 {
                    cells[usize::from(sampled.direction.z < 0.0)].count(sampled.direction);
                }
            }
            for (side, cells) in cells.iter().enumerate() {
                let density = |glass: RoughGlass| {
                    let table = &table;
                    move |wi: Vec3| {
                        let is_there = usize::from(wi.z < 0.0) == side;
                        if is_there { glass.evaluate(table, wo, wi, Vec3::Z).pdf } else { 0.0 }
                    }
                };
                cells.assert_of(&format!("{kind:?} {eta} {alpha}, side {side}"), density(found), density(other));
            }
        }
    }
}

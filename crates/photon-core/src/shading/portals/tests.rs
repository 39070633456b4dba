use super::*;
use crate::random::{SplitMix64, unit_f32};

const RADIUS: f32 = 0.8;

fn triangle(corners: [[f64; 3]; 3]) -> Portal {
    Portal::new(corners)
}

/// Two halves of a rectangle of 0.3 × 0.2 in a plane through `at`.
fn window(at: [f64; 3]) -> [Portal; 2] {
    let corner = |x: f64, y: f64| [at[0] + x, at[1] + y, at[2] + 0.5 * x];
    let [a, b, c, d] = [corner(0.0, 0.0), corner(0.3, 0.0), corner(0.3, 0.2), corner(0.0, 0.2)];
    [triangle([a, b, c]), triangle([a, c, d])]
}

/// Portals: one opening; two that overlap, one of them twice; one that reaches beyond the disc; the greatest number.
fn cases() -> Vec<Vec<Portal>> {
    let one = window([-0.1, 0.1, -0.2]);
    let overlapping = [one, window([0.0, 0.2, 0.3]), one].concat();
    let large = vec![triangle([[-1.5, -0.4, 0.1], [1.4, -0.3, 0.2], [0.2, 1.6, -0.5]])];
    let many = (0..Portal::MAX / 2).flat_map(|i| window([0.02 * i as f64 - 0.4, 0.1, 0.01 * i as f64])).collect();
    vec![one.to_vec(), overlapping, large, many]
}

fn directions() -> [Vec3; 3] {
    [Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.48, -0.64, 0.6), Vec3::new(-0.96, -0.28, 0.0)]
}

/// z-score of the mean of `factor` over lines within 0.25 of one that passes through the first portals, whose expectation
/// is the share of that disc in the one that lines start from, (0.25 / R)², whatever the portals.
fn score(portals: &[Portal], direction: Vec3, factor: impl Fn(&PortalLine) -> f32) -> f64 {
    let middle = Vec3::new(0.1, 0.15, 0.0).reject_from_normalized(direction);
    let inside = |across: Vec3| across.distance(middle) < 0.25;
    let mut words = SplitMix64(3);
    let count = 200_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..count {
        let (a, b) = (words.word(), words.word());
        let line = sample(portals, direction, a as u32, [unit_f32((a >> 32) as u32), unit_f32(b as u32)], RADIUS);
        let value = if inside(line.across) { f64::from(factor(&line)) } else { 0.0 };
        (sum, squares) = (sum + value, squares + value * value);
    }
    let mean = sum / f64::from(count);
    let truth = f64::from(0.25 / RADIUS).powi(2);
    (mean - truth) / ((squares / f64::from(count) - mean * mean) / f64::from(count)).sqrt()
}

/// Whatever the portals, each region gets its share of the flux: |z| ≤ 4.5.
#[test]
fn expectations_do_not_depend_on_portals() {
    for portals in cases() {
        for direction in directions() {
            let z = score(&portals, direction, |line| line.factor);
            assert!(z.abs() <= 4.5, "{direction}, {} portals: {z}", portals.len());
        }
    }
}

/// Where portals overlap, weights that count a line once, instead of once per portal, are found to be wrong.
#[test]
fn counting_a_line_once_is_wrong_where_portals_overlap() {
    let portals = &cases()[1];
    let direction = directions()[0];
    let once = |line: &PortalLine| {
        let total = total_area(portals, direction);
        let count = f32::from(u8::from(portals.iter().any(|portal| crosses(portal, line.across, direction))));
        let disc = std::f32::consts::PI * RADIUS * RADIUS;
        total / (DISC_SHARE * total + (1.0 - DISC_SHARE) * count * disc)
    };
    assert!(score(portals, direction, once).abs() > 20.0);
}

/// Lines lie in the plane across their direction, and a share of them as expected goes through the portal.
#[test]
fn lines_pass_through_portals() {
    let portals = window([-0.1, 0.1, -0.2]);
    for direction in directions() {
        let mut words = SplitMix64(5);
        let (mut through, count) = (0, 100_000);
        for _ in 0..count {
            let (a, b) = (words.word(), words.word());
            let point = [unit_f32((a >> 32) as u32), unit_f32(b as u32)];
            let PortalLine { across, factor } = sample(&portals, direction, a as u32, point, RADIUS);
            assert!(across.dot(direction).abs() < 1e-6 && factor > 0.0 && factor <= 1.0 / DISC_SHARE);
            through += u32::from(portals.iter().any(|portal| crosses(portal, across, direction)));
        }
        // All of the second technique, and a/(πR²) of the first.
        let part = f64::from(total_area(&portals, direction) / (std::f32::consts::PI * RADIUS * RADIUS));
        let expected = 0.5 + 0.5 * part;
        let found = f64::from(through) / f64::from(count);
        let error = (expected * (1.0 - expected) / f64::from(count)).sqrt();
        assert!((found - expected).abs() < 4.5 * error, "{direction}: {found} instead of {expected}");
    }
}

/// Portals that are seen edge-on leave the disc alone, and one among others is never chosen.
#[test]
fn portals_seen_edge_on_are_not_used() {
    let flat = triangle([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0]]);
    let along = Vec3::X;
    for choice in [0, DISC_WORDS, u32::MAX] {
        let alone = sample(&[flat], along, choice, [0.3, 0.6], RADIUS);
        assert_eq!(alone.factor, 1.0);
        assert!(!crosses(&flat, alone.across, along) || alone.across.length() < 1e-6);
    }
    let facing = triangle([[0.1, 0.0, 0.0], [0.1, 0.2, 0.0], [0.1, 0.0, 0.2]]);
    for portals in [[flat, facing], [facing, flat]] {
        for choice in [DISC_WORDS, DISC_WORDS + (1 << 30), u32::MAX] {
            let line = sample(&portals, along, choice, [0.3, 0.6], RADIUS);
            assert!(crosses(&facing, line.across, along) && line.factor < 1.0);
        }
    }
}

/// Halves of a window have its area, and its normal.
#[test]
fn areas_are_those_of_the_triangles() {
    let [first, second] = window([0.0; 3]);
    // Edges (0.3, 0, 0.15) and (0, 0.2, 0): the cross product is (−0.03, 0, 0.06).
    for portal in [first, second] {
        let difference = Vec3::from(portal.area) - Vec3::new(-0.015, 0.0, 0.03);
        assert!(difference.length() < 1e-8, "{difference}");
    }
}

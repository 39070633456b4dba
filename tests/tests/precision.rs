//! A quick part of the precision study: checks what its tables promise, and that deviations are detected.

use photon_tests::precision::shipped::{Pair, studio};
use photon_tests::precision::{Table, fields, quantile, stages, sweeps};

/// Half a unit in the last place of a coordinate in `[1/4, 1/2]`, as the diagonal of three coordinates: `√3·2⁻²⁶`.
const PLACE: f64 = 2.6e-8;

#[test]
fn every_stage_keeps_its_digits() {
    let table = stages::all(5000);
    let worst = |start: &str| {
        let row = table.rows.iter().find(|(name, _)| name.starts_with(start));
        row.unwrap_or_else(|| panic!("no row {start:?}")).1[2]
    };
    let most = |start: &str| table.rows.iter().find(|(name, _)| name.starts_with(start)).unwrap().1[1];
    assert!(worst("normalisation: a vertex") <= PLACE);
    // The components of a unit vector are rounded by 2⁻²⁵ at most.
    assert!(worst("normalisation: a normal") <= 2.0 * 3.0e-8 * 3.0_f64.sqrt());
    // About ten roundings of numbers below 1, each of 2⁻²⁵ or less, as vectors. The origin keeps two steps from the
    // area light's edges, which shows in the maximum.
    assert!(most("emission: origin") < 10.0 * PLACE);
    for row in ["emission: direction", "bounce: diffuse", "bounce: mirrored", "hit: position, off"] {
        assert!(worst(row) < 10.0 * PLACE, "{row} {}", worst(row));
    }
    // Divided by the projected area of the triangle: grazing rays have fewer digits.
    assert!(most("hit: distance") < 4e-7 && most("hit: position, along") < 4e-7);
    // Divided by cosines.
    assert!(worst("glass, ior 1.5: reflectance") < 1e-6 && worst("glass, ior 1.5: refracted") < 1e-6);
    // The accuracy that `octahedral` promises.
    assert!(worst("photon: direction") < 6.5e-5);
    // Two roundings at each of 16 surfaces.
    assert!(worst("path: power") < 32.0 * 6e-8);
    // 10⁶ roundings of 2⁻⁵³, all in the same direction.
    assert!(worst("film") < 1e6 * 1.2e-16);
}

#[test]
fn a_detail_of_a_thousandth_holds_and_one_of_a_hundred_thousandth_does_not() {
    let table = sweeps::detail(&[1.0, 1e3, 1e5], 10_000);
    let at = |row: &str, name: &str| table.at(row, table.column(name));
    let (off, flux, error) = ("99 of 100", "flux onto the floor, relative", "± standard error");
    // The offset from surfaces, 2⁻²⁰ of the scene, shifts the photons that leave the area light.
    assert!(at("1e0", off) < 1e-5 && at("1e3", off) < 1e-2);
    for ratio in ["1e0", "1e3"] {
        assert!(at(ratio, flux).abs() < 4.5 * at(ratio, error) + 3e-3, "{ratio}: {}", at(ratio, flux));
        assert_eq!(at(ratio, "paths out of the closed room"), 0.0);
        assert!(at(ratio, "shadow rays that differ") < 2e-3);
    }
    // A known limit: if it has moved, the document is out of date.
    assert!(at("1e5", flux) < -4.5 * at("1e5", error), "{}", at("1e5", flux));
    assert!(at("1e5", "paths out of the closed room") > 0.0);
}

/// Negative control: an area light moved by a hundred-thousandth of the room is detected.
#[test]
fn an_area_light_beside_its_place_is_seen() {
    let here = studio(1.0, 0.0, 0.6);
    let median = |described| {
        let pair = Pair::new(&here, described, 2000, 4);
        let mut apart: Vec<f64> = pair.at(0).iter().map(|meeting| 0.5 * meeting.apart).collect();
        quantile(&mut apart, 0.5)
    };
    let mut moved = here.clone();
    if let photon_scene::LightDesc::Point { position, .. } = &mut moved.lights[0] {
        position[0] += 2e-5;
    }
    assert!(median(&here) < 5e-7, "{}", median(&here));
    assert!(median(&moved) > 2e-6, "{}", median(&moved));
}

#[test]
fn paths_stay_together_for_many_bounces() {
    let table = sweeps::path(&[2, 8, 16], 4000);
    assert!(table.at("2", 0) < 2e-3 && table.at("16", 0) < 0.05, "{}", table.markdown());
    assert!(table.at("2", 1) < 5e-6 && table.at("8", 1) < 5e-5, "{}", table.markdown());
    assert!(table.at("16", 4) < 1e-6);
}

#[test]
fn estimates_hold_down_to_a_radius_of_a_ten_thousandth() {
    let figures: Table = fields::radius(2..=7, 60);
    // Twice the spacing of rounded positions over the radius, relative to the photons near the boundary.
    assert!(figures.at("1e-2", 0) < 1e-5 && figures.at("1e-4", 0) < 1e-3, "{}", figures.markdown());
    // A known limit: below 2⁻²⁰ of the scene the radius is clamped.
    assert!(figures.at("1e-7", 0) > 0.5, "{}", figures.markdown());
    let sums = fields::photons(1..=4, 20);
    assert!(sums.rows.iter().all(|(_, errors)| errors[0] < 1e-6), "{}", sums.markdown());
}

#[test]
fn grazing_rays_and_indices_near_one() {
    let table = stages::grazing(2000);
    for (angle, figures) in &table.rows {
        assert!(figures[1] < 3e-7 && figures[3] == 0.0 && figures[4] < 1e-6, "{angle}");
    }
    let table = stages::near_one();
    assert!(table.at("1 + 1e-3", 2) < 1e-3 && table.at("1 + 1e-7", 2) > 0.05);
}

//! Where f32 becomes insufficient: by the size of a detail, the distance from the origin, and the length of a path.

use photon_core::glam::{DVec3, Vec3};
use photon_core::{Ray, RayCaster, offset};
use photon_scene::Accel;

use super::shipped::{Pair, flux, studio, twins, upward};
use super::{Table, quantile};
use crate::twin::{Described, Wide};

/// A room in the corner of the scene, for each ratio of their sizes.
#[must_use]
pub fn detail(ratios: &[f64], paths: u32) -> Table {
    let columns = [
        "scene / room",
        "first landing is off by, rooms, median",
        "99 of 100",
        "paths diverged at the first landing",
        "at the fourth",
        "flux onto the floor, relative",
        "± standard error",
        "the same of the twin with the step off surfaces and from edges",
        "paths out of the closed room",
        "shadow rays that differ",
        "triangles without area",
    ];
    let mut table = Table::new("A room in the corner of a scene", &columns);
    for &ratio in ratios {
        let name = format!("{ratio:e}");
        let described = studio(ratio, 0.0, 0.6);
        let dropped = described.builder().build().map_or(f64::NAN, |scene| scene.dropped_triangles() as f64);
        if dropped != 0.0 {
            table.row(name, &[[f64::NAN; 9].as_slice(), &[dropped]].concat());
            continue;
        }
        let pair = Pair::new(&described, &described, paths, 16);
        // A room measures two metres.
        let mut apart: Vec<f64> = pair.at(0).iter().map(|meeting| 0.5 * meeting.apart).collect();
        let (ships, error) = pair.flux();
        let row = [
            quantile(&mut apart, 0.5),
            quantile(&mut apart, 0.99),
            pair.parted(0),
            pair.parted(3),
            ships,
            error,
            step(&described, &pair, paths),
            pair.lost as f64 / f64::from(paths),
            shadows(&described, &pair),
            dropped,
        ];
        table.row(name, &row);
    }
    table
}

/// Relative flux onto the floor with the shipped offset from surfaces and no other change.
fn step(described: &Described, pair: &Pair, paths: u32) -> f64 {
    let mut wide = Wide::exact(&described.builder().build().unwrap(), described);
    wide.step = 1.0 / 1_048_576.0;
    let (stepped, _) = twins(&wide, paths, 16);
    flux(upward(&stepped), upward(&pair.twin)).0
}

/// Fraction of the shadow rays, from the first landings to the point light, on which the shipped caster and the
/// twin disagree.
fn shadows(described: &Described, pair: &Pair) -> f64 {
    let scene = described.builder().build().unwrap();
    let wide = Wide::exact(&scene, described);
    let view = scene.view();
    let accel = Accel::build(view.positions, view.triangles).unwrap();
    let (area_light, place) = (view.lights.len() - 1, *wide.light_places.last().unwrap());
    let (mut differ, mut count) = (0_u32, 0_u32);
    for (shipped, twin) in pair.shipped.iter().zip(&pair.twin) {
        let (Some((_, photon)), Some(landing)) = (shipped.first(), twin.first()) else { continue };
        let normal = photon_core::octahedral::unpack(photon.normal);
        if landing.normal.dot(normal.as_dvec3()) < 0.9 {
            continue;
        }
        let from = offset::off_surface(photon.position.into(), landing.normal.as_vec3());
        let gap = Vec3::from(view.lights[area_light].position) - from;
        let ray = Ray { origin: from, direction: gap / gap.length(), t_max: gap.length() };
        let gap: DVec3 = place - landing.point;
        let blocked =
            wide.tree.nearest(landing.point, gap.normalize_or_zero(), gap.length(), landing.primitive).is_some();
        // No shadow ray is traced to a light behind the surface.
        if gap.dot(landing.normal) > 0.0 {
            count += 1;
            differ += u32::from(accel.occluded(&ray) != blocked);
        }
    }
    f64::from(differ) / f64::from(count.max(1))
}

/// A room far from the user's origin, given in f64 and as if its file had stored 32-bit coordinates.
#[must_use]
pub fn places(decades: std::ops::RangeInclusive<i32>, paths: u32) -> Table {
    let columns = [
        "offset / room",
        "f64 input: first landing is off by, rooms, median",
        "paths diverged at the first landing",
        "flux onto the floor, relative",
        "f32 input: first landing is off by, rooms, median",
        "paths diverged at the first landing",
        "flux onto the floor, relative",
    ];
    let mut table = Table::new("A room far from the origin", &columns);
    let here = studio(1.0, 0.0, 0.6);
    for k in decades {
        let there = studio(1.0, 2.0 * 10.0_f64.powi(k), 0.6);
        let figures = |described: &Described| {
            if described.builder().build().is_err() {
                return [f64::NAN; 3];
            }
            let pair = Pair::new(&here, described, paths, 16);
            let mut apart: Vec<f64> = pair.at(0).iter().map(|meeting| 0.5 * meeting.apart).collect();
            [quantile(&mut apart, 0.5), pair.parted(0), pair.flux().0]
        };
        let (wide, narrow) = (figures(&there), figures(&there.stored_narrow()));
        table.row(format!("1e{k}"), &[wide, narrow].concat());
    }
    table
}

/// Landing by landing, in a bright room with glass and a mirror.
#[must_use]
pub fn path(landings: &[usize], paths: u32) -> Table {
    let columns = [
        "landing",
        "paths diverged there or before",
        "off by, rooms, median",
        "99 of 100",
        "direction, radians, median",
        "power, relative, 99 of 100",
    ];
    let mut table = Table::new("Along a path", &columns);
    let described = studio(1.0, 0.0, 0.95);
    let pair = Pair::new(&described, &described, paths, 200);
    for &landing in landings {
        let at = pair.at(landing - 1);
        let mut apart: Vec<f64> = at.iter().map(|meeting| 0.5 * meeting.apart).collect();
        let mut turned: Vec<f64> = at.iter().map(|meeting| meeting.turned).collect();
        let mut power: Vec<f64> = at.iter().map(|meeting| meeting.power).collect();
        let row = [
            pair.parted(landing - 1),
            quantile(&mut apart, 0.5),
            quantile(&mut apart, 0.99),
            quantile(&mut turned, 0.5),
            quantile(&mut power, 0.99),
        ];
        table.row(landing.to_string(), &row);
    }
    table
}

//! Point and spot lights outside of a scene, whose photons leave only towards it: a floor gets the flux that photons in all
//! directions would give.

use photon_core::glam::DVec3;
use photon_core::{Direct, MapKind, Settings, sampling};
use photon_scene::{LightDesc, MaterialDesc, SceneBuilder};

use crate::harness::{TestBackend, trace};
use crate::portals::flux;
use crate::stats::assert_agrees;

/// A floor of side 2 at height 0, both sides of which store photons.
fn floor(lights: &[LightDesc]) -> photon_scene::Scene {
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [0.5; 3]));
    builder.quad("floor", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], white);
    for (index, light) in lights.iter().enumerate() {
        builder.light(format!("light {index}"), light.clone());
    }
    builder.build().unwrap()
}

fn point(position: [f64; 3], intensity: f64) -> LightDesc {
    LightDesc::Point { position, intensity: [intensity; 3] }
}

/// Aimed at a place on the floor.
fn spot(position: [f64; 3], at: [f64; 3], [inner, outer]: [f64; 2], intensity: f64) -> LightDesc {
    let direction = (DVec3::from(at) - DVec3::from(position)).normalize_or_zero().to_array();
    let [inner_angle, outer_angle] = [inner, outer].map(f64::to_radians);
    LightDesc::Spot { position, direction, intensity: [intensity; 3], inner_angle, outer_angle }
}

/// `∫ I cos θ/d² dA` by the midpoint rule with 512 × 512 points.
fn onto_the_floor(light: &LightDesc) -> f64 {
    let (position, intensity) = match *light {
        LightDesc::Point { position, intensity } | LightDesc::Spot { position, intensity, .. } => {
            (position, intensity[0])
        }
        _ => panic!("lights with a position"),
    };
    let versine = |angle: f64| (1.0 - angle.cos()) as f32;
    let share = |direction: DVec3| match *light {
        LightDesc::Spot { direction: axis, inner_angle, outer_angle, .. } => {
            let off = sampling::versine(direction.as_vec3(), DVec3::from(axis).as_vec3());
            f64::from(sampling::spot_falloff(off, versine(inner_angle), versine(outer_angle)))
        }
        _ => 1.0,
    };
    let steps = 512;
    let at = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0;
    let cell = (2.0 / f64::from(steps)).powi(2);
    let sum: f64 = (0..steps * steps)
        .map(|i| {
            let gap = DVec3::new(at(i / steps), 0.0, at(i % steps)) - DVec3::from(position);
            let distance = gap.length();
            share(gap / distance) * gap.y.abs() / distance.powi(3)
        })
        .sum();
    intensity * sum * cell
}

/// Above the middle, aside, below, far away, partly dark; and lights of different powers together. At least a seventh of the
/// paths arrive. Without the cone, hardly any of the farthest light's would.
pub fn lights_outside_give_what_arrives<T: TestBackend>() {
    let paths = 60_000;
    let far = point([180.0, 240.0, -15.0], 5e4);
    for lights in [
        vec![point([0.0, 2.0, 0.0], 3.0)],
        vec![point([3.0, 4.0, -1.0], 3.0)],
        vec![point([0.5, -1.5, 0.0], 1.0)],
        vec![far.clone()],
        vec![spot([1.0, 4.0, 1.0], [0.0; 3], [10.0, 60.0], 2.0)],
        vec![spot([2.0, 3.0, 0.0], [-1.0, 0.0, 0.5], [2.0, 30.0], 2.0)],
        vec![spot([0.0, 3.0, 0.0], [3.0, 0.0, 0.0], [20.0, 50.0], 2.0)],
        vec![spot([60.0, 300.0, 0.0], [40.0, 0.0, 0.0], [5.0, 12.0], 1e5)],
        vec![
            far,
            point([0.0, 2.0, 0.0], 0.1),
            point([0.0, 0.5, 0.0], 0.05),
            spot([0.0, 4.0, 1.0], [0.0; 3], [10.0, 60.0], 2.0),
        ],
    ] {
        let scene = floor(&lights);
        let settings = Settings { direct: Direct::Photons, max_bounces: 1, seed: 3, ..Settings::default() };
        let (photons, tally) = trace::<T>(2, &scene, &settings, &[paths]);
        let photons = &photons[MapKind::Direct];
        assert_eq!(tally.emitted, u64::from(paths));
        let truth: f64 = lights.iter().map(onto_the_floor).sum();
        let (found, error) = flux(&scene, photons, paths, |_| true);
        // The rule and rounding.
        assert_agrees(&format!("{lights:?}"), found, truth, error, 1e-4 * truth);
        assert!(photons.len() > paths as usize / 7, "{lights:?}: {} photons", photons.len());
    }
}

//! Maps built on the device, compared with those of the CPU.

mod check;
mod oversized_runs;
mod sets;

use backend_cpu::index::PointIndex;
use check::{Seen, check};
use photon_core::{Backend, Error, IndexKind, KdTreeBuilder, Photon};
use sets::point_sets;

use super::VulkanBuilder;
use crate::vulkan::Vulkan;

/// Photons at `points`, with different values in every field.
fn photons(points: &[[f32; 3]]) -> Vec<Photon> {
    let photon = |(i, &position): (usize, &[f32; 3])| {
        let i = i as u32;
        let power = [i as f32, 0.5, f32::from_bits(i)];
        Photon { position, direction: i ^ 0x5555, power, normal: !i }
    };
    points.iter().enumerate().map(photon).collect()
}

fn like_the_cpu(kind: IndexKind) {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let mut builder = VulkanBuilder::new(&mut on, kind).unwrap();
    let mut failed = Vec::new();
    for (name, points) in point_sets() {
        let photons = photons(&points);
        let buffer = on.upload("photons", &photons).unwrap();
        let map = builder.build(&mut on, buffer).unwrap();
        map.check(&mut on).unwrap();
        let seen = Seen::of(&mut on, &map);
        let index = PointIndex::build(&points, kind).unwrap();
        if let Err(why) = check(&seen, &photons, index.order()) {
            failed.push(format!("{kind:?}, {name}: {why}"));
        }
        // A reclaimed buffer is empty.
        let back = builder.reclaim(map);
        let mut photons = photons;
        on.download(&back, &mut photons).unwrap();
        assert!(photons.is_empty());
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn morton_order_is_that_of_the_cpu() {
    like_the_cpu(IndexKind::Morton);
}

#[test]
fn median_order_is_that_of_the_cpu() {
    like_the_cpu(IndexKind::Median);
}

#[test]
fn vvh_order_is_that_of_the_cpu() {
    like_the_cpu(IndexKind::Vvh);
}

#[test]
fn photons_that_are_not_finite_are_named() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let mut good = photons(&vec![[0.5; 3]; 3000]);
    for (i, photon) in good.iter_mut().enumerate() {
        photon.position[i % 3] = i as f32;
        photon.power = [1.0; 3];
    }
    for kind in KINDS {
        let mut builder = VulkanBuilder::new(&mut on, kind).unwrap();
        for (at, broken) in [(0, f32::NAN), (1234, f32::INFINITY), (2999, f32::NEG_INFINITY)] {
            for of_power in [false, true] {
                let mut photons = good.clone();
                for bad in [at, 2999] {
                    let photon = &mut photons[bad];
                    let triple = if of_power { &mut photon.power } else { &mut photon.position };
                    triple[2] = broken;
                }
                let buffer = on.upload("photons", &photons).unwrap();
                let map = builder.build(&mut on, buffer).unwrap();
                let Err(Error::InvalidInput { index, why, .. }) = map.check(&mut on) else { panic!("{kind:?} {at}") };
                assert_eq!(index, at as u64);
                assert!(why.contains(if of_power { "power" } else { "position" }), "{why}");
                // The next map is not affected.
                let _ = builder.reclaim(map);
                let buffer = on.upload("photons", &good).unwrap();
                let map = builder.build(&mut on, buffer).unwrap();
                map.check(&mut on).unwrap();
                let _ = builder.reclaim(map);
            }
        }
    }
}

const KINDS: [IndexKind; 3] = [IndexKind::Morton, IndexKind::Median, IndexKind::Vvh];

#[test]
fn a_wrong_map_is_noticed() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let points: Vec<[f32; 3]> = (0..700).map(|i| [i as f32, (i * i % 31) as f32, 1.0]).collect();
    let photons = photons(&points);
    let mut builder = VulkanBuilder::new(&mut on, IndexKind::Morton).unwrap();
    let buffer = on.upload("photons", &photons).unwrap();
    let map = builder.build(&mut on, buffer).unwrap();
    let seen = Seen::of(&mut on, &map);
    let index = PointIndex::build(&points, IndexKind::Morton).unwrap();
    let order = index.order();
    check(&seen, &photons, order).unwrap();
    let breaks: [fn(&mut Seen); 8] = [
        |seen| seen.ids.swap(3, 4),
        |seen| seen.positions[9][1] ^= 1,
        |seen| seen.power[699][3] ^= 1,
        |seen| seen.nodes[0][0] ^= 1,
        |seen| seen.nodes[20][4] ^= 1,
        |seen| seen.nodes[40][3] += 1,
        |seen| seen.nodes[40][7] -= 1,
        |seen| seen.totals[2] += 1,
    ];
    for (number, harm) in breaks.iter().enumerate() {
        let mut harmed = seen.clone();
        harm(&mut harmed);
        assert!(check(&harmed, &photons, order).is_err(), "harm {number}");
    }
}

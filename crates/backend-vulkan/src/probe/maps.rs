//! A kernel with as many photon maps as it may ever need: their addresses are no longer limited by push constants.

use photon_core::{Backend, Photon};

use crate::device::Memory;
use crate::{Vulkan, shaders};

/// Number of maps.
const MAPS: usize = 8;

parameters! {
    struct MapsPush => PROBE_MAPS {
        photons: [u64; MAPS],
        counts: [u64; MAPS],
        sums: [u64; MAPS],
        index: u32,
        factor: f32,
    }
}

/// Sums of the power in eight maps, for each of `dispatches` dispatches with parameters of its own; half of them without
/// barriers between them.
fn sums(on: &mut Vulkan, dispatches: u32) -> Vec<Vec<[f32; 3]>> {
    let photon = |map: usize, i: usize| Photon { power: [1.0, map as f32, i as f32], ..Photon::default() };
    let maps: Vec<_> = (0..MAPS)
        .map(|map| on.upload("photons", &(0..=map).map(|i| photon(map, i)).collect::<Vec<_>>()).unwrap())
        .collect();
    let bytes = u64::from(dispatches) * 12;
    let found: Vec<_> = (0..MAPS).map(|_| on.memory("sums", bytes).unwrap()).collect();
    let kernel = on.kernel(&shaders::PROBE_MAPS, 8, &());
    let each = |index| MapsPush {
        photons: std::array::from_fn(|map| maps[map].data_address()),
        counts: std::array::from_fn(|map| maps[map].count_address()),
        sums: std::array::from_fn(|map| found[map].address()),
        index,
        factor: 1.0 + index as f32,
    };
    (0..dispatches / 2).for_each(|index| on.dispatch(&kernel, &each(index), 1).unwrap());
    on.unordered(|on| (dispatches / 2..dispatches).try_for_each(|index| on.dispatch(&kernel, &each(index), 1)))
        .unwrap();
    let read = |memory: &Memory| {
        let mut sums = vec![[0.0; 3]; dispatches as usize];
        on.read(memory, 0, bytemuck::cast_slice_mut(&mut sums)).unwrap();
        sums
    };
    found.iter().map(read).collect()
}

/// More parameters than a block of memory holds, in more submissions than are in flight at a time: each dispatch reads its own,
/// whether the host or a command writes them.
#[test]
fn kernels_read_eight_maps() {
    const DISPATCHES: u32 = 3000;
    for by_commands in [false, true] {
        let Some(mut on) = Vulkan::for_tests() else { return };
        if by_commands {
            on.recorder.write_parameters_by_commands();
        }
        for (map, sums) in sums(&mut on, DISPATCHES).into_iter().enumerate() {
            let count = map as f32 + 1.0;
            let whole = [count, count * map as f32, (0..=map).sum::<usize>() as f32];
            for (index, sum) in sums.into_iter().enumerate() {
                assert_eq!(sum, whole.map(|of| of * (1.0 + index as f32)), "map {map}, dispatch {index}");
            }
        }
    }
}

//! How photons are read and written in each format, compared with photon-core's sizes.

use photon_core::PhotonFormat;

use super::compare::Bound;
use super::draw::{Draw, inputs};
use super::table::{Row, words};
use super::{Input, Output, assert_twin, words_of};
use crate::{Vulkan, shaders};

/// Words of the table that is read.
const WORDS: u32 = 4096;

/// The function that reads, its twin and its bound.
pub(super) fn row() -> Row {
    Row {
        name: "flux_at",
        module: &shaders::PROBE_PHOTON_FORMAT,
        function: 0,
        bound: Bound::Words,
        draw: read,
        twin: |i| unpacked(PhotonFormat::ALL[i.0[4] as usize], i.0[5]),
    }
}

/// A format, and the index of a photon in the table.
fn read(d: &mut Draw) -> Input {
    let format = d.pick(&PhotonFormat::ALL);
    let photons = WORDS / (format.flux_bytes() as u32 / 4);
    let mut input = Input::default();
    (input.0[4], input.0[5]) = (format.number(), d.word() % photons);
    input
}

fn word_of_table(at: u32) -> u32 {
    at.wrapping_mul(0x9E37_79B9) ^ 0x5EED
}

/// Power and direction of a photon, whose words begin at a multiple of its size; one power stands for all channels, and
/// a direction that is not stored is 0.
fn unpacked(format: PhotonFormat, number: u32) -> Output {
    let size = format.flux_bytes() as u32 / 4;
    let word = |place: u32| word_of_table(number * size + place);
    match format {
        PhotonFormat::Mono => words([word(0); 3]),
        PhotonFormat::NoDirection => words([word(0), word(1), word(2)]),
        PhotonFormat::Full => words([word(0), word(1), word(2), word(3)]),
    }
}

#[test]
fn photons_are_read_in_each_format() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let table: Vec<u32> = (0..WORDS).map(word_of_table).collect();
    let memory = on.memory("fluxes", u64::from(WORDS) * 4).unwrap();
    on.write(&memory, 0, bytemuck::cast_slice(&table)).unwrap();
    let address = words_of(memory.address());
    // A direction in the format without one is detected.
    assert_twin(&mut on, &row(), &address, |i| unpacked(PhotonFormat::ALL[i.0[4].max(1) as usize], i.0[5]));
}

/// Photons lie one behind another, each with the leading bytes of power and direction.
#[test]
fn photons_are_written_in_each_format() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    for format in PhotonFormat::ALL {
        let photons = inputs(|d| Input(std::array::from_fn(|_| d.word())));
        let bytes = photons.len() as u64 * format.flux_bytes();
        let memory = on.memory("fluxes", bytes).unwrap();
        let mut written = photons.clone();
        for (number, input) in (0..).zip(&mut written) {
            (input.0[4], input.0[5]) = (format.number(), number);
            (input.0[10], input.0[11]) = (memory.address() as u32, (memory.address() >> 32) as u32);
        }
        super::run(&mut on, &shaders::PROBE_PHOTON_FORMAT, 1, &written).unwrap();
        let mut found = vec![0_u32; bytes as usize / 4];
        on.read(&memory, 0, bytemuck::cast_slice_mut(&mut found)).unwrap();
        let size = format.flux_bytes() as usize / 4;
        let expected: Vec<u32> = photons.iter().flat_map(|photon| photon.0[..size].to_vec()).collect();
        assert!(found == expected, "{format:?}");
        // The comparison can fail: the words after the first are not those of the next photon.
        let shifted: Vec<u32> = photons.iter().flat_map(|photon| photon.0[1..=size].to_vec()).collect();
        assert!(found != shifted, "{format:?}");
    }
}

//! The header of a NumPy array file, version 1.0.

use crate::column::Column;

/// The bytes before the data of an array of `height` rows of `width` pixels.
pub(crate) fn header(column: Column, width: u32, height: u32) -> Vec<u8> {
    let kind = if column.is_integer() { "<u8" } else { "<f8" };
    let shape = match column.width() {
        1 => format!("({height}, {width})"),
        numbers => format!("({height}, {width}, {numbers})"),
    };
    let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // Data start at a multiple of 64 bytes.
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes
}

/// Bytes of the data of an array.
pub(crate) fn data_bytes(column: Column, width: u32, height: u32) -> u64 {
    u64::from(width) * u64::from(height) * column.width() as u64 * 8
}

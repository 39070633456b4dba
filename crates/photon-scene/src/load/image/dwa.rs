//! Sizes in the blocks of `OpenEXR` files with DWA compression, which the decoder allocates without a limit.

use std::io::Cursor;

use exr::block;
use exr::block::chunk::CompressedBlock;
use exr::compression::Compression;
use exr::meta::header::Header;

use super::ImageError;

/// Positions of the sizes of unpacked data among the eleven numbers at the start of a block, and bytes of their unit:
/// unknown data, run lengths before and after unpacking, AC and DC coefficients (openexr.com, "DWA compression").
const UNPACKED: [(usize, u64); 5] = [(1, 1), (6, 1), (7, 1), (8, 2), (9, 2)];

/// Checks that no block of `file` claims to unpack to more than twice the bytes of its pixels.
pub(super) fn check(file: &[u8], headers: &[Header]) -> Result<(), ImageError> {
    let is_dwa = |header: &Header| matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_));
    if !headers.iter().any(is_dwa) {
        return Ok(());
    }
    let damaged = |why: exr::error::Error| ImageError::new(format!("cannot be decoded as OpenEXR: {why}"));
    let chunks = block::read(Cursor::new(file), false).and_then(|reader| reader.all_chunks(false)).map_err(damaged)?;
    for chunk in chunks {
        let chunk = chunk.map_err(damaged)?;
        let Some(header) = headers.get(chunk.layer_index).filter(|header| is_dwa(header)) else { continue };
        let lines = if matches!(header.compression, Compression::DWAA(_)) { 32 } else { 256 };
        let line = (header.layer_size.width() * header.channels.bytes_per_pixel) as u64;
        let (packed, raw) = match &chunk.compressed_block {
            CompressedBlock::ScanLine(block) => {
                let above = i64::from(block.y_coordinate) - i64::from(header.own_attributes.layer_position.y());
                let left = (header.layer_size.height() as i64).saturating_sub(above).clamp(0, lines);
                (&block.compressed_pixels_le, Some(left as u64 * line))
            }
            CompressedBlock::Tile(block) => (&block.compressed_pixels_le, None),
            _ => return Err(ImageError::new("is a deep OpenEXR file, which has no single image")),
        };
        // Pixels that would not shrink are stored as they are.
        if raw == Some(packed.len() as u64) {
            continue;
        }
        let most = 2 * line * lines as u64 + 65_536;
        let number = |index: usize| packed.get(8 * index..)?.first_chunk::<8>().map(|bytes| u64::from_le_bytes(*bytes));
        let claims = |(index, unit): (usize, u64)| number(index).is_some_and(|count| count.saturating_mul(unit) > most);
        if UNPACKED.into_iter().any(claims) {
            return Err(ImageError::new("cannot be decoded as OpenEXR: a block claims more data than it has pixels"));
        }
    }
    Ok(())
}

//! Binary STL: a header of 80 bytes, the number of triangles, and 50 bytes for each.

use super::Fault;
use super::corners::Corners;

const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Number of triangles by the header; `None` for a file that ends before it.
fn declared(bytes: &[u8]) -> Option<u64> {
    bytes.get(80..HEADER).and_then(|count| count.try_into().ok()).map(|count| u32::from_le_bytes(count).into())
}

/// Whether the length of the file is that of the triangles that it declares.
pub(super) fn has_its_length(bytes: &[u8]) -> bool {
    declared(bytes).is_some_and(|count| (HEADER as u64 + count * TRIANGLE as u64) == bytes.len() as u64)
}

/// The largest number of triangles that the file can have.
pub(super) fn most(bytes: &[u8]) -> u64 {
    (bytes.len().saturating_sub(HEADER) / TRIANGLE) as u64
}

/// Reads at most so many triangles, by [`most`].
///
/// # Errors
/// A file that ends before them.
pub(super) fn read(bytes: &[u8], most: usize) -> Result<Corners, Fault> {
    let Some(count) = declared(bytes) else {
        let what = "it is neither a text that begins with 'solid' nor a binary file, which has a header of 84 bytes";
        return Err((what.to_owned(), 0));
    };
    if count > most as u64 {
        let what = format!("the header declares {count} triangles, of which the file can hold {most}");
        return Err((what, 0));
    }
    let mut corners = Corners::with_capacity(count as usize);
    corners.begin(String::new());
    let (triangles, rest) = bytes[HEADER..].split_at(count as usize * TRIANGLE);
    for triangle in triangles.as_chunks::<TRIANGLE>().0 {
        let numbers: [[f64; 3]; 4] = std::array::from_fn(|row| {
            std::array::from_fn(|axis| {
                let at = 4 * (3 * row + axis);
                f32::from_le_bytes([triangle[at], triangle[at + 1], triangle[at + 2], triangle[at + 3]]).into()
            })
        });
        let [normal, a, b, c] = numbers;
        corners.add(normal, [a, b, c]);
        corners.attributes += usize::from(triangle[48..] != [0, 0]);
    }
    corners.rest = rest.len();
    Ok(corners)
}

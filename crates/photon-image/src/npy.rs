//! NumPy array files, as far as `photonmap map` needs them: little-endian, in C order.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::fault::{Fault, check_kind, check_regular};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Reads an array of float32 of shape (N, 3).
///
/// # Errors
/// [`Fault::Input`], which names the file and what is wrong with it.
pub fn read_points(path: &Path) -> Result<Vec<[f32; 3]>, Fault> {
    read(path, Shape::Points)
}

/// Reads segments as an array of float32 of shape (N, 2, 3), both ends of each, or (N, 6).
///
/// # Errors
/// [`Fault::Input`], which names the file and what is wrong with it.
pub fn read_segments(path: &Path) -> Result<Vec<[[f32; 3]; 2]>, Fault> {
    Ok(read(path, Shape::Segments)?.as_chunks::<2>().0.to_vec())
}

/// Rows of an array.
#[derive(Clone, Copy, Debug)]
enum Shape {
    Points,
    Segments,
}

impl Shape {
    /// Number of points in an array of these sizes, and in a row.
    fn points(self, sizes: &[&str]) -> Option<(usize, usize)> {
        let (rows, each) = match (self, sizes) {
            (Self::Points, [rows, "3"]) => (rows, 1),
            (Self::Segments, [rows, "6"] | [rows, "2", "3"]) => (rows, 2),
            _ => return None,
        };
        Some((rows.parse::<usize>().ok()?.checked_mul(each)?, each))
    }

    fn request(self) -> &'static str {
        match self {
            Self::Points => "give a float32 array of shape (N, 3) as numpy.save writes it",
            Self::Segments => "give a float32 array of shape (N, 2, 3) or (N, 6) as numpy.save writes it",
        }
    }
}

fn read(path: &Path, shape: Shape) -> Result<Vec<[f32; 3]>, Fault> {
    let wrong = |what: &str| Fault::input(format!("{}: {what}", path.display()));
    check_regular(path)?;
    check_kind(path, "npy", "an array of NumPy (.npy)")?;
    let bytes = std::fs::read(path).map_err(|why| wrong(&format!("cannot be read: {why}")))?;
    parse(&bytes, shape).map_err(|what| wrong(&what))
}

fn parse(bytes: &[u8], wanted: Shape) -> Result<Vec<[f32; 3]>, String> {
    let ask = wanted.request();
    if bytes.len() < 10 || &bytes[..6] != MAGIC {
        return Err(format!("is not a .npy file; {ask}"));
    }
    let (start, length): (usize, usize) = if bytes[6] == 1 {
        (10, usize::from(u16::from_le_bytes([bytes[8], bytes[9]])))
    } else if bytes.len() >= 12 {
        (12, u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]) as usize)
    } else {
        return Err("ends within its header".to_owned());
    };
    let end = start.checked_add(length).filter(|&end| end <= bytes.len()).ok_or("ends within its header")?;
    let header = String::from_utf8_lossy(&bytes[start..end]).replace(' ', "");
    if !header.contains("'descr':'<f4'") {
        return Err(format!("does not hold float32 (header {header:?}); {ask}"));
    }
    if !header.contains("'fortran_order':False") {
        return Err(format!("is in Fortran order; {ask}, after numpy.ascontiguousarray"));
    }
    let shape = header.split("'shape':(").nth(1).and_then(|rest| rest.split(')').next()).unwrap_or_default();
    let sizes: Vec<&str> = shape.split(',').filter(|size| !size.is_empty()).collect();
    let (points, each) = wanted.points(&sizes).ok_or_else(|| format!("has shape ({shape}); {ask}"))?;
    let data = &bytes[end..];
    if points.checked_mul(12) != Some(data.len()) {
        return Err(format!(
            "has {} bytes of data where {} rows need {} each; it is truncated or damaged",
            data.len(),
            points / each,
            12 * each
        ));
    }
    let number = |at: &[u8]| f32::from_le_bytes([at[0], at[1], at[2], at[3]]);
    Ok(data.chunks_exact(12).map(|row| [number(&row[0..4]), number(&row[4..8]), number(&row[8..12])]).collect())
}

/// Writes a one-dimensional array of uint32.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write_u32(path: &Path, values: &[u32]) -> Result<(), Fault> {
    write(path, &format!("({},)", values.len()), |file| write_words(file, values))
}

/// Writes an array of uint32 with so many rows, of which only the first `known` columns of `columns` are given; the others are
/// 4294967295.
///
/// # Errors
/// Those of [`write_u32`].
pub fn write_rows(path: &Path, values: &[u32], (rows, known, columns): (usize, usize, usize)) -> Result<(), Fault> {
    const FILL: [u32; 1024] = [u32::MAX; 1024];
    write(path, &format!("({rows}, {columns})"), |file| {
        for row in 0..rows {
            write_words(file, &values[row * known..(row + 1) * known])?;
            let mut left = columns - known;
            while left > 0 {
                let some = left.min(FILL.len());
                write_words(file, &FILL[..some])?;
                left -= some;
            }
        }
        Ok(())
    })
}

fn write(
    path: &Path,
    shape: &str,
    data: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<(), Fault> {
    let mut header = format!("{{'descr': '<u4', 'fortran_order': False, 'shape': {shape}, }}");
    // Data start at a multiple of 64 bytes.
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    crate::atomic_write::write(path, |file| {
        file.write_all(MAGIC)?;
        file.write_all(&[1, 0])?;
        file.write_all(&(header.len() as u16).to_le_bytes())?;
        file.write_all(header.as_bytes())?;
        Ok(data(file)?)
    })
}

fn write_words(file: &mut impl Write, values: &[u32]) -> std::io::Result<()> {
    values.iter().try_for_each(|value| file.write_all(&value.to_le_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn points_are_read_and_faults_named() {
        let data: Vec<u8> = [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        let header = |descr: &str, fortran: &str, shape: &str| {
            format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
        };
        let good = file(&header("<f4", "False", "(2, 3)"), &data);
        assert_eq!(parse(&good, Shape::Points).unwrap(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        for (bytes, culprit) in [
            (b"hello".to_vec(), "not a .npy"),
            (file(&header("<f8", "False", "(2, 3)"), &data), "float32"),
            (file(&header("<f4", "True", "(2, 3)"), &data), "Fortran"),
            (file(&header("<f4", "False", "(3, 2)"), &data), "shape (3,2)"),
            (file(&header("<f4", "False", "(6,)"), &data), "shape (6,)"),
            (file(&header("<f4", "False", "(3, 3)"), &data), "truncated"),
            (good[..good.len() - 1].to_vec(), "truncated"),
            (good[..20].to_vec(), "header"),
        ] {
            let error = parse(&bytes, Shape::Points).unwrap_err();
            assert!(error.contains(culprit), "{error}");
        }
        for shape in ["(1, 6)", "(1, 2, 3)"] {
            let segments = parse(&file(&header("<f4", "False", shape), &data), Shape::Segments);
            assert_eq!(segments.unwrap(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{shape}");
        }
        for (shape, culprit) in
            [("(2, 3)", "shape (2,3); give"), ("(2, 2, 3)", "2 rows need 24 each"), ("(6,)", "(N, 6)")]
        {
            let error = parse(&file(&header("<f4", "False", shape), &data), Shape::Segments).unwrap_err();
            assert!(error.contains(culprit), "{error}");
        }
    }
}

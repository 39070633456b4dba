//! Definitions of an OBJ file, which may come before or after the faces that use them.

use super::census::Census;
use super::statements::{number, parts, statements, words};
use crate::color::srgb_to_linear;
use crate::load::group::Pools;
use crate::load::white::White;
use glam::DVec3;

/// Reads all vertices, normals, texture coordinates and colours.
///
/// # Errors
/// The line of a vertex without three numbers, and what is wrong. NaN is a number: only faces may not use the vertex.
pub(super) fn read(text: &str, vertices: usize, census: &mut Census) -> Result<Pools, (usize, String)> {
    let mut pools = Pools { positions: Vec::with_capacity(vertices), ..Pools::default() };
    for (statement, line) in statements(text) {
        let (keyword, rest) = parts(&statement);
        match keyword {
            "v" => {
                let (numbers, next) = numbers::<7>(rest);
                let Some((position, others)) = numbers.split_first_chunk() else {
                    let word = next.unwrap_or("nothing");
                    return Err((line, format!("'{keyword} {rest}' has {word} in place of a number")));
                };
                pools.positions.push(*position);
                let is_color = |color: &[f64; 3]| color.iter().all(|part| part.is_finite());
                let color = others.first_chunk().filter(|color| is_color(color));
                if let Some(&[r, g, b]) = color {
                    pools.colors.resize(pools.positions.len() - 1, [f64::NAN; 4]);
                    pools.colors.push([r, g, b, 1.0]);
                }
                // A weight of 1 says nothing.
                let is_all = matches!((color, others), (Some(_), [_, _, _]) | (None, [] | [1.0]));
                if !is_all || next.is_some() {
                    census.others.add(line);
                }
            }
            "vn" => {
                let normal = numbers::<3>(rest).0.first_chunk().map_or(DVec3::NAN, |&parts: &[f64; 3]| parts.into());
                if !normal.is_finite() {
                    census.normals.add(line);
                }
                // A zero is replaced by the normal of the triangle.
                pools.normals.push(if normal.is_finite() { normal.normalize_or_zero() } else { DVec3::ZERO });
            }
            "vt" => {
                let uv = match *numbers::<2>(rest).0 {
                    // v may be left out.
                    [u] => [u, 0.0],
                    [u, v] => [u, v],
                    _ => [f64::NAN; 2],
                };
                let is_finite = uv[0].is_finite() && uv[1].is_finite();
                if !is_finite {
                    census.uvs.add(line);
                }
                let [u, v] = if is_finite { uv } else { [0.0; 2] };
                pools.uvs.push([u, 1.0 - v]);
            }
            _ => {}
        }
    }
    let known = pools.colors.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).filter(|part| !part.is_nan());
    let white = White::of(known);
    let linear = |part: f64| srgb_to_linear((part / white.value).clamp(0.0, 1.0));
    for [r, g, b, _] in &mut pools.colors {
        [*r, *g, *b] = [*r, *g, *b].map(linear);
    }
    census.white = Some(white);
    Ok(pools)
}

/// The first numbers of a statement, at most `N`, and the word behind them.
fn numbers<const N: usize>(rest: &str) -> (Numbers<N>, Option<&str>) {
    let mut words = words(rest);
    let mut numbers = Numbers { list: [0.0; N], count: 0 };
    for word in words.by_ref() {
        match number(word).filter(|_| numbers.count < N) {
            Some(number) => numbers.list[numbers.count] = number,
            None => return (numbers, Some(word)),
        }
        numbers.count += 1;
    }
    (numbers, None)
}

/// A few numbers.
struct Numbers<const N: usize> {
    list: [f64; N],
    count: usize,
}

impl<const N: usize> std::ops::Deref for Numbers<N> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.list[..self.count]
    }
}

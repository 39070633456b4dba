//! Brute-force results, and the comparison with them.

use super::{Neighbours, PointIndex};

/// Squared distance and id.
type Pair = (f32, u32);

fn sorted(mut pairs: Vec<Pair>) -> Vec<Pair> {
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    pairs
}

/// All points with their squared distances, nearest first.
pub(super) fn ranking(points: &[[f32; 3]], query: [f32; 3]) -> Vec<Pair> {
    let distance = |p: &[f32; 3]| {
        let [dx, dy, dz] = [query[0] - p[0], query[1] - p[1], query[2] - p[2]];
        dx * dx + dy * dy + dz * dz
    };
    sorted(points.iter().enumerate().map(|(id, p)| (distance(p), id as u32)).collect())
}

/// Compares all searches around `query` with brute force over `points`; the error describes the difference.
pub(super) fn check(
    index: &PointIndex,
    points: &[[f32; 3]],
    query: [f32; 3],
    found: &mut Neighbours,
) -> Result<(), String> {
    let same = |what: String, found: Vec<Pair>, expected: Vec<Pair>| {
        if found == expected {
            Ok(())
        } else {
            Err(format!("{what} around {query:?}: {found:?} instead of {expected:?}"))
        }
    };
    let all = ranking(points, query);
    let middle = all.get(all.len() / 8).map_or(0.0, |n| n.0);
    let first = |k: usize, r2: f32| all.iter().copied().filter(|n| n.0 <= r2).take(k).collect::<Vec<_>>();
    for r2 in [0.0, middle, f32::INFINITY] {
        let mut within = Vec::new();
        index.within(query, r2, |slot, d2| within.push((d2, index.order()[slot as usize])));
        same(format!("within {r2}"), sorted(within), first(usize::MAX, r2))?;
        let count = index.count_within(query, r2) as usize;
        if count != first(usize::MAX, r2).len() {
            return Err(format!("{count} counted within {r2} around {query:?}"));
        }
    }
    for (k, max_r2) in [
        (1, f32::INFINITY),
        (7, middle),
        (50, f32::INFINITY),
        (50, middle),
        (300, f32::INFINITY),
        (50, 0.0),
        (usize::MAX, middle),
    ] {
        // The second search starts from the hint of the first; the third has no filter.
        for turn in 0..3 {
            if turn == 2 {
                index.nearest_of_all(query, k, max_r2, found);
            } else {
                index.nearest(query, k, max_r2, |_| true, found);
            }
            let pairs = found.as_slice().iter().map(|n| (n.d2, n.id)).collect();
            same(format!("nearest {k} within {max_r2}"), pairs, first(k, max_r2))?;
        }
        if found.as_slice().iter().any(|n| index.order()[n.slot as usize] != n.id) {
            return Err("slots and ids differ".into());
        }
    }
    let expected: Vec<_> = all.iter().copied().filter(|n| n.1 % 2 == 1).take(20).collect();
    for _ in 0..2 {
        index.nearest(query, 20, f32::INFINITY, |slot| index.order()[slot as usize] % 2 == 1, found);
        same("odd ids".into(), found.as_slice().iter().map(|n| (n.d2, n.id)).collect(), expected.clone())?;
    }
    Ok(())
}

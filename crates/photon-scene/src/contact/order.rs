//! Order of the surfaces in one plane, from what they bound.

use std::cmp::Ordering;

use crate::describe::MaterialDesc;

/// The triangles of a mesh in one plane that face one way.
#[derive(Clone, Debug)]
pub(super) struct Patch<'a> {
    pub(super) material: &'a MaterialDesc,
    /// Whether its normal is along the direction in which levels count.
    pub(super) is_up: bool,
    /// Area of the triangles that touch others, and of the whole mesh.
    pub(super) areas: [f64; 2],
    /// Whether it bounds a layer that is thinner than what is resolved.
    pub(super) is_thin: bool,
    /// Its first corner, by coordinates.
    pub(super) corner: [f32; 3],
}

/// Two patches that touch, or nearly do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) patches: [usize; 2],
    /// Height of the second one over the first one along the common direction.
    pub(super) height: f64,
    /// Whether they nearly touch: their order is that of their heights, and they are as far apart as they have to be.
    pub(super) is_apart: bool,
}

/// Levels of the patches along the common direction, such that all orders hold, and the largest sheet, or else the
/// largest solid, has level 0.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Levels {
    pub(super) levels: Vec<i32>,
    /// Whether solids are in optical contact with a sheet, since they touch each other around it.
    pub(super) is_wet: bool,
}

/// Levels for patches that touch in `pairs`; `None` if no order is right.
pub(super) fn levels(patches: &[Patch<'_>], pairs: &[Pair]) -> Option<Levels> {
    levels_by(patches, &ranks(patches), pairs)
}

/// As [`levels`], with the [`ranks`] of the patches.
fn levels_by(patches: &[Patch<'_>], ranks: &[usize], pairs: &[Pair]) -> Option<Levels> {
    let anchor = (0..patches.len()).max_by_key(|&patch| ranks[patch])?;
    if !patches[anchor].is_up {
        // Seen from the other side, so that the result does not depend on the order of triangles.
        let turned: Vec<_> = patches.iter().map(|patch| Patch { is_up: !patch.is_up, ..patch.clone() }).collect();
        let pairs: Vec<_> = pairs.iter().map(|pair| Pair { height: -pair.height, ..*pair }).collect();
        let Levels { levels, is_wet } = levels_by(&turned, ranks, &pairs)?;
        return Some(Levels { levels: levels.into_iter().map(|level| -level).collect(), is_wet });
    }
    // Surfaces that nearly touch come second.
    let touching: Vec<Pair> = pairs.iter().filter(|pair| !pair.is_apart).copied().collect();
    let ways = [(true, pairs), (true, &touching[..]), (false, pairs), (false, &touching[..])];
    let (levels, film) =
        ways.into_iter().find_map(|(film, pairs)| Some((sorted(patches, ranks, pairs, film)?, film)))?;
    let ground = levels[anchor];
    Some(Levels { levels: levels.into_iter().map(|level| level - ground).collect(), is_wet: !film })
}

/// The place of each patch in the order by size, solids before sheets; patches that are alike have the same.
fn ranks(patches: &[Patch<'_>]) -> Vec<usize> {
    let order = |a: &Patch<'_>, b: &Patch<'_>| b.is_solid().cmp(&a.is_solid()).then_with(|| a.size(b));
    let mut sorted: Vec<usize> = (0..patches.len()).collect();
    sorted.sort_by(|&a, &b| order(&patches[a], &patches[b]));
    let mut ranks = vec![0; patches.len()];
    for pair in sorted.windows(2) {
        let grows = order(&patches[pair[0]], &patches[pair[1]]).is_lt();
        ranks[pair[1]] = ranks[pair[0]] + usize::from(grows);
    }
    ranks
}

/// The longest path to each patch from those that nothing is below (Kahn 1962).
fn sorted(patches: &[Patch<'_>], ranks: &[usize], pairs: &[Pair], film: bool) -> Option<Vec<i32>> {
    let mut above = vec![Vec::new(); patches.len()];
    let mut below = vec![0; patches.len()];
    for pair in pairs {
        let [a, b] = pair.patches;
        let is_below = if pair.is_apart {
            pair.height > 0.0
        } else {
            patches[a].is_below(&patches[b], ranks[a].cmp(&ranks[b]), film, pair.height)
        };
        let (low, high) = if is_below { (a, b) } else { (b, a) };
        above[low].push((high, i32::from(!pair.is_apart)));
        below[high] += 1;
    }
    let mut levels = vec![0; patches.len()];
    let mut ready: Vec<usize> = (0..patches.len()).filter(|&patch| below[patch] == 0).collect();
    let mut done = 0;
    while let Some(low) = ready.pop() {
        done += 1;
        for &(high, step) in &above[low] {
            levels[high] = levels[high].max(levels[low] + step);
            below[high] -= 1;
            if below[high] == 0 {
                ready.push(high);
            }
        }
    }
    (done == patches.len()).then_some(levels)
}

impl Patch<'_> {
    fn is_solid(&self) -> bool {
        self.material.is_solid()
    }

    /// Whether this one is the lower one of two that touch, the other one `height` over it; `size` is how their sizes compare.
    /// With `film`, there is air between solids and sheets.
    fn is_below(&self, other: &Self, size: Ordering, film: bool, height: f64) -> bool {
        /// Heights beyond rounding errors.
        const CLEAR: f64 = 2.5e-7;
        match (self.is_solid(), other.is_solid()) {
            // Each reaches into the other, so that there is no gap.
            (true, true) if self.is_up != other.is_up => other.is_up,
            // A thin layer is in front of what it lies on, unless it is clearly behind.
            _ if (self.is_thin || other.is_thin) && height.abs() > CLEAR => height > 0.0,
            _ if self.is_thin && !other.is_thin => !other.is_up,
            _ if !self.is_thin && other.is_thin => self.is_up,
            // The outer one, which is entered first, is that which applies where both are; of equals the larger one, so
            // that the smaller one within it applies.
            (true, true) => {
                let priority = self.material.priority.cmp(&other.material.priority);
                let is_outer = priority.then(size) == Ordering::Greater;
                is_outer != self.is_up
            }
            // Recedes from its own front: the solid with a film of air, or the sheet without one.
            (true, false) if film => self.is_up,
            (false, true) if film => !other.is_up,
            (true, false) => !other.is_up,
            (false, true) => self.is_up,
            // The smaller one is in front of the larger one.
            (false, false) => match size {
                Ordering::Less => !other.is_up,
                _ => self.is_up,
            },
        }
    }

    /// Order by size; of surfaces of equal size, by what and where they are, so that it does not depend on the order of meshes.
    fn size(&self, other: &Self) -> Ordering {
        // Sums in another order, or of other triangles, are equal up to rounding.
        let rounded = |areas: [f64; 2]| areas.map(|area| (area.ln() * 1e4).round());
        let ([touching, whole], [touches, all]) = (rounded(self.areas), rounded(other.areas));
        // A solid counts as a whole, so that its curved boundary does not alternate.
        let by_area = if self.is_solid() {
            whole.total_cmp(&all).then(touching.total_cmp(&touches))
        } else {
            touching.total_cmp(&touches).then(whole.total_cmp(&all))
        };
        // What shines or lets light through is in front.
        let hides = |patch: &Self| {
            let material = patch.material;
            (!material.is_emissive(), !matches!(material.surface, crate::Surface::Thin { .. }))
        };
        let text = |patch: &Self| {
            let MaterialDesc { surface, emission, dispersion, scattering, grid, .. } = patch.material;
            format!("{:?}", (surface, emission, dispersion, scattering, grid))
        };
        let by_corner = || {
            let pairs = self.corner.iter().zip(&other.corner);
            pairs.map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
        };
        by_area
            .then_with(|| hides(self).cmp(&hides(other)))
            .then_with(|| text(self).cmp(&text(other)))
            .then_with(by_corner)
    }
}

//! Exact searches over points in f64, by an index in f32.

use std::sync::OnceLock;

use photonmap::IndexKind;
use photonmap::cpu::index::{Neighbours, PointIndex};
use rayon::prelude::*;

use crate::error::Failure;
use crate::frame::{Frame, MAX_COORDINATE, Probe};

/// What is wrong with points, or `None`.
pub(crate) fn refuse(what: &str, points: &[[f64; 3]]) -> Result<(), Failure> {
    let fits = |point: &[f64; 3]| point.iter().all(|c| c.abs() <= MAX_COORDINATE);
    match points.par_iter().position_first(|point| !fits(point)) {
        None => Ok(()),
        Some(index) => {
            let [x, y, z] = points[index];
            let hint = if [x, y, z].iter().all(|c| c.is_finite()) {
                "is beyond 1e300: use a larger unit of length"
            } else {
                "is not finite: remove such rows, for example with x[numpy.isfinite(x).all(-1)]"
            };
            Err(Failure::input(format!("{what}[{index}] = ({x}, {y}, {z}) {hint}")))
        }
    }
}

/// Number of candidates beyond k: a search is decided if the last of them is farther than the k-th.
pub(crate) const SPARE: usize = 2;

/// Points and their index.
#[derive(Debug)]
pub(crate) struct Points {
    exact: Vec<[f64; 3]>,
    frame: Frame,
    /// Built when it is first needed: a GPU has its own.
    index: OnceLock<PointIndex>,
}

/// Scratch memory of a thread.
#[derive(Default)]
pub(crate) struct Scratch {
    found: Neighbours,
    near: Vec<(f64, u32)>,
}

impl Points {
    /// Points for searches in the current thread pool.
    pub(crate) fn new(exact: Vec<[f64; 3]>) -> Result<Self, Failure> {
        if exact.len() >= u32::MAX as usize {
            return Err(Failure::input(format!(
                "{} points are more than the 4294967294 of one tree: use several trees",
                exact.len()
            )));
        }
        refuse("points", &exact)?;
        Ok(Self { frame: Frame::new(&exact), exact, index: OnceLock::new() })
    }

    pub(crate) fn exact(&self) -> &[[f64; 3]] {
        &self.exact
    }

    pub(crate) fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The points as they are searched.
    pub(crate) fn rounded(&self) -> Vec<[f32; 3]> {
        self.exact.par_iter().with_min_len(4096).map(|point| self.frame.rounded(point)).collect()
    }

    /// The index, which is built now if it is not yet.
    pub(crate) fn index(&self) -> Result<&PointIndex, Failure> {
        if let Some(index) = self.index.get() {
            return Ok(index);
        }
        let built = PointIndex::build(&self.rounded(), IndexKind::Morton);
        let built = built.map_err(|why| Failure::input(why.to_string()))?;
        Ok(self.index.get_or_init(|| built))
    }

    /// The k nearest points nearer than `bound`: distances, and indices, nearest first, equal distances by index. What is
    /// missing is infinitely far and has the number of points as its index.
    pub(crate) fn nearest(
        &self,
        query: [f64; 3],
        bound: f64,
        (distances, ids): (&mut [f64], &mut [i64]),
        scratch: &mut Scratch,
    ) -> Result<(), Failure> {
        let (probe, k) = (self.frame.probe(query), distances.len());
        let Scratch { found, near } = scratch;
        near.clear();
        let Some(rounded) = probe.rounded else {
            near.extend((0..).zip(&self.exact).map(|(id, point)| (probe.distance_squared(point), id)));
            if near.len() > k {
                near.select_nth_unstable_by(k, order);
                near.truncate(k);
            }
            near.sort_unstable_by(order);
            self.write(&probe, bound, near, (distances, ids));
            return Ok(());
        };
        let index = self.index()?;
        let wanted = (k + SPARE).min(self.exact.len());
        index.nearest_of_all(rounded, wanted, probe.outer(bound * probe.scale), found);
        near.extend(found.as_slice().iter().map(|found| self.candidate(&probe, found.id)));
        let last = found.as_slice().last().map(|found| found.d2).filter(|_| near.len() == wanted);
        self.decide(&probe, rounded, bound, last, near, (distances, ids))
    }

    /// Decides among candidates, which are nearly in order. `last` is the distance in f32 of the last of them; `None` if
    /// there are no others within the bound.
    pub(crate) fn decide(
        &self,
        probe: &Probe,
        rounded: [f32; 3],
        bound: f64,
        last: Option<f32>,
        near: &mut Vec<(f64, u32)>,
        (distances, ids): (&mut [f64], &mut [i64]),
    ) -> Result<(), Failure> {
        let k = distances.len();
        insertion_sort(near);
        if let Some(last) = last
            && near.len() < self.exact.len()
            && !probe.is_beyond(last, near[k - 1].0)
        {
            // All points that may be as near as the k-th candidate.
            let radius = near[k - 1].0.sqrt().min(bound * probe.scale);
            near.clear();
            let index = self.index()?;
            let slots = index.order();
            index.within(rounded, probe.outer(radius), |slot, _| {
                near.push(self.candidate(probe, slots[slot as usize]));
            });
            near.sort_unstable_by(order);
        }
        near.truncate(k);
        self.write(probe, bound, near, (distances, ids));
        Ok(())
    }

    pub(crate) fn candidate(&self, probe: &Probe, id: u32) -> (f64, u32) {
        (probe.distance_squared(&self.exact[id as usize]), id)
    }

    /// Writes at most k candidates, which are in order.
    fn write(&self, probe: &Probe, bound: f64, near: &[(f64, u32)], (distances, ids): (&mut [f64], &mut [i64])) {
        let bound = bound * probe.scale;
        let bound_squared = bound * bound;
        distances.fill(f64::INFINITY);
        ids.fill(self.exact.len() as i64);
        for ((distance, id), &(squared, found)) in distances.iter_mut().zip(ids).zip(near) {
            if squared < bound_squared {
                (*distance, *id) = (squared.sqrt() / probe.scale, i64::from(found));
            }
        }
    }

    /// The number of points not farther than `radius`.
    pub(crate) fn count(&self, query: [f64; 3], radius: f64) -> Result<u64, Failure> {
        let probe = self.frame.probe(query);
        let Some(rounded) = probe.rounded else {
            let mut count = 0;
            self.visit(query, radius, |_| count += 1)?;
            return Ok(count);
        };
        let index = self.index()?;
        let radius_local = radius * probe.scale;
        let most = index.count_within(rounded, probe.outer(radius_local));
        if most == 0 || most == index.count_within(rounded, probe.inner(radius_local)) {
            return Ok(most.into());
        }
        let mut count = 0;
        self.visit(query, radius, |_| count += 1)?;
        Ok(count)
    }

    /// Calls `visit` with each point not farther than `radius`, in any order.
    pub(crate) fn visit(&self, query: [f64; 3], radius: f64, mut visit: impl FnMut(u32)) -> Result<(), Failure> {
        let probe = self.frame.probe(query);
        let radius = radius * probe.scale;
        let radius_squared = radius * radius;
        let is_within = |id: u32| probe.distance_squared(&self.exact[id as usize]) <= radius_squared;
        let Some(rounded) = probe.rounded else {
            (0..self.exact.len() as u32).filter(|&id| is_within(id)).for_each(visit);
            return Ok(());
        };
        let index = self.index()?;
        let (slots, certain) = (index.order(), probe.inner(radius));
        index.within(rounded, probe.outer(radius), |slot, squared| {
            let id = slots[slot as usize];
            if squared <= certain || is_within(id) {
                visit(id);
            }
        });
        Ok(())
    }
}

/// By distance, then by index. Distances are not NaN.
fn order(a: &(f64, u32), b: &(f64, u32)) -> std::cmp::Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

/// Sorts what is nearly in order.
fn insertion_sort(near: &mut [(f64, u32)]) {
    let mut moves = 0;
    for at in 1..near.len() {
        let item = near[at];
        let mut to = at;
        while to > 0 && order(&near[to - 1], &item).is_gt() {
            near[to] = near[to - 1];
            to -= 1;
        }
        near[to] = item;
        moves += at - to;
        if moves > 16 * near.len() {
            near.sort_unstable_by(order);
            return;
        }
    }
}

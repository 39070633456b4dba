//! Filters for nearest-neighbour searches.

/// Decides which points a search may return.
pub(crate) trait Accept {
    /// The subset of `hits` that is accepted. `hits` is a bit mask of the lanes of the block whose first slot is
    /// `first`.
    fn among(&mut self, hits: u32, first: u32) -> u32;
}

/// Accepts every point.
pub(crate) struct All;

impl Accept for All {
    #[inline(always)]
    fn among(&mut self, hits: u32, _: u32) -> u32 {
        hits
    }
}

/// Accepts the points for whose slot the function returns true.
pub(crate) struct If<F>(pub(crate) F);

impl<F: FnMut(u32) -> bool> Accept for If<F> {
    #[inline(always)]
    fn among(&mut self, hits: u32, first: u32) -> u32 {
        let (mut rest, mut accepted) = (hits, hits);
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            if !(self.0)(first + lane) {
                accepted &= !(1 << lane);
            }
        }
        accepted
    }
}

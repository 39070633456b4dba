//! Filters of a search for the nearest.

/// Which points may be found.
pub(crate) trait Accept {
    /// Those of the `hits` in a block, whose first slot is `first`, that are accepted.
    fn among(&mut self, hits: u32, first: u32) -> u32;
}

/// All.
pub(crate) struct All;

impl Accept for All {
    #[inline(always)]
    fn among(&mut self, hits: u32, _: u32) -> u32 {
        hits
    }
}

/// Those for whose slot a function is true.
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

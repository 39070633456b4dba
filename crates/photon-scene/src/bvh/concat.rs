//! Parts made by several threads, one after another in one table.

use std::mem::MaybeUninit;
use std::slice::IterMut;

use photon_core::parallel;

/// `head`, then the elements of all parts in order, each as `of` makes it from the index of its part and the element there.
pub(crate) fn concat<T: Copy + Send + Sync>(
    head: &[T],
    parts: &[&[T]],
    threads: usize,
    of: impl Fn(usize, T) -> T + Sync,
) -> Vec<T> {
    let lengths: Vec<usize> = parts.iter().map(|part| part.len()).collect();
    let mut all = Vec::with_capacity(head.len() + lengths.iter().sum::<usize>());
    all.extend(head);
    append(&mut all, &lengths, threads, |i, _, room| parts[i].iter().for_each(|&from| room.push(of(i, from))));
    all
}

/// The place of a part in a table.
pub(crate) struct Room<'a, T> {
    left: IterMut<'a, MaybeUninit<T>>,
}

impl<T> Room<'_, T> {
    /// Adds an element.
    ///
    /// # Panics
    /// Beyond the length of the part.
    pub(crate) fn push(&mut self, element: T) {
        assert!(self.left.len() > 0, "a part has more elements than expected");
        if let Some(place) = self.left.next() {
            place.write(element);
        }
    }
}

/// Adds parts of these lengths to a table. `fill` gets the index of a part, that of its first element in the table, and its
/// place, which it fills; its results are returned in order. Memory is touched by the thread that fills it, and only then.
pub(crate) fn append<T: Send, R: Send>(
    all: &mut Vec<T>,
    lengths: &[usize],
    threads: usize,
    fill: impl Fn(usize, u32, &mut Room<'_, T>) -> R + Sync,
) -> Vec<R> {
    let (first, count) = (all.len(), lengths.iter().sum::<usize>());
    all.reserve_exact(count);
    let mut rest = &mut all.spare_capacity_mut()[..count];
    let mut tasks = Vec::with_capacity(lengths.len());
    for (start, &length) in starts(first, lengths.iter().copied()).into_iter().zip(lengths) {
        let (own, after) = rest.split_at_mut(length);
        rest = after;
        tasks.push((start, Room { left: own.iter_mut() }));
    }
    let filled = parallel::map(threads, tasks.into_iter(), |i, (start, mut room)| {
        let result = fill(i, start, &mut room);
        (result, room.left.len())
    });
    let is_whole = filled.len() == lengths.len() && filled.iter().all(|(_, left)| *left == 0);
    assert!(is_whole, "a part has fewer elements than expected");
    #[allow(unsafe_code, reason = "zeros first would touch all memory twice, by one thread")]
    // SAFETY: the parts follow each other up to that length, and every element of every part has been written.
    unsafe {
        all.set_len(first + count);
    }
    filled.into_iter().map(|(result, _)| result).collect()
}

/// For each part, the number of elements in the parts before it and in `head` others.
pub(crate) fn starts(head: usize, lengths: impl Iterator<Item = usize>) -> Vec<u32> {
    let mut next = head;
    let start = |length| {
        next += length;
        (next - length) as u32
    };
    lengths.map(start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "fewer elements")]
    fn a_part_that_is_not_filled_is_noticed() {
        append(&mut vec![1, 2], &[2, 3], 2, |i, _, room| (0..2).for_each(|_| room.push(i)));
    }

    #[test]
    #[should_panic(expected = "more elements")]
    fn a_part_that_is_too_long_is_noticed() {
        append(&mut Vec::new(), &[1], 1, |i, _, room| (0..2).for_each(|_| room.push(i)));
    }

    #[test]
    fn parts_come_in_order_for_any_number_of_threads() {
        let parts: [&[u32]; 4] = [&[1, 2], &[], &[3], &[4, 5, 6]];
        for threads in [1, 2, 7] {
            let all = concat(&[100, 200], &parts, threads, |part, x| 10 * part as u32 + x);
            assert_eq!(all, [100, 200, 1, 2, 23, 34, 35, 36]);
        }
        assert_eq!(starts(2, parts.iter().map(|part| part.len())), [2, 4, 4, 5]);
    }
}

//! Parts made by several threads, one after another in one table.

use bytemuck::Zeroable;
use bytemuck::allocation::zeroed_vec;
use photon_core::parallel;

/// `head`, then the elements of all parts in order, each as `of` makes it from the index of its part and the element there.
pub(crate) fn concat<T: Copy + Zeroable + Send + Sync>(
    head: &[T],
    parts: &[&[T]],
    threads: usize,
    of: impl Fn(usize, T) -> T + Sync,
) -> Vec<T> {
    let count: usize = parts.iter().map(|part| part.len()).sum();
    // Memory that the threads touch first.
    let mut all: Vec<T> = zeroed_vec(head.len() + count);
    let (first, mut rest) = all.split_at_mut(head.len());
    first.copy_from_slice(head);
    let mut tasks = Vec::with_capacity(parts.len());
    for part in parts {
        let (to, after) = rest.split_at_mut(part.len());
        rest = after;
        tasks.push((to, part));
    }
    parallel::for_each(threads, tasks.into_iter(), |i, (to, part)| {
        to.iter_mut().zip(part.iter()).for_each(|(to, &from)| *to = of(i, from));
    });
    all
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
    fn parts_come_in_order_for_any_number_of_threads() {
        let parts: [&[u32]; 4] = [&[1, 2], &[], &[3], &[4, 5, 6]];
        for threads in [1, 2, 7] {
            let all = concat(&[100, 200], &parts, threads, |part, x| 10 * part as u32 + x);
            assert_eq!(all, [100, 200, 1, 2, 23, 34, 35, 36]);
        }
        assert_eq!(starts(2, parts.iter().map(|part| part.len())), [2, 4, 4, 5]);
    }
}

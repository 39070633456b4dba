//! Work on large slices by all cores, for what is done a few times in a render: reading and judging films.
//!
//! Threads are started for each call and have ended when it returns: a process may fork between two calls. Results do not
//! depend on their number.

use std::thread;

/// With fewer elements, a thread takes longer to start than to work.
const LEAST: usize = 1 << 12;

/// Calls `work` for consecutive parts of `items`, each with the index of its first element.
pub fn for_each_part<T: Send>(items: &mut [T], work: impl Fn(usize, &mut [T]) + Sync) {
    let part = part(items.len());
    thread::scope(|scope| {
        let mut parts = items.chunks_mut(part).enumerate();
        // The first part is this thread's.
        let own = parts.next();
        for (i, items) in parts {
            let work = &work;
            scope.spawn(move || work(i * part, items));
        }
        if let Some((_, items)) = own {
            work(0, items);
        }
    });
}

/// The results of `of` for `0..count`, in order.
pub fn collect<T: Send>(count: usize, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let part = part(count);
    let mut parts: Vec<Vec<T>> = (0..count.div_ceil(part)).map(|_| Vec::new()).collect();
    for_each(&mut parts, |i, found| found.extend((i * part..((i + 1) * part).min(count)).map(&of)));
    let mut parts = parts.into_iter();
    let mut all = parts.next().unwrap_or_default();
    all.reserve_exact(count - all.len());
    parts.for_each(|part| all.extend(part));
    all
}

/// A thread for each element but the first, which is this thread's.
fn for_each<T: Send>(items: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    let Some((first, others)) = items.split_first_mut() else { return };
    thread::scope(|scope| {
        for (i, item) in others.iter_mut().enumerate() {
            let work = &work;
            scope.spawn(move || work(i + 1, item));
        }
        work(0, first);
    });
}

/// Length of a part: one for each core.
fn part(count: usize) -> usize {
    let threads = thread::available_parallelism().map_or(1, usize::from);
    count.div_ceil(threads).max(LEAST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_element_is_met_once_in_its_place() {
        for count in [0, 1, LEAST - 1, LEAST, 3 * LEAST + 7, 40 * LEAST + 1] {
            let squares = collect(count, |i| i as u64 * 3);
            assert!(squares.len() == count && squares.iter().enumerate().all(|(i, &n)| n == i as u64 * 3), "{count}");
            let mut items = vec![0_usize; count];
            for_each_part(&mut items, |first, part| part.iter_mut().enumerate().for_each(|(i, n)| *n += first + i + 1));
            assert!(items.iter().enumerate().all(|(i, &n)| n == i + 1), "{count}");
        }
    }

    #[test]
    #[should_panic(expected = "a scoped thread panicked")]
    fn a_panic_is_not_lost() {
        let _ = collect(64 * LEAST, |i| assert!(i < LEAST * 60, "too far"));
    }
}

//! Work on large slices by all cores, for what is done a few times in a render: preparing scenes, reading and judging films.
//!
//! Threads are started for each call and have ended when it returns: a process may fork between two calls. There are as many
//! as the process may use cores, whatever the number of threads of a backend, unless a caller says how many. Results do not
//! depend on their number: without any other thread, as where the system has none left, the calling one does it all.

use std::sync::{Mutex, PoisonError};
use std::thread;

use bytemuck::Zeroable;
use bytemuck::allocation::zeroed_vec;

/// With fewer elements, a thread takes longer to start than to work.
const LEAST: usize = 1 << 12;

/// Calls `work` for consecutive parts of `items`, each with the index of its first element.
pub fn for_each_part<T: Send>(items: &mut [T], work: impl Fn(usize, &mut [T]) + Sync) {
    let part = part(items.len());
    for_each(threads(), items.chunks_mut(part), |i, items| work(i * part, items));
}

/// The results of `of` for `0..count`, in order, of a type that may be zero bytes.
pub fn collect_plain<T: Zeroable + Send>(count: usize, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut all = zeroed_vec(count);
    for_each_part(&mut all, |first, part| part.iter_mut().zip(first..).for_each(|(to, i)| *to = of(i)));
    all
}

/// As [`collect_plain`] for any type. It takes the memory of the results twice.
pub fn collect<T: Send>(count: usize, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let part = part(count);
    let mut parts: Vec<Vec<T>> = (0..count.div_ceil(part)).map(|_| Vec::new()).collect();
    for_each(threads(), parts.iter_mut(), |i, found| found.extend((i * part..((i + 1) * part).min(count)).map(&of)));
    let mut parts = parts.into_iter();
    let mut all = parts.next().unwrap_or_default();
    all.reserve_exact(count - all.len());
    parts.for_each(|part| all.extend(part));
    all
}

/// Calls `work` for each item and its index; up to `threads` threads, the calling one among them, take the items in turn. An
/// item should take longer than starting a thread, some 50 µs.
pub fn for_each<P: Send>(
    threads: usize,
    items: impl ExactSizeIterator<Item = P> + Send,
    work: impl Fn(usize, P) + Sync,
) {
    let others = items.len().min(threads).saturating_sub(1);
    let items = Mutex::new(items.enumerate());
    let take = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work_on = || {
        while let Some((i, item)) = take() {
            work(i, item);
        }
    };
    thread::scope(|scope| {
        for _ in 0..others {
            if thread::Builder::new().spawn_scoped(scope, work_on).is_err() {
                break;
            }
        }
        work_on();
    });
}

/// The results of `of` for each item and its index, in the order of the items; as [`for_each`].
pub fn map<P: Send, T: Send>(
    threads: usize,
    items: impl ExactSizeIterator<Item = P> + Send,
    of: impl Fn(usize, P) -> T + Sync,
) -> Vec<T> {
    let mut results: Vec<Option<T>> = (0..items.len()).map(|_| None).collect();
    for_each(threads, items.zip(results.iter_mut()), |i, (item, result)| *result = Some(of(i, item)));
    results.into_iter().flatten().collect()
}

/// Number of cores that the process may use.
#[must_use]
pub fn threads() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Length of a part: one for each core.
fn part(count: usize) -> usize {
    count.div_ceil(threads()).max(LEAST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_element_is_met_once_in_its_place() {
        for count in [0, 1, LEAST - 1, LEAST, 3 * LEAST + 7, 40 * LEAST + 1] {
            let squares = collect(count, |i| i as u64 * 3);
            assert!(squares.len() == count && squares.iter().enumerate().all(|(i, &n)| n == i as u64 * 3), "{count}");
            assert_eq!(collect_plain(count, |i| i as u64 * 3), squares);
            let mut items = vec![0_usize; count];
            for_each_part(&mut items, |first, part| part.iter_mut().enumerate().for_each(|(i, n)| *n += first + i + 1));
            assert!(items.iter().enumerate().all(|(i, &n)| n == i + 1), "{count}");
        }
    }

    #[test]
    fn results_are_in_order_for_any_number_of_threads() {
        for threads in [0, 1, 2, 7] {
            let found = map(threads, (0..100).rev(), |i, item: u32| (i as u32, item));
            assert!(
                found.len() == 100
                    && found.iter().enumerate().all(|(i, &(at, item))| at == i as u32 && item == 99 - at)
            );
        }
        assert!(map(3, [0_u8; 0].iter(), |_, &item| item).is_empty());
    }

    #[test]
    fn a_panic_is_not_lost() {
        let late = || collect(64 * LEAST, |i| assert!(i < LEAST * 60, "too far"));
        assert!(std::panic::catch_unwind(late).is_err());
    }
}

//! Fallible allocation. Growing a [`Vec`] aborts the process where memory is exhausted; whatever may become large is
//! allocated by these functions instead, which return an error.

use bytemuck::Zeroable;

/// An allocation that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("out of memory: {bytes} bytes for {label}")]
pub struct OutOfMemory {
    /// Purpose of the memory.
    pub label: &'static str,
    /// Its size, bytes.
    pub bytes: u64,
}

/// The error of `count` elements of type `T`.
fn refused<T>(count: usize, label: &'static str) -> OutOfMemory {
    OutOfMemory { label, bytes: (count as u64).saturating_mul(size_of::<T>() as u64) }
}

/// Makes room for `more` elements behind those of `list`, and no more than that.
///
/// # Errors
/// [`OutOfMemory`].
pub fn reserve<T>(list: &mut Vec<T>, more: usize, label: &'static str) -> Result<(), OutOfMemory> {
    list.try_reserve_exact(more).map_err(|_| refused::<T>(list.len().saturating_add(more), label))
}

/// Makes room for `more` elements behind those of `list`, or for twice as many as it holds: for lists that grow step by
/// step.
///
/// # Errors
/// [`OutOfMemory`].
#[inline]
pub fn reserve_doubling<T>(list: &mut Vec<T>, more: usize, label: &'static str) -> Result<(), OutOfMemory> {
    list.try_reserve(more).map_err(|_| refused::<T>(list.len().saturating_add(more), label))
}

/// An empty list with room for `count` elements.
///
/// # Errors
/// [`OutOfMemory`].
pub fn with_capacity<T>(count: usize, label: &'static str) -> Result<Vec<T>, OutOfMemory> {
    let mut list = Vec::new();
    reserve(&mut list, count, label)?;
    Ok(list)
}

/// `count` copies of `value`.
///
/// # Errors
/// [`OutOfMemory`].
pub fn filled<T: Clone>(count: usize, value: T, label: &'static str) -> Result<Vec<T>, OutOfMemory> {
    let mut list = with_capacity(count, label)?;
    list.resize(count, value);
    Ok(list)
}

/// `count` zeros. The pages are not touched, so that the system provides them to the threads that write them first.
///
/// # Errors
/// [`OutOfMemory`].
pub fn zeroed<T: Zeroable>(count: usize, label: &'static str) -> Result<Vec<T>, OutOfMemory> {
    bytemuck::allocation::try_zeroed_vec(count).map_err(|()| refused::<T>(count, label))
}

/// A copy of `values`.
///
/// # Errors
/// [`OutOfMemory`].
pub fn copied<T: Copy>(values: &[T], label: &'static str) -> Result<Vec<T>, OutOfMemory> {
    let mut list = with_capacity(values.len(), label)?;
    list.extend_from_slice(values);
    Ok(list)
}

/// The elements of an iterator of known length.
///
/// # Errors
/// [`OutOfMemory`].
pub fn collected<T>(values: impl ExactSizeIterator<Item = T>, label: &'static str) -> Result<Vec<T>, OutOfMemory> {
    let mut list = with_capacity(values.len(), label)?;
    list.extend(values);
    Ok(list)
}

/// Checks that this much memory is there, before a library that cannot report its absence allocates it: allocates it and
/// frees it again. Nothing is written, so it costs two system calls.
///
/// # Errors
/// [`OutOfMemory`].
pub fn check(bytes: u64, label: &'static str) -> Result<(), OutOfMemory> {
    let refused = OutOfMemory { label, bytes };
    let count = usize::try_from(bytes).map_err(|_| refused)?;
    let list = with_capacity::<u8>(count, label)?;
    // Otherwise the optimiser removes the allocation, and the check with it.
    std::hint::black_box(list.as_ptr());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_sizes_are_errors_that_name_the_buffer() {
        let (huge, label) = (usize::MAX / 8, "photons");
        let expected = OutOfMemory { label, bytes: huge as u64 * 4 };
        assert_eq!(with_capacity::<f32>(huge, label).unwrap_err(), expected);
        assert_eq!(filled(huge, 1.0_f32, label).unwrap_err(), expected);
        assert_eq!(zeroed::<f32>(huge, label).unwrap_err(), expected);
        assert_eq!(reserve(&mut vec![1.0_f32; 2], huge - 2, label).unwrap_err(), expected);
        assert_eq!(check(u64::MAX / 2 + 1, label).unwrap_err().bytes, u64::MAX / 2 + 1);
        assert!(expected.to_string().contains("for photons"));
    }

    #[test]
    fn possible_ones_hold_their_values() {
        assert_eq!(filled(3, 7_u8, "").unwrap(), [7; 3]);
        assert_eq!(zeroed::<u32>(2, "").unwrap(), [0; 2]);
        assert_eq!(copied(&[1, 2], "").unwrap(), [1, 2]);
        assert_eq!(collected([1, 2].into_iter().map(|x| x + 1), "").unwrap(), [2, 3]);
        check(1 << 20, "").unwrap();
    }
}

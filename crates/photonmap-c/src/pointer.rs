//! Arrays, text, structs and handles of the caller: the checks that are possible, in one place.

use std::ffi::{CStr, c_char, c_void};

use crate::error::{Fault, Result};

/// The array of `count` elements at `pointer`, which may be NULL if there are none.
///
/// # Safety
/// `pointer` is NULL, or points to `count` initialised elements that nothing changes during `'a`.
pub(crate) unsafe fn array<'a, T>(pointer: *const T, count: usize, name: &str) -> Result<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check(pointer.cast(), count, size_of::<T>(), align_of::<T>(), name)?;
    // SAFETY: not NULL, aligned, and not larger than an allocation can be; the caller ensures the rest.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// As [`array`], to be written.
///
/// # Safety
/// As [`array`], and nothing else refers to the elements.
pub(crate) unsafe fn array_mut<'a, T>(pointer: *mut T, count: usize, name: &str) -> Result<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(pointer.cast_const().cast(), count, size_of::<T>(), align_of::<T>(), name)?;
    // SAFETY: as in `array`.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

fn check(pointer: *const c_void, count: usize, size: usize, align: usize, name: &str) -> Result {
    if pointer.is_null() {
        return Err(Fault::argument(format!("{name} is NULL, but has to have {count} elements")));
    }
    if !(pointer as usize).is_multiple_of(align) {
        return Err(Fault::argument(format!("{name} is not aligned to {align} bytes")));
    }
    if count.checked_mul(size).is_none_or(|bytes| bytes > isize::MAX as usize) {
        return Err(Fault::argument(format!("{name} has {count} elements, more than fit into memory")));
    }
    Ok(())
}

/// The product of two counts of the caller.
pub(crate) fn product(a: usize, b: usize, name: &str) -> Result<usize> {
    a.checked_mul(b).ok_or_else(|| Fault::argument(format!("{name}: {a} times {b} elements do not fit into memory")))
}

/// The text at `pointer`; `None` if it is NULL.
///
/// # Safety
/// `pointer` is NULL, or points to a text that ends with a zero and that nothing changes during `'a`.
pub(crate) unsafe fn text_or_null<'a>(pointer: *const c_char, name: &str) -> Result<Option<&'a str>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: not NULL; the caller ensures the rest.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map(Some).map_err(|_| Fault::argument(format!("{name} is no UTF-8")))
}

/// The text at `pointer`, which must not be NULL.
///
/// # Safety
/// As [`text_or_null`].
pub(crate) unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str> {
    // SAFETY: as the caller ensures.
    unsafe { text_or_null(pointer, name) }?.ok_or_else(|| Fault::argument(format!("{name} is NULL")))
}

/// Copies `text` with a zero at its end, cut to `room` bytes at a character. Returns the length of the whole text.
///
/// # Safety
/// `to` is NULL, or has room for `room` bytes.
pub(crate) unsafe fn copy_text(text: &str, to: *mut c_char, room: usize) -> usize {
    if !to.is_null() && room > 0 {
        let mut cut = text.len().min(room - 1);
        while !text.is_char_boundary(cut) {
            cut -= 1;
        }
        // SAFETY: `cut` is below `room`, and the text is not in the caller's buffer.
        unsafe {
            std::ptr::copy_nonoverlapping(text.as_ptr().cast(), to, cut);
            to.add(cut).write(0);
        }
    }
    text.len()
}

/// A handle or a struct to read.
///
/// # Safety
/// `pointer` is NULL, or points to a valid value that nothing changes during `'a`.
pub(crate) unsafe fn shared<'a, T>(pointer: *const T, name: &str) -> Result<&'a T> {
    // SAFETY: as the caller ensures.
    unsafe { pointer.as_ref() }.ok_or_else(|| Fault::argument(format!("{name} is NULL")))
}

/// A handle to change.
///
/// # Safety
/// `pointer` is NULL, or points to a valid value that nothing else refers to during `'a`.
pub(crate) unsafe fn exclusive<'a, T>(pointer: *mut T, name: &str) -> Result<&'a mut T> {
    // SAFETY: as the caller ensures.
    unsafe { pointer.as_mut() }.ok_or_else(|| Fault::argument(format!("{name} is NULL")))
}

/// Makes a value with `make` and stores a handle of it in `out`, which is NULL if it fails.
///
/// # Safety
/// `out` is NULL, or a pointer can be written to it.
pub(crate) unsafe fn hand_out<T>(out: *mut *mut T, make: impl FnOnce() -> Result<T>) -> Result {
    if out.is_null() {
        return Err(Fault::argument("the pointer to the new handle is NULL"));
    }
    // SAFETY: not NULL; the caller ensures the rest.
    unsafe { out.write(std::ptr::null_mut()) };
    let made = Box::into_raw(Box::new(make()?));
    // SAFETY: as above.
    unsafe { out.write(made) };
    Ok(())
}

/// Frees a handle; NULL is ignored.
///
/// # Safety
/// `handle` is NULL, or comes from [`hand_out`] and has not been freed.
pub(crate) unsafe fn free<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: from `Box::into_raw`, and not freed before.
        drop(unsafe { Box::from_raw(handle) });
    }
}

/// A struct that begins with its size, so that fields can be added: its known part is read, and the rest is zero.
///
/// # Safety
/// Implementors are `repr(C)`, begin with `size: usize`, and are valid if all their bytes are zero, or the bytes of a valid
/// value followed by zeros.
pub(crate) unsafe trait Versioned: Copy {
    /// Name in messages.
    const NAME: &'static str;
    /// The smallest size that a version of the interface had.
    const LEAST: usize;
}

/// Reads a struct of the caller, which may be shorter or longer than ours.
///
/// # Safety
/// `pointer` is NULL, or points to a struct of the size that it begins with.
pub(crate) unsafe fn read<T: Versioned>(pointer: *const T) -> Result<T> {
    // SAFETY: as the caller ensures.
    let size = unsafe { size_at(pointer) }?;
    let mut value = std::mem::MaybeUninit::<T>::zeroed();
    let known = size.min(size_of::<T>());
    // SAFETY: both have at least `known` bytes.
    unsafe { std::ptr::copy_nonoverlapping(pointer.cast::<u8>(), value.as_mut_ptr().cast::<u8>(), known) };
    // SAFETY: bytes of the caller followed by zeros, which `Versioned` promises to be valid.
    Ok(unsafe { value.assume_init() })
}

/// Writes the part of a struct that the caller knows, except for its size.
///
/// # Safety
/// `pointer` is NULL, or points to a struct of the size that it begins with, which can be written.
pub(crate) unsafe fn write<T: Versioned>(pointer: *mut T, value: &T) -> Result {
    // SAFETY: as the caller ensures.
    let size = unsafe { size_at(pointer.cast_const()) }?;
    let (own, known) = (size_of::<usize>(), size.min(size_of::<T>()));
    let from = std::ptr::from_ref(value).cast::<u8>();
    // SAFETY: both have at least `known` bytes, which is more than `own`.
    unsafe { std::ptr::copy_nonoverlapping(from.add(own), pointer.cast::<u8>().add(own), known - own) };
    Ok(())
}

/// The size that a struct begins with, which has to be plausible.
unsafe fn size_at<T: Versioned>(pointer: *const T) -> Result<usize> {
    if pointer.is_null() {
        return Err(Fault::argument(format!("{} is NULL", T::NAME)));
    }
    if !pointer.is_aligned() {
        return Err(Fault::argument(format!("{} is not aligned", T::NAME)));
    }
    // SAFETY: not NULL and aligned; the struct begins with its size.
    let size = unsafe { pointer.cast::<usize>().read() };
    // A struct that was not initialised would be read beyond its end.
    if !(T::LEAST..=T::LEAST.max(size_of::<T>()) + 4096).contains(&size) {
        let name = T::NAME;
        return Err(Fault::argument(format!("{name}: its size is {size}; set it to sizeof({name})")));
    }
    Ok(size)
}

/// Implements [`Versioned`] for structs of the first version of the interface.
macro_rules! versioned {
    ($($type:ident),+) => {$(
        // SAFETY: `repr(C)`, begins with its size, and has only numbers, pointers and optional functions, which may be zero.
        unsafe impl crate::pointer::Versioned for $type {
            const NAME: &'static str = stringify!($type);
            const LEAST: usize = size_of::<Self>();
        }
    )+};
}
pub(crate) use versioned;

#[cfg(test)]
mod tests;

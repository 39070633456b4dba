use super::*;
use crate::error::{PmStatus, call};

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Old {
    size: usize,
    first: u32,
}

/// A later version of `Old`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
struct New {
    size: usize,
    first: u32,
    second: u32,
    name: *const c_char,
}

// SAFETY: numbers and a pointer.
unsafe impl Versioned for New {
    const NAME: &'static str = "New";
    const LEAST: usize = size_of::<Old>();
}

#[test]
fn structs_of_older_and_newer_programs_are_read() {
    let old = Old { size: size_of::<Old>(), first: 7 };
    // SAFETY: a struct of the size that it begins with.
    let read_old = unsafe { read(std::ptr::from_ref(&old).cast::<New>()) }.unwrap();
    assert_eq!((read_old.first, read_old.name), (7, std::ptr::null()));
    #[repr(C)]
    struct Newer(New, [u64; 4]);
    let new = New { size: size_of::<Newer>(), first: 1, second: 2, name: c"x".as_ptr() };
    let mut newer = Newer(new, [9; 4]);
    // SAFETY: as above.
    assert_eq!(unsafe { read(&raw const newer.0) }.unwrap(), new);
    // SAFETY: as above.
    unsafe { write(&raw mut newer.0, &New { size: 0, first: 3, second: 4, name: std::ptr::null() }) }.unwrap();
    assert_eq!((newer.0.size, newer.0.second, newer.1), (size_of::<Newer>(), 4, [9; 4]));
}

#[test]
fn structs_of_absurd_sizes_are_refused() {
    for size in [0, 1, size_of::<Old>() - 1, 1 << 20, usize::MAX] {
        let old = Old { size, first: 7 };
        // SAFETY: only the size is read.
        let error = unsafe { read(std::ptr::from_ref(&old).cast::<New>()) }.unwrap_err();
        assert!(format!("{error:?}").contains("sizeof(New)"), "{error:?}");
    }
    // SAFETY: NULL is allowed.
    assert!(unsafe { read(std::ptr::null::<New>()) }.is_err());
}

#[test]
fn arrays_are_checked() {
    let numbers = [1.0_f32, 2.0];
    // SAFETY: in bounds, or refused before anything is read.
    unsafe {
        assert_eq!(array(numbers.as_ptr(), 2, "x").unwrap(), numbers);
        assert!(array::<f32>(std::ptr::null(), 0, "x").unwrap().is_empty());
        assert!(array::<f32>(std::ptr::null(), 1, "x").is_err());
        assert!(array(numbers.as_ptr().byte_add(1), 1, "x").is_err());
        for count in [usize::MAX, usize::MAX / 4, isize::MAX as usize / 4 + 1] {
            assert!(array(numbers.as_ptr(), count, "x").is_err());
            assert!(array_mut(numbers.as_ptr().cast_mut(), count, "x").is_err());
        }
    }
    assert!(product(usize::MAX, 2, "x").is_err() && product(usize::MAX, 1, "x").is_ok());
}

#[test]
fn texts_are_cut_at_characters_and_end_with_zero() {
    for (room, expected) in [(5, "aöb"), (4, "aö"), (3, "a"), (2, "a"), (1, "")] {
        let mut buffer = [b'?' as c_char; 8];
        // SAFETY: the buffer is larger than `room`.
        let length = unsafe { copy_text("aöb", buffer.as_mut_ptr(), room) };
        assert_eq!(length, 4);
        // SAFETY: ends with a zero.
        let text = unsafe { text(buffer.as_ptr(), "x") }.unwrap();
        assert_eq!((text, buffer[7]), (expected, b'?' as c_char));
    }
    // SAFETY: nothing is written.
    assert_eq!(unsafe { copy_text("aöb", std::ptr::null_mut(), 0) }, 4);
    let bad = [0xff_u8 as c_char, 0];
    // SAFETY: ends with a zero.
    assert!(unsafe { text(bad.as_ptr(), "x") }.is_err());
}

#[test]
fn handles_of_failed_calls_are_null() {
    let mut handle = std::ptr::NonNull::<u32>::dangling().as_ptr();
    // SAFETY: a pointer to a handle.
    let status = call(|| unsafe { hand_out(&raw mut handle, || Err(Fault::argument("no"))) });
    assert_eq!((status, handle), (PmStatus::InvalidArgument, std::ptr::null_mut()));
    // SAFETY: as above, and a handle that was handed out.
    unsafe {
        hand_out(&raw mut handle, || Ok(3)).unwrap();
        assert_eq!(*shared(handle, "x").unwrap(), 3);
        free(handle);
        free::<u32>(std::ptr::null_mut());
        assert!(hand_out(std::ptr::null_mut::<*mut u32>(), || Ok(3)).is_err());
    }
}

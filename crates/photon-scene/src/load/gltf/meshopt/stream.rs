//! Reads the front of a compressed stream.

/// The stream ends too early.
pub(super) const TRUNCATED: &str = "it ends too early";
/// Bytes are left between the data and the tail.
pub(super) const TOO_LONG: &str = "it has more bytes than its elements need";

/// Splits a stream into its body and its tail of that many bytes.
pub(super) fn split<'a>(bytes: &'a [u8], tail: usize) -> Result<(Stream<'a>, &'a [u8]), &'static str> {
    let body = bytes.len().checked_sub(tail).ok_or(TRUNCATED)?;
    let (body, tail) = bytes.split_at(body);
    Ok((Stream(body), tail))
}

/// What is left to read.
pub(super) struct Stream<'a>(&'a [u8]);

impl<'a> Stream<'a> {
    /// The next bytes.
    pub(super) fn take(&mut self, length: usize) -> Result<&'a [u8], &'static str> {
        let (front, rest) = self.0.split_at_checked(length).ok_or(TRUNCATED)?;
        self.0 = rest;
        Ok(front)
    }

    /// The next byte.
    pub(super) fn byte(&mut self) -> Result<u8, &'static str> {
        let (&first, rest) = self.0.split_first().ok_or(TRUNCATED)?;
        self.0 = rest;
        Ok(first)
    }

    /// A 32-bit number in 1 to 5 bytes of 7 bits, the lowest first (LEB128); bits beyond 32 are ignored.
    pub(super) fn number(&mut self) -> Result<u32, &'static str> {
        let mut value = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err("it has a number of more than 5 bytes")
    }

    /// Checks that nothing is left.
    pub(super) fn end(&self) -> Result<(), &'static str> {
        if self.0.is_empty() { Ok(()) } else { Err(TOO_LONG) }
    }
}

/// Undoes the zigzag code of a signed number.
pub(super) fn unzigzag(value: u32) -> u32 {
    if value & 1 == 0 { value >> 1 } else { !(value >> 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of the specification, of which the last is printed in reverse order.
    #[test]
    fn numbers_start_at_their_lowest_bits() {
        for (bytes, number) in [
            (&[0x7f][..], 0x7f),
            (&[0x81, 0x04], 0x201),
            (&[0xff, 0xa0, 0x05], 0x1_507f),
            (&[0xff, 0xff, 0xff, 0xff, 0x7f], u32::MAX),
        ] {
            let mut stream = Stream(bytes);
            assert_eq!(stream.number(), Ok(number), "{bytes:x?}");
            assert_eq!(stream.end(), Ok(()));
        }
        assert_eq!(Stream(&[0x80, 0x80]).number(), Err(TRUNCATED));
        assert!(Stream(&[0x80; 6]).number().is_err());
        assert_eq!(Stream(&[1]).end(), Err(TOO_LONG));
    }

    #[test]
    fn zigzag_alternates_signs() {
        let signed: Vec<i32> = (0..5).map(|code| unzigzag(code) as i32).collect();
        assert_eq!(signed, [0, -1, 1, -2, 2]);
        assert_eq!(unzigzag(u32::MAX) as i32, i32::MIN);
    }
}

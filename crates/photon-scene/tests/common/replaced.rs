//! Changes to the bytes of a file.

/// Replaces all occurrences by a text of equal length, so that no chunk length changes.
pub(crate) fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut all = bytes.to_vec();
    let mut at = 0;
    while let Some(found) = all[at..].windows(from.len()).position(|window| window == from) {
        all[at + found..][..to.len()].copy_from_slice(to);
        at += found + to.len();
    }
    assert!(at > 0, "there is something to replace");
    all
}

//! Which boxes make the builder of obvhs degenerate.

use super::{Padded, TWINS, has_twins, is_crowded};

/// `count` different boxes; after each seventh, one more of `twins` identical ones, and the rest of these at the end.
fn boxes(count: usize, twins: usize) -> Vec<Padded> {
    let twin = Padded::around([[0.5; 3]; 3]);
    let mut boxes = Vec::new();
    for i in 0..count {
        let at = [i as f32 / count as f32 - 0.5, 0.0, (i % 3) as f32 * 0.1];
        boxes.push(Padded::around([at, at.map(|c| c + 0.01), at]));
        if i % 7 == 0 && i / 7 < twins {
            boxes.push(twin);
        }
    }
    boxes.resize(count + twins, twin);
    boxes
}

#[test]
fn sixty_four_identical_boxes_are_found() {
    assert!(!has_twins(&[]));
    for count in [0, 1, 2, 63, 64, 65, 1_000, 50_000] {
        for twins in [0, 1, 2, TWINS - 1] {
            assert!(!has_twins(&boxes(count, twins)), "{count} and {twins}");
        }
        for twins in [TWINS, TWINS + 1, 300, 5_000] {
            assert!(has_twins(&boxes(count, twins)), "{count} and {twins}");
        }
    }
}

/// Different boxes with the same hash are not taken for identical ones, and few boxes have the same hash.
#[test]
fn equal_hashes_are_not_equal_boxes() {
    let mesh = boxes(50_000, 0);
    assert!(is_crowded(&mesh, 1), "50,000 boxes have two hashes of one bit");
    assert!(!is_crowded(&mesh, 16), "the sort would be needed");
    assert!(!has_twins(&mesh));
    let crowd = boxes(63, TWINS - 1);
    assert!(is_crowded(&crowd, 1) && !has_twins(&crowd));
}

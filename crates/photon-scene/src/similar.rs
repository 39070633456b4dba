//! Names that a misspelt one was probably meant to be.

/// Most names that a message lists.
const MAX_NAMES: usize = 8;
/// Names of more characters are compared by their beginnings, and names beyond so many not at all.
const LONGEST: usize = 64;
const MOST: usize = 10_000;

/// Sorts names: those that are most like `wanted` come first.
pub(crate) fn sort(wanted: &str, names: &mut [&str]) {
    let wanted = wanted.to_lowercase();
    let compared = names.len().min(MOST);
    names[..compared].sort_by_cached_key(|name| unlikeness(&wanted, &name.to_lowercase()));
}

/// The end of a message on a name that does not exist: the most similar ones if they are near, else some.
///
/// ```
/// assert_eq!(photon_scene::did_you_mean("conrell", ["ring", "cornell"]), "did you mean 'cornell'?");
/// assert_eq!(photon_scene::did_you_mean("sphere", ["ring", "cornell"]), "there are 'ring', 'cornell'");
/// ```
#[must_use]
pub fn did_you_mean<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let mut names: Vec<&str> = names.into_iter().collect();
    sort(wanted, &mut names);
    let Some(first) = names.first() else { return "there are none".to_owned() };
    let quoted = |name: &&str| format!("'{name}'");
    if is_near(wanted, first) {
        let also = names.iter().skip(1).take_while(|name| is_near(wanted, name));
        let near: Vec<_> = names.iter().take(1).chain(also.take(2)).map(quoted).collect();
        return format!("did you mean {}?", near.join(" or "));
    }
    let listed: Vec<_> = names.iter().take(MAX_NAMES).map(quoted).collect();
    let rest = match names.len().saturating_sub(MAX_NAMES) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("there are {}{rest}", listed.join(", "))
}

/// Whether a name differs by few letters, or contains the other.
fn is_near(wanted: &str, name: &str) -> bool {
    let (wanted, name) = (wanted.to_lowercase(), name.to_lowercase());
    let edits = unlikeness(&wanted, &name).1;
    edits <= (wanted.chars().count().max(name.chars().count()) / 3).max(1) && edits < wanted.chars().count()
        || contains(&wanted, &name)
}

/// Whether one of them is a part of the other.
fn contains(wanted: &str, name: &str) -> bool {
    let is_long = |part: &str| part.len() >= 3;
    is_long(wanted) && name.contains(wanted) || is_long(name) && wanted.contains(name)
}

/// Sorts before others what is more alike: what contains the other, then what differs by fewer letters.
fn unlikeness(wanted: &str, name: &str) -> (bool, usize) {
    (!contains(wanted, name), edits(wanted, name))
}

/// The number of letters to insert, remove, replace, or swap with the next, that makes one of the other.
fn edits(from: &str, to: &str) -> usize {
    let from: Vec<char> = from.chars().take(LONGEST).collect();
    let to: Vec<char> = to.chars().take(LONGEST).collect();
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=to.len()).collect();
    for (row, letter) in from.iter().enumerate() {
        let mut next = vec![row + 1];
        for (column, other) in to.iter().enumerate() {
            let replaced = last[column] + usize::from(letter != other);
            let mut least = replaced.min(last[column + 1] + 1).min(next[column] + 1);
            if row > 0 && column > 0 && *letter == to[column - 1] && from[row - 1] == *other {
                least = least.min(before[column - 1] + 1);
            }
            next.push(least);
        }
        before = std::mem::replace(&mut last, next);
    }
    last[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_counted() {
        for (from, to, count) in
            [("", "", 0), ("", "abc", 3), ("albdo", "albedo", 1), ("ponit", "point", 1), ("glas", "gloss", 2)]
        {
            assert_eq!((edits(from, to), edits(to, from)), (count, count), "{from} {to}");
        }
        assert_eq!(edits(&"a".repeat(1000), &"b".repeat(1000)), LONGEST);
    }

    #[test]
    fn the_nearest_name_is_suggested() {
        let keys =
            ["new", "kind", "albedo", "ior", "abbe", "alpha", "roughness", "clearcoat_roughness", "tint", "grid"];
        for (wanted, expected) in [
            ("albdo", "did you mean 'albedo'?"),
            ("Albedo", "did you mean 'albedo'?"),
            ("roughnes", "did you mean 'roughness' or 'clearcoat_roughness'?"),
            ("rougness", "did you mean 'roughness'?"),
            ("transparency", "there are "),
        ] {
            let found = did_you_mean(wanted, keys);
            assert!(found.starts_with(expected), "{wanted}: {found}");
        }
        assert!(did_you_mean("transparency", keys).ends_with(" and 2 more"));
        assert_eq!(did_you_mean("x", ["a", "b"]), "there are 'a', 'b'");
        assert_eq!(did_you_mean("x", []), "there are none");
        assert_eq!(did_you_mean("", ["a"]), "there are 'a'");
    }
}

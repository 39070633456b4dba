//! Many messages of one kind, such as one for each of 20,000 lights: the first few, and the number of the others.

use std::collections::BTreeMap;
use std::fmt::Display;

/// Messages of one kind up to which all are shown.
const ALL: usize = 10;

/// Messages of one kind that are shown if there are more.
const FIRST: usize = 3;

/// The messages; of a kind of which there are many, the first few and a line with the number of the others.
#[must_use]
pub fn summed_up<T: Display>(messages: &[T]) -> Vec<String> {
    let messages: Vec<(String, String)> =
        messages.iter().map(|message| message.to_string()).map(|text| (kind(&text), text)).collect();
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for (kind, _) in &messages {
        counts.entry(kind).or_default().0 += 1;
    }
    let mut lines = Vec::new();
    for (kind, text) in &messages {
        let Some((all, shown)) = counts.get_mut(kind.as_str()) else { continue };
        *shown += 1;
        if *all <= ALL || *shown <= FIRST {
            lines.push(text.clone());
        } else if *shown == FIRST + 1 {
            lines.push(format!("{} more of this kind", *all - FIRST));
        }
    }
    lines
}

/// A message without its numbers and what it quotes, and without the subject between the first two colons.
fn kind(text: &str) -> String {
    let parts: Vec<&str> = text.splitn(3, ": ").collect();
    let text = if let [first, _, rest] = parts[..] { format!("{first}: {rest}") } else { text.to_owned() };
    // Every second part is within quotation marks.
    let unquoted = text.split('\'').step_by(2).collect::<Vec<_>>().join("''");
    let mut kind = String::new();
    for word in unquoted.split(' ') {
        let is_number = word.contains(|c: char| c.is_ascii_digit());
        kind.push_str(if is_number { "#" } else { word });
        kind.push(' ');
    }
    kind
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_messages_are_all_shown_and_many_are_counted() {
        let light = |i: usize| format!("point light {i} gets about {:.1e} of the paths", i as f64 * 0.37);
        let wall = |i: usize| format!("approximated: wall {i}: its texture 'a{i} b.png' is {i} × {i} texels");
        let few: Vec<String> = (0..ALL).map(light).chain((0..ALL).map(wall)).collect();
        assert_eq!(summed_up(&few), few);
        let many: Vec<String> =
            (0..20_000).flat_map(|i| [light(i), wall(i)]).chain(["a last one".to_owned()]).collect();
        let shown = summed_up(&many);
        assert_eq!(shown[..6], many[..6]);
        assert_eq!(shown[6..], ["19997 more of this kind", "19997 more of this kind", "a last one"]);
        // Of one subject, but of different kinds.
        let different: Vec<String> = ('a'..='t').map(|letter| format!("left out: wall: {letter}")).collect();
        assert_eq!(summed_up(&different), different);
    }
}

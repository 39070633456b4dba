//! Checks relative links of Markdown pages, and whether the book's table of contents is complete.

use std::collections::{BTreeMap, BTreeSet};

const BOOK: &str = "docs/";
const SUMMARY: &str = "docs/SUMMARY.md";

/// The faults of the pages, given by their paths from the root of the repository; `exists` answers for
/// files that are not pages.
pub(crate) fn faults(pages: &BTreeMap<String, String>, exists: &dyn Fn(&str) -> bool) -> Vec<String> {
    let mut faults = Vec::new();
    let anchors: BTreeMap<&str, BTreeSet<String>> =
        pages.iter().map(|(name, text)| (name.as_str(), anchors(text))).collect();
    let mut listed = BTreeSet::new();
    for (name, text) in pages {
        for (line, target) in links(text) {
            let place = format!("{name}:{line}");
            let (file, anchor) = target.split_once('#').unwrap_or((&target, ""));
            let file = if file.is_empty() { Some(name.clone()) } else { resolve(name, file) };
            let Some(file) = file else {
                faults.push(format!("{place}: {target} leaves the repository"));
                continue;
            };
            if name == SUMMARY {
                listed.insert(file.clone());
            }
            if name.starts_with(BOOK) && !file.starts_with(BOOK) {
                faults.push(format!("{place}: {target} is not in the book; name the file without a link"));
            } else if let Some(known) = anchors.get(file.as_str()) {
                if !anchor.is_empty() && !known.contains(anchor) {
                    faults.push(format!("{place}: {file} has no heading #{anchor}"));
                }
            } else if !exists(&file) {
                faults.push(format!("{place}: there is no {file}"));
            }
        }
    }
    let in_book = pages.keys().filter(|name| name.starts_with(BOOK) && *name != SUMMARY);
    for name in in_book.filter(|name| !listed.contains(*name)) {
        faults.push(format!("{name}: add it to {SUMMARY}"));
    }
    faults
}

/// Relative targets of links and images, each with its line; code is skipped.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in prose(text) {
        let mut rest = line.as_str();
        while let Some((_, after)) = rest.split_once("](") {
            let Some((target, behind)) = after.split_once(')') else { break };
            if !target.contains("://") && !target.starts_with("mailto:") {
                found.push((number, target.to_owned()));
            }
            rest = behind;
        }
    }
    found
}

/// Anchors that headings get: lower case, spaces as hyphens, without punctuation.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut fenced = false;
    let mut found = BTreeSet::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        }
        if let Some((_, title)) = line.split_once(' ').filter(|(marks, _)| !fenced && is_heading(marks)) {
            let kept = title.trim().to_lowercase();
            let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
            found.insert(kept.map(|c| if c == ' ' { '-' } else { c }).collect());
        }
    }
    found
}

fn is_heading(marks: &str) -> bool {
    (1..=6).contains(&marks.len()) && marks.bytes().all(|mark| mark == b'#')
}

/// Lines outside of fenced code, without inline code.
fn prose(text: &str) -> Vec<(usize, String)> {
    let mut fenced = false;
    let mut lines = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            lines.push((index + 1, line.split('`').step_by(2).collect::<Vec<_>>().join("`")));
        }
    }
    lines
}

/// The path that a link from `page` refers to, if it stays within the root.
fn resolve(page: &str, target: &str) -> Option<String> {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in target.trim_end_matches('/').split('/') {
        match part {
            "." => {}
            ".." => drop(parts.pop()?),
            _ => parts.push(part),
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(pages: &[(&str, &str)]) -> Vec<String> {
        let pages = pages.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
        faults(&pages, &|file| file == "docs/rows.csv" || file == "LICENSE")
    }

    const GOOD: [(&str, &str); 4] = [
        ("README.md", "[guide](docs/guide.md) [licence](LICENSE) [site](https://example.org)\n"),
        ("docs/SUMMARY.md", "- [Guide](guide.md)\n- [Study](studies/one.md)\n"),
        ("docs/guide.md", "# Guide\n\n## The *two* ways, and `why`\n\n[rows](rows.csv)\n```\n[no](link.md)\n```\n"),
        ("docs/studies/one.md", "# One\n[way](../guide.md#the-two-ways-and-why), `[code](no.md)`, [top](#one)\n"),
    ];

    /// The one fault of the good pages with one of them replaced.
    #[track_caller]
    fn one_fault(name: &str, text: &str, part: &str) {
        let mut pages: Vec<(&str, &str)> = GOOD.into_iter().filter(|(known, _)| *known != name).collect();
        pages.push((name, text));
        let faults = check(&pages);
        assert_eq!(faults.len(), 1, "{faults:?}");
        assert!(faults[0].contains(part), "{faults:?}");
    }

    #[test]
    fn good_pages_pass() {
        assert_eq!(check(&GOOD), Vec::<String>::new());
    }

    #[test]
    fn dead_links_are_named_with_their_line() {
        one_fault("README.md", "\n[guide](docs/guid.md)\n", "README.md:2: there is no docs/guid.md");
        one_fault("docs/guide.md", "# The two ways and why\n![picture](no.png)\n", "docs/guide.md:2: there is no");
        one_fault("docs/guide.md", "# Else\n", "has no heading #the-two-ways-and-why");
        one_fault("README.md", "[up](../other.md)\n", "leaves the repository");
    }

    #[test]
    fn a_missing_page_and_one_that_is_not_listed_are_named() {
        let all = "- [Guide](guide.md)\n- [Study](studies/one.md)\n- [More](more.md)\n";
        one_fault("docs/SUMMARY.md", all, "there is no docs/more.md");
        one_fault("docs/SUMMARY.md", "- [Guide](guide.md)\n", "docs/studies/one.md: add it");
    }

    #[test]
    fn the_book_links_to_nothing_outside_of_itself() {
        one_fault("docs/guide.md", "# The two ways and why\n[l](../LICENSE)\n", "not in the book");
    }
}

//! Checks the licences of everything that is linked into the libraries and programs.
//!
//! `xtask-book` is a separate workspace and not checked: mdBook is MPL-2.0, but only renders the documentation.

use crate::graph::{Graph, Kind};

/// Permissive licences that require no more than a notice.
const ACCEPTED: [&str; 11] = [
    "MIT",
    "MIT-0",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "Zlib",
    "Unicode-3.0",
    "CC0-1.0",
    "Unlicense",
];

/// The libraries that the benchmarks compare with are not linked into anything that is distributed.
const FREE: &str = "photon-benches";

/// Fails if a dependency has none of the accepted licences.
pub(crate) fn step() -> Result<(), String> {
    let count = check(&Graph::of_workspace()?)?;
    eprintln!("{count} packages, all under permissive licences");
    Ok(())
}

fn check(graph: &Graph) -> Result<usize, String> {
    let members = graph.members().filter(|(_, package)| package.name != FREE).map(|(id, _)| id);
    let mut count = 0;
    let mut refused = Vec::new();
    for package in graph.reached(members, &[Kind::Normal, Kind::Build]) {
        count += 1;
        match &package.licence {
            Some(expression) if accepted(expression) => {}
            Some(expression) => refused.push(format!("  {} {}: {expression}", package.name, package.version)),
            None => refused.push(format!("  {} {}: none declared", package.name, package.version)),
        }
    }
    if refused.is_empty() {
        return Ok(count);
    }
    Err(format!("not among the accepted licences:\n{}", refused.join("\n")))
}

/// Whether an expression like `(MIT OR Apache-2.0) AND Zlib` can be satisfied with accepted licences.
///
/// `AND` binds tighter than `OR`; an old-style `/` means `OR`; parentheses nest.
fn accepted(expression: &str) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut rest = words.as_slice();
    any_of(&mut rest) == Some(true) && rest.is_empty()
}

fn any_of(rest: &mut &[&str]) -> Option<bool> {
    let mut good = all_of(rest)?;
    while let Some(("OR", after)) = rest.split_first().map(|(word, after)| (*word, after)) {
        *rest = after;
        good |= all_of(rest)?;
    }
    Some(good)
}

fn all_of(rest: &mut &[&str]) -> Option<bool> {
    let mut good = one(rest)?;
    while let Some(("AND", after)) = rest.split_first().map(|(word, after)| (*word, after)) {
        *rest = after;
        good &= one(rest)?;
    }
    Some(good)
}

fn one(rest: &mut &[&str]) -> Option<bool> {
    let (first, after) = rest.split_first()?;
    *rest = after;
    if *first == "(" {
        let good = any_of(rest)?;
        let (close, after) = rest.split_first()?;
        *rest = after;
        return (*close == ")").then_some(good);
    }
    let mut name = (*first).to_owned();
    if let ["WITH", exception, after @ ..] = rest {
        name = format!("{name} WITH {exception}");
        *rest = after;
    }
    Some(ACCEPTED.contains(&name.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::sample;

    #[test]
    fn expressions_are_read() {
        for good in [
            "MIT",
            "MIT OR GPL-3.0-only",
            "GPL-3.0-only OR MIT",
            "MIT/Apache-2.0",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
            "Apache-2.0 WITH LLVM-exception",
            "MIT AND (GPL-2.0-only OR Zlib)",
        ] {
            assert!(accepted(good), "{good}");
        }
        for bad in [
            "",
            "GPL-3.0-only",
            "MIT AND GPL-3.0-only",
            "(MIT OR Apache-2.0) AND GPL-3.0-only",
            "MIT WITH some-exception",
            "(MIT",
            "MIT)",
            "MIT OR",
        ] {
            assert!(!accepted(bad), "{bad}");
        }
    }

    #[test]
    fn a_refused_licence_is_named_unless_only_the_benchmarks_bring_it() {
        let graph = |member: &'static str, licence: Option<&'static str>| {
            sample::graph(
                &[(member, "0.1.0", "top", None, Some("MIT")), ("rival", "2.0.0", "registry", None, licence)],
                &[(0, 1, None)],
            )
        };
        let failure = check(&graph("examples", Some("GPL-3.0-only"))).unwrap_err();
        assert!(failure.contains("rival 2.0.0: GPL-3.0-only"), "{failure}");
        assert!(check(&graph("examples", None)).is_err());
        assert_eq!(check(&graph("examples", Some("ISC"))), Ok(2));
        assert_eq!(check(&graph(FREE, Some("GPL-3.0-only"))), Ok(0));
    }
}

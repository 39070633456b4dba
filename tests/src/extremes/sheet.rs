//! Result rows, and their output as text.

use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How much to test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// What the ordinary tests have time for; cases that they run anyway are skipped.
    Tests,
    /// The same, including those cases.
    Quick,
    /// Everything.
    Long,
}

/// The result of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It holds over the whole range.
    Holds,
    /// It does not hold. This is known, the row says so, and it fails in the way that is stated.
    Limit,
    /// It should hold and does not, or a known limit has moved.
    Fails,
}

/// One case.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its number in the table of failure modes, or a word.
    pub case: &'static str,
    /// What is tested and the expected result.
    pub what: String,
    /// The range over which it is tested.
    pub range: String,
    /// The measured result.
    pub found: String,
    /// The verdict.
    pub verdict: Verdict,
}

/// The rows of a group.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// How much to test.
    pub extent: Extent,
    /// The rows so far.
    pub rows: Vec<Row>,
}

impl Sheet {
    /// Runs a group. A panic in it becomes a failed row after the rows before it.
    #[must_use]
    pub fn run(group: fn(&mut Self), extent: Extent) -> Self {
        let mut sheet = Self { extent, rows: Vec::new() };
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| group(&mut sheet))) {
            sheet.push("—", "the group ends", "", words(&*panic), Verdict::Fails);
        }
        sheet
    }

    /// Whether everything is to be tested.
    #[must_use]
    pub fn long(&self) -> bool {
        self.extent == Extent::Long
    }

    /// `quick` or `long`, depending on the extent.
    #[must_use]
    pub fn either<V>(&self, quick: V, long: V) -> V {
        if self.long() { long } else { quick }
    }

    /// One of the values, depending on the extent.
    #[must_use]
    pub fn choose<V>(&self, tests: V, quick: V, long: V) -> V {
        match self.extent {
            Extent::Tests => tests,
            Extent::Quick => quick,
            Extent::Long => long,
        }
    }

    /// Adds a case that must hold.
    pub fn holds(
        &mut self,
        case: &'static str,
        what: impl Into<String>,
        range: impl Into<String>,
        found: impl Into<String>,
        good: bool,
    ) {
        self.push(case, what, range, found, if good { Verdict::Holds } else { Verdict::Fails });
    }

    /// Adds a case that is known not to hold; `as_said` tells whether it fails in the way that is stated.
    pub fn limit(
        &mut self,
        case: &'static str,
        what: impl Into<String>,
        range: impl Into<String>,
        found: impl Into<String>,
        as_said: bool,
    ) {
        self.push(case, what, range, found, if as_said { Verdict::Limit } else { Verdict::Fails });
    }

    /// Runs a case of the ordinary suite, which panics if it does not hold.
    pub fn proved(&mut self, case: &'static str, what: &str, range: &str, figure: &str, proof: fn()) {
        if self.extent == Extent::Tests {
            return;
        }
        match catch_unwind(proof) {
            Ok(()) => self.push(case, what, range, figure, Verdict::Holds),
            Err(panic) => self.push(case, what, range, words(&*panic), Verdict::Fails),
        }
    }

    fn push(
        &mut self,
        case: &'static str,
        what: impl Into<String>,
        range: impl Into<String>,
        found: impl Into<String>,
        verdict: Verdict,
    ) {
        let row = Row { case, what: what.into(), range: range.into(), found: found.into(), verdict };
        self.rows.push(row);
    }

    /// Descriptions of the rows that fail.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        let failed = self.rows.iter().filter(|row| row.verdict == Verdict::Fails);
        failed.map(|row| format!("{}: {} ({}): {}", row.case, row.what, row.range, row.found)).collect()
    }

    /// The rows as a Markdown table.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = "| case | what | range | found | |\n|---|---|---|---|---|\n".to_owned();
        for row in &self.rows {
            let verdict = match row.verdict {
                Verdict::Holds => "holds",
                Verdict::Limit => "**does not hold**",
                Verdict::Fails => "**FAILS**",
            };
            let cell = |text: &str| text.replace('|', "\\|").replace('\n', " ");
            let (what, range, found) = (cell(&row.what), cell(&row.range), cell(&row.found));
            let _ = writeln!(text, "| {} | {what} | {range} | {found} | {verdict} |", row.case);
        }
        text
    }
}

fn words(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    format!("panicked: {}", text.unwrap_or("without a word"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fails_is_told_and_what_is_known_is_not_a_fault() {
        let sheet = Sheet::run(
            |sheet| {
                sheet.holds("A", "good", "1", "1", true);
                sheet.limit("B", "known", "2", "2", true);
                sheet.limit("C", "moved", "3", "3", false);
                sheet.holds("D", "bad|", "4", "4", false);
                sheet.proved("E", "proof", "5", "5", || assert_eq!(1, 2));
                panic!("end");
            },
            Extent::Quick,
        );
        let faults = sheet.faults();
        assert_eq!(faults.len(), 4, "{faults:?}");
        for (fault, part) in faults.iter().zip(["C: moved", "D: bad|", "panicked: assertion", "panicked: end"]) {
            assert!(fault.contains(part), "{fault}");
        }
        assert!(sheet.table().contains("| D | bad\\| | 4 | 4 | **FAILS** |"));
    }
}

//! Progress of a render: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::watch::Said;

/// Minimum interval between plain lines.
const INTERVAL: Duration = Duration::from_secs(5);

/// What is known beforehand about the end of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// The number of passes.
    Passes(u32),
    /// The time.
    Time(Duration),
    /// Neither.
    Open,
}

/// Shows passes, rate and time left while a scene is rendered.
#[derive(Debug)]
pub struct Progress {
    limit: Limit,
    begun: Instant,
    /// `None` where standard error is not a terminal.
    bar: Option<ProgressBar>,
    shown: Instant,
}

impl Progress {
    /// Starts the clock.
    #[must_use]
    pub fn new(limit: Limit) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| bar(limit));
        let now = Instant::now();
        Self { limit, begun: now, bar, shown: now }
    }

    /// Reports that `done` passes are finished.
    pub fn passes(&mut self, done: u32) {
        let elapsed = self.begun.elapsed();
        let text = line(done, self.limit, elapsed);
        if let Some(bar) = &self.bar {
            bar.set_position((1000.0 * fraction(done, self.limit, elapsed)) as u64);
            bar.set_message(text);
        } else if self.shown.elapsed() >= INTERVAL {
            say!("{text}");
            self.shown = Instant::now();
        }
    }

    /// Prints a message without disturbing the bar.
    pub fn say(&self, text: &str) {
        self.print(Said::Message(text));
    }

    /// Prints a message or a picture without disturbing the bar.
    pub(crate) fn print(&self, said: Said<'_>) {
        match &self.bar {
            Some(bar) => bar.suspend(|| said.say()),
            None => said.say(),
        }
    }

    /// Removes the bar.
    pub fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

fn bar(limit: Limit) -> ProgressBar {
    let bar = if limit == Limit::Open { ProgressBar::new_spinner() } else { ProgressBar::new(1000) };
    let template = if limit == Limit::Open { "{spinner} {msg}" } else { "{wide_bar} {msg}" };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// Fraction of the work that is done, in `[0, 1]`.
fn fraction(done: u32, limit: Limit, elapsed: Duration) -> f64 {
    let part = match limit {
        Limit::Passes(all) => f64::from(done) / f64::from(all.max(1)),
        Limit::Time(all) => elapsed.as_secs_f64() / all.as_secs_f64().max(1e-9),
        Limit::Open => 0.0,
    };
    part.clamp(0.0, 1.0)
}

/// Passes, rate and time left.
fn line(done: u32, limit: Limit, elapsed: Duration) -> String {
    let rate = f64::from(done) / elapsed.as_secs_f64().max(1e-9);
    let passes = match limit {
        Limit::Passes(all) => format!("pass {done} of {all}"),
        _ => format!("pass {done}"),
    };
    let left = match limit {
        Limit::Passes(all) if done > 0 => Some(f64::from(all.saturating_sub(done)) / rate),
        Limit::Time(all) => Some(all.saturating_sub(elapsed).as_secs_f64()),
        _ => None,
    };
    let rate = if rate >= 0.1 { format!("{rate:.1} passes/s") } else { format!("{:.0} s/pass", 1.0 / rate.max(1e-9)) };
    match left {
        Some(seconds) => format!("{passes}, {rate}, {} left", duration(seconds)),
        None => format!("{passes}, {rate}"),
    }
}

fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_passes_rate_and_time_left() {
        let seconds = Duration::from_secs;
        assert_eq!(line(8, Limit::Passes(32), seconds(4)), "pass 8 of 32, 2.0 passes/s, 12 s left");
        assert_eq!(line(1, Limit::Passes(10), seconds(60)), "pass 1 of 10, 60 s/pass, 9 min 00 s left");
        assert_eq!(line(5, Limit::Time(seconds(7300)), seconds(1)), "pass 5, 5.0 passes/s, 2 h 01 min left");
        assert_eq!(line(3, Limit::Open, seconds(1)), "pass 3, 3.0 passes/s");
    }

    #[test]
    fn the_bar_never_leaves_its_range() {
        let of = |done, limit| fraction(done, limit, Duration::from_secs(10));
        assert_eq!(of(16, Limit::Passes(32)), 0.5);
        assert_eq!(of(7, Limit::Passes(0)), 1.0);
        assert_eq!(of(1, Limit::Time(Duration::from_secs(5))), 1.0);
        assert_eq!(of(1, Limit::Open), 0.0);
    }
}

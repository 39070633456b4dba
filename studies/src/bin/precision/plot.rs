//! Line plots in SVG panels, both axes logarithmic.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 360.0;
const COLOURS: [&str; 5] = ["#1b6ca8", "#d1495b", "#2e933c", "#8e44ad", "#e08e0b"];

/// A named series of points.
pub(crate) struct Line {
    pub(crate) name: &'static str,
    pub(crate) points: Vec<(f64, f64)>,
}

/// Axes and their lines.
pub(crate) struct Panel {
    pub(crate) title: &'static str,
    pub(crate) x: &'static str,
    pub(crate) lines: Vec<Line>,
}

/// Maps values to positions.
struct Frame {
    left: f64,
    x: (f64, f64),
    y: (f64, f64),
}

impl Frame {
    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let share = |v: f64, (low, high): (f64, f64)| (v / low).ln() / (high / low).ln();
        (self.left + 56.0 + share(x, self.x) * (WIDTH - 76.0), HEIGHT - 44.0 - share(y, self.y) * (HEIGHT - 80.0))
    }
}

/// Whether a point can be drawn on logarithmic axes.
fn drawn(points: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> {
    points.iter().copied().filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())
}

fn decades((low, high): (f64, f64)) -> RangeInclusive<i32> {
    low.log10().ceil() as i32..=high.log10().floor() as i32
}

/// All panels, side by side.
pub(crate) fn picture(panels: &[Panel]) -> String {
    let width = WIDTH * panels.len() as f64;
    let mut svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='{width:.0}' height='{:.0}' font-family='sans-serif' \
         font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n",
        HEIGHT + 100.0
    );
    for (number, panel) in panels.iter().enumerate() {
        draw(&mut svg, panel, WIDTH * number as f64);
    }
    svg.push_str("</svg>\n");
    svg
}

fn draw(svg: &mut String, panel: &Panel, left: f64) {
    let all = || panel.lines.iter().flat_map(|line| drawn(&line.points));
    let range = |of: fn((f64, f64)) -> f64| {
        let (low, high) = all().map(of).fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        if low < high { (low / 1.3, high * 1.3) } else { (0.1, 10.0) }
    };
    let frame = Frame { left, x: range(|p| p.0), y: range(|p| p.1) };
    let (x0, y0) = frame.place((frame.x.0, frame.y.0));
    let (x1, y1) = frame.place((frame.x.1, frame.y.1));
    let ticks = decades(frame.x).map(|p| (p, true)).chain(decades(frame.y).map(|p| (p, false)));
    for (power, along) in ticks {
        let value = 10.0_f64.powi(power);
        let (x, y) = frame.place(if along { (value, frame.y.0) } else { (frame.x.0, value) });
        let (tx, ty) = if along { (x, y1) } else { (x1, y) };
        let (dx, dy, anchor) = if along { (0.0, 16.0, "middle") } else { (-6.0, 4.0, "end") };
        let _ = writeln!(svg, "<line x1='{x:.1}' y1='{y:.1}' x2='{tx:.1}' y2='{ty:.1}' stroke='#eee'/>");
        let _ = writeln!(svg, "<text x='{:.1}' y='{:.1}' text-anchor='{anchor}'>1e{power}</text>", x + dx, y + dy);
    }
    let (w, h) = (x1 - x0, y0 - y1);
    let _ = writeln!(svg, "<rect x='{x0:.1}' y='{y1:.1}' width='{w:.1}' height='{h:.1}' fill='none' stroke='#999'/>");
    let _ = writeln!(svg, "<text x='{x0:.1}' y='22' font-weight='bold'>{}</text>", panel.title);
    let _ = writeln!(svg, "<text x='{x1:.1}' y='{:.1}' text-anchor='end'>{}</text>", HEIGHT - 12.0, panel.x);
    for (number, line) in panel.lines.iter().enumerate() {
        let colour = COLOURS[number % COLOURS.len()];
        let places: Vec<(f64, f64)> = drawn(&line.points).map(|point| frame.place(point)).collect();
        let path: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(svg, "<polyline points='{}' fill='none' stroke='{colour}'/>", path.join(" "));
        for (x, y) in &places {
            let _ = writeln!(svg, "<circle cx='{x:.1}' cy='{y:.1}' r='3' fill='{colour}'/>");
        }
        let y = HEIGHT + 10.0 + 16.0 * number as f64;
        let _ = writeln!(svg, "<circle cx='{:.1}' cy='{:.1}' r='3' fill='{colour}'/>", x0 + 6.0, y - 4.0);
        let _ = writeln!(svg, "<text x='{:.1}' y='{y:.1}'>{}</text>", x0 + 14.0, line.name);
    }
}

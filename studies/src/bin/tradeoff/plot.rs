//! Two panels in SVG: error over time with its Pareto front, and error over photons with
//! its components and the theoretical slope.

use std::fmt::Write as _;

use crate::indices::IndexRow;
use crate::measure::{pareto, slope};
use crate::records::{Body, Part, Summary, Sweep};

const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 340.0;
const MARGIN: f64 = 56.0;
const COLOURS: [&str; 16] = [
    "#1b6ca8", "#d1495b", "#2e933c", "#8e44ad", "#e08e0b", "#16a3a3", "#7f5539", "#4a4e69", "#c2185b", "#6b8e23",
    "#5dade2", "#f1948a", "#82c99a", "#c39bd3", "#b7950b", "#333333",
];

/// Both axes logarithmic.
struct Panel {
    left: f64,
    x: (f64, f64),
    y: (f64, f64),
}

impl Panel {
    fn new(left: f64, points: &[(f64, f64)]) -> Self {
        let range = |of: &dyn Fn(&(f64, f64)) -> f64| {
            let values = points.iter().map(of).filter(|v| *v > 0.0 && v.is_finite());
            let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
            if low > high { (0.1, 10.0) } else { (low / 1.5, high * 1.5) }
        };
        Self { left, x: range(&|p| p.0), y: range(&|p| p.1) }
    }

    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let share = |v: f64, (low, high): (f64, f64)| (v / low).ln() / (high / low).ln();
        let across = self.left + MARGIN + share(x, self.x) * (WIDTH - MARGIN - 12.0);
        (across, HEIGHT - 44.0 - share(y, self.y) * (HEIGHT - 44.0 - 34.0))
    }

    fn frame(&self, svg: &mut String, title: &str, x_name: &str, y_name: &str) {
        let (x0, y0) = self.place((self.x.0, self.y.0));
        let (x1, y1) = self.place((self.x.1, self.y.1));
        let _ = writeln!(
            svg,
            "<rect x='{x0:.1}' y='{y1:.1}' width='{:.1}' height='{:.1}' fill='none' stroke='#999'/>",
            x1 - x0,
            y0 - y1
        );
        let _ = writeln!(svg, "<text x='{:.1}' y='20' font-weight='bold'>{title}</text>", x0);
        let _ = writeln!(svg, "<text x='{:.1}' y='{:.1}' text-anchor='end'>{x_name}</text>", x1, HEIGHT - 8.0);
        let _ = writeln!(svg, "<text x='{:.1}' y='{:.1}'>{y_name}</text>", x0 + 4.0, y1 + 14.0);
        for (power, along) in decades(self.x).map(|p| (p, true)).chain(decades(self.y).map(|p| (p, false))) {
            let value = 10.0_f64.powi(power);
            let (x, y) = if along { self.place((value, self.y.0)) } else { self.place((self.x.0, value)) };
            let (dx, dy, anchor) = if along { (0.0, 16.0, "middle") } else { (-6.0, 4.0, "end") };
            let (tx, ty) = if along { (x, y1) } else { (x1, y) };
            let _ = writeln!(svg, "<line x1='{x:.1}' y1='{y:.1}' x2='{tx:.1}' y2='{ty:.1}' stroke='#eee'/>");
            let _ = writeln!(svg, "<text x='{:.1}' y='{:.1}' text-anchor='{anchor}'>1e{power}</text>", x + dx, y + dy);
        }
    }

    fn line(&self, svg: &mut String, points: &[(f64, f64)], colour: &str, dashes: &str) {
        let places: Vec<String> = points
            .iter()
            .filter(|p| p.0 > 0.0 && p.1 > 0.0)
            .map(|&p| self.place(p))
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let _ = writeln!(
            svg,
            "<polyline points='{}' fill='none' stroke='{colour}' stroke-dasharray='{dashes}'/>",
            places.join(" ")
        );
    }

    fn dot(&self, svg: &mut String, point: (f64, f64), colour: &str, title: &str) {
        if !(point.0 > 0.0 && point.1 > 0.0) {
            return;
        }
        let (x, y) = self.place(point);
        let _ =
            writeln!(svg, "<circle cx='{x:.1}' cy='{y:.1}' r='3.5' fill='{colour}'><title>{title}</title></circle>");
    }
}

fn decades((low, high): (f64, f64)) -> std::ops::RangeInclusive<i32> {
    low.log10().ceil() as i32..=high.log10().floor() as i32
}

/// The start of a picture with two panels and a legend.
fn begin() -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='{:.0}' height='{HEIGHT:.0}' font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n",
        2.0 * WIDTH + 130.0
    )
}

fn legend(svg: &mut String, number: usize, name: &str) {
    let (x, y) = (2.0 * WIDTH + 8.0, 40.0 + 18.0 * number as f64);
    let colour = COLOURS[number % COLOURS.len()];
    let _ = writeln!(
        svg,
        "<circle cx='{x}' cy='{y}' r='3.5' fill='{colour}'/><text x='{}' y='{}'>{name}</text>",
        x + 8.0,
        y + 4.0
    );
}

/// Both panels of a scene.
pub(crate) fn sweep(sweep: &Sweep) -> String {
    let mut svg = begin();
    let times: Vec<(f64, f64)> = sweep.rows.iter().map(|row| (row.summary.seconds, row.summary.error)).collect();
    let panel = Panel::new(0.0, &times);
    panel.frame(&mut svg, &format!("{}: error over time", sweep.scene), "seconds", "relMSE");
    let front: Vec<(f64, f64)> = pareto(&times).into_iter().map(|i| times[i]).collect();
    panel.line(&mut svg, &front, "#333", "4 3");
    let mut knobs: Vec<&str> = Vec::new();
    for (row, &place) in sweep.rows.iter().zip(&times) {
        let number = knobs.iter().position(|knob| *knob == row.knob).unwrap_or_else(|| {
            knobs.push(&row.knob);
            knobs.len() - 1
        });
        let title = format!("{} {}", row.knob, row.value);
        panel.dot(&mut svg, place, COLOURS[number % COLOURS.len()], &title);
    }
    knobs.iter().enumerate().for_each(|(number, knob)| legend(&mut svg, number, knob));
    photons(&mut svg, sweep);
    svg.push_str("</svg>\n");
    svg
}

/// Bias² and variance over passes where the result is known, with the theoretical curves from the first point:
/// shrinking radii on the left, constant radii on the right.
pub(crate) fn rates(parts: &[Part]) -> Option<String> {
    let mut svg = begin();
    let rows: Vec<_> = parts
        .iter()
        .filter_map(|part| match &part.body {
            Body::Rates(rows) => Some(rows.iter().map(move |row| (part.backend.as_str(), row))),
            _ => None,
        })
        .flatten()
        .collect();
    let mut names: Vec<String> = Vec::new();
    for (left, title, stays) in [(0.0, "radii shrink, α = 2/3", false), (WIDTH, "radii stay", true)] {
        let here = || rows.iter().filter(|(_, row)| (row.alpha > 0.99) == stays);
        let all: Vec<(f64, f64)> = here().flat_map(|(_, row)| row.points.iter().copied()).collect();
        let panel = Panel::new(left, &all);
        panel.frame(&mut svg, title, "passes", "of the field's square");
        for (backend, row) in here() {
            let name = format!("{}, {}", row.field, row.of);
            let number = names.iter().position(|known| *known == name).unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            });
            let colour = COLOURS[number % COLOURS.len()];
            let title = format!("{backend}: {}, slope {:.3}", row.of, row.slope);
            row.points.iter().for_each(|&point| panel.dot(&mut svg, point, colour, &title));
            if let (Some(first), Some(last)) = (row.points.first(), row.points.last()) {
                let theory = first.1 * (last.0 / first.0).powf(row.theory);
                panel.line(&mut svg, &[*first, (last.0, theory)], colour, "3 3");
            }
        }
    }
    names.iter().enumerate().for_each(|(number, name)| legend(&mut svg, number, name));
    svg.push_str("</svg>\n");
    (!rows.is_empty()).then_some(svg)
}

/// Build time and query time of each index over the photons in the maps.
pub(crate) fn indices(parts: &[Part]) -> Option<String> {
    let rows = crate::indices::all(parts);
    let mut svg = begin();
    let mut names: Vec<String> = Vec::new();
    for (left, title, build) in [(0.0, "build", true), (WIDTH, "query", false)] {
        let point = |row: &IndexRow| (row.photons as f64, if build { row.build } else { row.query });
        let panel = Panel::new(left, &rows.iter().map(|(_, row)| point(row)).collect::<Vec<_>>());
        panel.frame(&mut svg, title, "photons", "seconds of a pass");
        for (backend, row) in &rows {
            let name = format!("{}, {backend}", row.index);
            let number = names.iter().position(|known| *known == name).unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            });
            let same = |(of, other): &&(&str, &IndexRow)| {
                (*of, &other.index, &other.scene) == (*backend, &row.index, &row.scene)
            };
            let line: Vec<(f64, f64)> = rows.iter().filter(same).map(|(_, other)| point(other)).collect();
            let colour = COLOURS[number % COLOURS.len()];
            panel.dot(&mut svg, point(row), colour, &format!("{}: {}, {backend}", row.scene, row.index));
            if line.first() == Some(&point(row)) {
                panel.line(&mut svg, &line, colour, "");
            }
        }
    }
    names.iter().enumerate().for_each(|(number, name)| legend(&mut svg, number, name));
    svg.push_str("</svg>\n");
    (!rows.is_empty()).then_some(svg)
}

/// Error, bias² and variance over photons, for different numbers of passes only.
fn photons(svg: &mut String, sweep: &Sweep) {
    let series = |of: &dyn Fn(&Summary) -> f64| -> Vec<(f64, f64)> {
        let rows = sweep.rows.iter().filter(|row| row.knob == "passes");
        rows.map(|row| (row.summary.photons as f64, of(&row.summary))).collect()
    };
    let (error, bias, variance) = (series(&|s| s.error), series(&|s| s.bias), series(&|s| s.variance));
    let all: Vec<(f64, f64)> = error.iter().chain(&bias).chain(&variance).copied().collect();
    let panel = Panel::new(WIDTH, &all);
    let (fitted, _) = slope(&error);
    panel.frame(svg, &format!("error over photons, slope {fitted:.2}"), "photons", "relMSE");
    for (points, colour, name) in
        [(&error, "#1b6ca8", "error"), (&bias, "#d1495b", "bias²"), (&variance, "#2e933c", "variance")]
    {
        panel.line(svg, points, colour, "");
        points.iter().for_each(|&p| panel.dot(svg, p, colour, name));
        if let Some((x, y)) = points.last().filter(|p| p.1 > 0.0).map(|&p| panel.place(p)) {
            let _ = writeln!(
                svg,
                "<text x='{:.1}' y='{:.1}' text-anchor='end' fill='{colour}'>{name}</text>",
                x - 6.0,
                y - 6.0
            );
        }
    }
    if let (Some(first), Some(last)) = (error.first(), error.last()) {
        let theory = |x: f64| first.1 * (x / first.0).powf(-2.0 / 3.0);
        panel.line(svg, &[*first, (last.0, theory(last.0))], "#333", "2 3");
    }
}

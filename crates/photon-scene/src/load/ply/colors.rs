//! Colours and alpha of PLY, as linear shares of white.

use super::body::Colors;
use super::header::Kind;
use crate::color::srgb_to_linear;
use crate::load::white::White;
use crate::report::LoadReport;

/// In place of the colour and alpha of what has none.
pub(super) const NO_COLOR: [f64; 4] = [f64::NAN; 4];

impl Colors {
    /// The colours, and whether alpha is below 1 anywhere; what is guessed is reported.
    pub(super) fn into_linear(self, subject: &str, report: &mut LoadReport) -> (Vec<[f64; 4]>, bool) {
        let Self { mut list, kind, alpha } = self;
        let mut lost = 0;
        for color in list.iter_mut().filter(|color| !color.iter().all(|part| part.is_nan())) {
            for (part, instead) in color.iter_mut().zip([0.0, 0.0, 0.0, 1.0]).filter(|(part, _)| part.is_nan()) {
                (*part, lost) = (instead, lost + 1);
            }
        }
        if lost > 0 {
            report.approximated(subject, format!("{lost} channels of its colours are no numbers; black is taken"));
        }
        if let Some(kind) = kind {
            let white = white(kind, list.iter().flat_map(|color| color[..3].iter().copied()), subject, report);
            // Integers are those of a screen, sRGB; floats are linear.
            let is_linear = kind.most().is_none() && white == 1.0;
            for part in list.iter_mut().flat_map(|color| &mut color[..3]) {
                let share = (*part / white).clamp(0.0, 1.0);
                *part = if is_linear { share } else { srgb_to_linear(share) };
            }
        }
        let Some(kind) = alpha else { return (list, false) };
        let white = white(kind, list.iter().map(|color| color[3]), subject, report);
        list.iter_mut().for_each(|color| color[3] = (color[3] / white).clamp(0.0, 1.0));
        if !list.is_empty() && list.iter().all(|color| color[3] == 0.0) {
            report.approximated(subject, "its alpha is 0 everywhere, which is taken as unset: it is opaque");
            list.iter_mut().for_each(|color| color[3] = 1.0);
        }
        let is_clear = list.iter().any(|color| color[3] < 1.0);
        if is_clear {
            report.note(subject, "its alpha is the share of the light that it meets");
        }
        (list, is_clear)
    }
}

/// The number that stands for white.
fn white(kind: Kind, parts: impl Iterator<Item = f64> + Clone, subject: &str, report: &mut LoadReport) -> f64 {
    let parts = parts.filter(|part| !part.is_nan());
    let Some(most) = kind.most() else {
        let white = White::of(parts);
        white.report(subject, report);
        return white.value;
    };
    let largest = parts.fold(0.0, f64::max);
    // Wide integers often hold bytes.
    if most <= 255.0 || largest > 255.0 || largest == 0.0 {
        return most;
    }
    report.approximated(subject, "its colours or alpha, wide integers, are taken as numbers from 0 to 255");
    255.0
}

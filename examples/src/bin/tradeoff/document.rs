//! The tables, and the words about them.

use std::fmt::Write as _;

use crate::Result;
use crate::measure::{pareto, slope};
use crate::truth::Truth;

/// Every row of every scene.
pub(crate) fn csv(results: &[Result]) -> String {
    let mut text = String::from(
        "scene,knob,value,passes,photons,seconds,relmse,relmse_error,bias_squared,variance,claimed,covered,sharpness\n",
    );
    for result in results {
        for (point, s) in &result.rows {
            let claims = s
                .claims
                .map_or_else(|| ",,".to_owned(), |c| format!("{:.4},{:.4},{:.3}", c.claimed, c.covered, c.sharpness));
            let _ = writeln!(
                text,
                "{},{},{},{},{},{:.4},{:.4e},{:.1e},{:.4e},{:.4e},{claims}",
                result.scene,
                point.knob,
                point.value.replace(',', ";"),
                point.passes,
                s.photons,
                s.seconds,
                s.error,
                s.error_error,
                s.bias,
                s.variance
            );
        }
    }
    text
}

/// What the tables say, in words; written from runs of this program.
const READING: &str = "
## What to take

| for | take | because |
|---|---|---|
| the best picture in a time | `--time 20` | the number of passes and the radii follow from a pilot; in `cornell-glass` a third less relMSE than with radii left alone |
| an error | `--target-error 0.05` | the same, and it stops by itself |
| a first look | 1 to 4 passes | they are on every front |
| smooth light | radii × 2, or α = 1 for few passes, or `gather` | variance is all there is; radii × 2 take 47 and 75 % off, α = 1 29 and 44 %, 16 rays more than 60 % |
| sharp caustics | radii × 0.5 | bias is nearly all there is: in `ring` a sixth of the relMSE |
| an index | any | the error is the same with all three; the times are in [performance.md](performance.md) |
| the paper's choices | for comparison alone | 3 to 54 times the relMSE, nearly all of it bias, but in `ring`, where they have 0.6 of it |

- Derived radii come from the photons of a pass. Many small passes of as many photons win in `integrating-sphere`, large
  ones in `ring`, where bias rules; in the other two the middle is best.
- Kernels differ by less than radii do: the broad ones win where variance rules, those that fall off where bias does.
- How work is shared out does not change the picture. Sobol's sequence evens out broad light: the mean of a picture of a
  ball around a lamp has less than 1/2.7 of the variance (E7 in the tests). The noise of a pixel, which sees few photons,
  it leaves as it is: within the errors of the rows below.
";

const HEAD: &str = "\
# Speed against accuracy

What error is had for what time. Every number below is measured by one command, which also draws `out/tradeoff/*.svg`
and writes `out/tradeoff/tradeoff.csv`:

```
cargo run --release -p photon-examples --bin tradeoff -- --document docs/accuracy.md
```

## How it is measured

- **Error** is relMSE: the mean over pixels and runs of `(x − y)²/(y² + ȳ²/100)`, with `y` the truth and `ȳ` its mean.
- **bias²** is what the mean of all runs has of it, **variance** what runs differ by; they answer to different knobs.
- **Truth** is a closed form in `integrating-sphere` and `furnace`. Elsewhere it is a long run of our own, whose own error
  is stated as it claims it; a row whose error is near that says little.
- **Time** is that of the passes; loading, and the photons that derived radii come from, are left out.
- One knob is turned at a time, about a middle setting.

## What a film claims of itself

With `Settings::errors` (`render --errors`, `--target-error`) each pixel has a 95 % interval: `t·s/√n + 2·|B|`. `s` is the
spread of its `n` passes, with Student's `t`; `B` the bias, which estimates within a second radius tell.

- **The second radius is √2 times the first**, with the same photons in the same walk. The bias grows as the square of
  the radius, so that the difference of the two estimates is the bias itself, and its noise is half that of the pixel (0.50
  for the kernel of Epanechnikov). The smaller radius r/√2 costs no photon more, but its difference is half the bias under
  more noise: 1.41 of the pixel's after doubling. It serves to check the first.
- **Nothing is claimed** where a reason is flagged: fewer than 8 passes (1) or 32 photons (2), light within reach that
  lies on another surface (4), light that ends within reach (8), a bias that the smaller radius puts off by more than a
  factor of two (16). The fourth is told by how photons lie in the disc of √2 r: their mean offset is at most a quarter
  of the radius in any field that is linear, and 0.42 of it by a straight edge; their quadrupole is 0 in a linear field.
- **It is one gather**: only with errors asked for is there memory, code in a kernel, or time for it; below, `errors` told
  against `passes` of the same number is what it costs.
- Gathered light has the bias of the maps where rays land, which is told likewise, but is never flagged as uneven: it
  comes from many places. Shadow rays have no bias.
- **A target** (`Budget::Error`) is a fraction of the pixel, or of a tenth of the picture's mean where it is darker, for a
  share of the pixels of which anything is claimed. After a pilot of 8 passes the error is foretold: noise falls with
  `Σ 1/r²`, bias with `Σ r²` over the passes to come, which is `N ∝ ε⁻³` in the end. The bias is freed of its own noise
  first. Forecasts are repeated before passes have doubled; what was foretold first and what was reached is printed.
";

/// The document.
pub(crate) fn markdown(results: &[Result], device: &str, fields: &str, (size, seeds): (u32, u32)) -> String {
    let mut text = HEAD.to_owned();
    text.push_str(READING);
    let _ = writeln!(text, "\n## Results\n\nOn {device}; {size} × {size} pixels, {seeds} seeds a row.");
    text.push_str(fields);
    text.push_str("\n### Claims about scenes\n\n| scene | passes | claimed | covered | worst run | claim / error | time of the same passes |\n|---|---:|---:|---:|---:|---:|---:|\n");
    for result in results {
        for (point, s) in &result.rows {
            let Some(c) = s.claims else { continue };
            let same = result.rows.iter().find(|(p, _)| p.knob == "passes" && p.passes == point.passes);
            let cost = same.map_or(f64::NAN, |(_, plain)| s.seconds / plain.seconds);
            let _ = writeln!(
                text,
                "| {} | {} | {:.1} % | {:.1} % | {:.1} % | {:.2} | ×{cost:.2} |",
                result.scene,
                point.passes,
                100.0 * c.claimed,
                100.0 * c.covered,
                100.0 * c.worst,
                c.sharpness
            );
        }
    }
    text.push_str("\n### Asked for\n\nAn error in 95 % of the pixels of which anything is claimed, within 10 s; or a time. *Reached* is the error claimed. Nothing is said of what is covered\nwhere the reference has not four times the photons of the run.\n\n| scene | asked | predicted | took | reached | claimed | covered |\n|---|---|---|---|---:|---:|---:|\n");
    results.iter().for_each(|result| text.push_str(&result.asked));
    text.push_str("\n### Error over photons\n\nSlopes in logarithms for passes alone, α = 2/3; theory has −0.67 of all three in the end.\n\n| scene | error | bias² | variance |\n|---|---:|---:|---:|\n");
    for result in results {
        let rows: Vec<_> = result.rows.iter().filter(|(point, _)| point.knob == "passes").collect();
        let fit = |of: &dyn Fn(&crate::Summary) -> f64| {
            let points: Vec<(f64, f64)> =
                rows.iter().map(|(_, s)| (s.photons as f64, of(s))).filter(|p| p.1 > 0.0).collect();
            if points.len() < 3 {
                return "–".to_owned();
            }
            let (slope, error) = slope(&points);
            format!("{slope:.2} ± {error:.2}")
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} |",
            result.scene,
            fit(&|s| s.error),
            fit(&|s| s.bias),
            fit(&|s| s.variance)
        );
    }
    text.push_str("\n### The front\n\nWhat nothing beats in both time and error, from the fastest on.\n\n| scene | setting | passes | time | relMSE |\n|---|---|---:|---:|---:|\n");
    for result in results {
        let places: Vec<(f64, f64)> = result.rows.iter().map(|(_, s)| (s.seconds, s.error)).collect();
        for i in pareto(&places) {
            let (point, s) = &result.rows[i];
            let _ = writeln!(
                text,
                "| {} | {} {} | {} | {:.3} s | {:.2e} |",
                result.scene, point.knob, point.value, point.passes, s.seconds, s.error
            );
        }
    }
    for result in results {
        rows(&mut text, result);
    }
    text
}

fn rows(text: &mut String, result: &Result) {
    let truth = match &result.truth {
        Truth::Constant(radiance) => format!("Truth: {radiance:.6} everywhere."),
        Truth::Reference { error, passes, .. } => {
            let least = result.rows.iter().map(|(_, s)| s.error).fold(f64::INFINITY, f64::min);
            format!(
                "Truth: a run of {passes} passes, which claims a relMSE of {error:.1e} for itself: {:.0} % of the least below.",
                100.0 * error / least
            )
        }
    };
    let _ = writeln!(
        text,
        "\n### {}\n\n{truth}\n\n| knob | value | passes | time | relMSE | bias² | variance | error² × time |\n|---|---|---:|---:|---:|---:|---:|---:|",
        result.scene
    );
    for (point, s) in &result.rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.3} s | {:.2e} ± {:.0e} | {:.1e} | {:.1e} | {:.1e} |",
            point.knob,
            point.value,
            point.passes,
            s.seconds,
            s.error,
            s.error_error,
            s.bias,
            s.variance,
            s.error * s.seconds
        );
    }
}

//! Formats error forecasts as text.

use photon_core::Forecast;

/// The error so far, as a line that begins with `what`.
#[must_use]
pub fn error_line(what: &str, forecast: &Forecast) -> String {
    let Forecast { passes, claimed, error, share, .. } = forecast;
    let within = forecast.target.map_or(String::new(), |target| {
        format!("; {:.1} % of them are within {:.2} %", 100.0 * forecast.within, 100.0 * target)
    });
    format!(
        "{what}: after {passes} passes the error is at most {:.2} % in {:.0} % of the pixels whose error estimate needs no bounds ({:.1} % of all){within}",
        100.0 * error,
        100.0 * share,
        100.0 * claimed
    )
}

/// The error of the first passes, and the prediction for more passes of `photons` paths each.
#[must_use]
pub fn forecast_lines(forecast: &Forecast, photons: u32) -> String {
    // An interval, unless both ends round to the same number.
    let from = |least: String, most: String| if least == most { most } else { format!("{least} to {most}") };
    let cost = |least: u32, most: u32| {
        let [least, most] = [least, most].map(|passes| {
            let (passes, photons) = (f64::from(passes), f64::from(photons) / 1e6);
            [
                format!("{passes}"),
                format!("{:.1}", passes * photons),
                format!("{:.0}", passes * forecast.seconds_per_pass),
            ]
        });
        let [passes, photons, seconds]: [String; 3] = std::array::from_fn(|i| from(least[i].clone(), most[i].clone()));
        format!("{passes} passes, {photons} million photons, {seconds} s")
    };
    let limit = || {
        let [least, most] =
            [forecast.error_possible_least, forecast.error_possible].map(|error| format!("{:.2}", 100.0 * error));
        format!("an error of {} % with {}", from(least, most), cost(forecast.passes_possible, forecast.passes_possible))
    };
    let line = match (forecast.target, forecast.passes_least, forecast.passes_needed) {
        (None, ..) => format!("predicted: {}", limit()),
        (Some(_), Some(least), Some(most)) if forecast.is_reachable() => {
            format!("predicted: reached with {}", cost(least, most))
        }
        (Some(_), Some(least), most) => {
            let often = most.map_or_else(|| format!("{} or more", cost(least, least)), |most| cost(least, most));
            let perhaps = if forecast.may_be_reached() { "perhaps " } else { "" };
            format!("{perhaps}not reachable within the limits: it takes {often}; predicted: {}", limit())
        }
        (Some(_), None, _) => format!("not reachable with any number of passes; predicted: {}", limit()),
    };
    let radii = match forecast.radius_factor {
        factor if (factor - 1.0).abs() < 1e-9 => String::new(),
        factor => format!(", with radii scaled by {factor:.2} from now on"),
    };
    format!("{}\n{line}{radii}", error_line("first passes", forecast))
}

//! Parsers of option values.

use std::error::Error;
use std::str::FromStr;
use std::time::Duration;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use photon_core::CausticPhotons;
use photon_scene::LightUnits;

/// Parser of the names of an option type of the library.
pub(super) fn choice<T>(names: impl IntoIterator<Item = &'static str>) -> impl TypedValueParser<Value = T>
where
    T: FromStr + Clone + Send + Sync + 'static,
    T::Err: Into<Box<dyn Error + Send + Sync>>,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}

/// Parser of the names of light units.
pub(super) fn light_units() -> impl TypedValueParser<Value = LightUnits> {
    let named = |name: String| LightUnits::ALL.into_iter().find(|units| units.name() == name).unwrap_or_default();
    PossibleValuesParser::new(LightUnits::ALL.map(LightUnits::name)).map(named)
}

/// A range of passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassRange {
    /// Index of the first pass.
    pub first: u32,
    /// Number of passes.
    pub count: u32,
}

/// Parses a number of passes, or a range such as `64..128`.
pub(super) fn passes(text: &str) -> Result<PassRange, String> {
    const ASK: &str = "give a number of passes such as 64, or a range such as 64..128";
    let index = |text: &str| whole(text).map_err(|_| ASK.to_owned());
    let Some((first, end)) = text.split_once("..") else {
        return Ok(PassRange { first: 0, count: index(text)? });
    };
    let (first, end) = (index(first)?, index(end)?);
    if first >= end || end == u32::MAX {
        return Err(format!("{text} is no range of passes: the second number is not part of it; {ASK}"));
    }
    Ok(PassRange { first, count: end - first })
}

/// Parses a time in seconds, or with its unit; whether it is a useful one is not checked.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    text.parse().or_else(|_| duration(text).map(|time| time.as_secs_f64()))
}

/// Parses a time; a number without a unit is seconds.
pub(super) fn duration(text: &str) -> Result<Duration, String> {
    let split = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (digits, unit) = text.split_at(split);
    let unit = match unit {
        "" | "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err("give a time such as 30s, 5min or 1h".to_owned()),
    };
    let seconds = digits.parse::<f64>().map_err(|error| error.to_string())? * unit;
    Duration::try_from_secs_f64(seconds).map_err(|error| error.to_string())
}

/// A total number of photons, which may exceed 32 bits.
pub(super) fn total(text: &str) -> Result<u64, String> {
    let within = |number: &f64| number.fract() == 0.0 && (1.0..1e18).contains(number);
    let found = match text.parse::<u64>() {
        Ok(number) => Some(number).filter(|number| *number > 0),
        Err(_) => number(text).filter(within).map(|number| number as u64),
    };
    found.ok_or_else(|| "give a whole number such as 200000000, 200k, 200M or 2e8".to_owned())
}

/// Parses width and height, or the side of a square.
pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let (width, height) = text.split_once(['x', 'X', '×']).unwrap_or((text, text));
    let parsed = width.trim().parse().ok().zip(height.trim().parse().ok());
    let (width, height) = parsed.ok_or("give width and height with an x between, such as 640x480, or one number")?;
    photon_core::check_size(width, height).map_err(|error| error.to_string())?;
    Ok((width, height))
}

/// Parses a whole number, also such as `1e3`, with `k` for a thousand and `M` for a million; its range is not checked.
pub(super) fn whole(text: &str) -> Result<u32, String> {
    let number = number(text).filter(|number| number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(number));
    number.map(|number| number as u32).ok_or_else(|| "give a whole number, such as 64".to_owned())
}

/// Parses a whole number of paths, likewise.
pub(super) fn count(text: &str) -> Result<u32, String> {
    let number = number(text).ok_or("give a number such as 200000, 2e5, 200k or 1.5M")?;
    if number.fract() == 0.0 && (1.0..f64::from(u32::MAX)).contains(&number) {
        Ok(number as u32)
    } else {
        Err(format!("{text} is out of range: give a whole number from 1 to {}", u32::MAX - 1))
    }
}

/// A number, with `k` for a thousand and `M` for a million.
fn number(text: &str) -> Option<f64> {
    let (digits, factor) = match text.strip_suffix(['k', 'K']) {
        Some(digits) => (digits, 1e3),
        None => text.strip_suffix(['m', 'M']).map_or((text, 1.0), |digits| (digits, 1e6)),
    };
    digits.parse::<f64>().ok().map(|number| number * factor)
}

/// As [`count`], or one of the names.
pub(super) fn caustic_photons(text: &str) -> Result<CausticPhotons, String> {
    match count(text) {
        Ok(paths) => Ok(CausticPhotons::Aimed(paths)),
        Err(_) => text.parse().map_err(|error: photon_core::Error| error.to_string()),
    }
}

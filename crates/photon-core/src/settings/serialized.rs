//! Settings in formats such as JSON, by the crate serde: choices have the names that options have.

use std::fmt;
use std::marker::PhantomData;
use std::str::FromStr;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use crate::settings::kernel::Kernel;
use crate::settings::preset::Preset;
use crate::settings::{
    Area, Bandwidth, CausticPhotons, Direct, Estimator, IndexKind, Indirect, Paper, RandomKind, Scheduling,
};

/// A choice as the text of its option.
struct Text<T>(PhantomData<T>);

impl<T: FromStr<Err = crate::Error>> Visitor<'_> for Text<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a choice")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<T, E> {
        text.parse().map_err(E::custom)
    }
}

/// A count, which may be written as a float without a fraction, such as 1e5.
struct Count<T>(T);

impl<'de, T: TryFrom<u64>> Deserialize<'de> for Count<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Whole<T>(PhantomData<T>);

        impl<T: TryFrom<u64>> Visitor<'_> for Whole<T> {
            type Value = Count<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a whole number from 0 to {}", u64::MAX >> (64 - 8 * size_of::<T>()))
            }

            fn visit_u64<E: serde::de::Error>(self, count: u64) -> Result<Self::Value, E> {
                T::try_from(count).map(Count).map_err(|_| E::invalid_value(Unexpected::Unsigned(count), &self))
            }

            fn visit_f64<E: serde::de::Error>(self, count: f64) -> Result<Self::Value, E> {
                match whole(count) {
                    Some(count) => self.visit_u64(count),
                    None => Err(E::invalid_value(Unexpected::Float(count), &self)),
                }
            }
        }

        deserializer.deserialize_any(Whole(PhantomData))
    }
}

/// A float that is a whole number, at least 0 and small enough for each such number to be a float.
fn whole(count: f64) -> Option<u64> {
    (count.fract() == 0.0 && (0.0..=9_007_199_254_740_992.0).contains(&count)).then_some(count as u64)
}

/// A field that is a count.
pub(super) fn count<'de, T: TryFrom<u64>, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    Count::deserialize(deserializer).map(|count| count.0)
}

/// A field that is a count or nothing.
pub(super) fn optional_count<'de, T: TryFrom<u64>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    Ok(Option::<Count<T>>::deserialize(deserializer)?.map(|count| count.0))
}

/// Implements both traits by `Display` and `FromStr`.
macro_rules! by_text {
    ($($type:ty),+) => {$(
        impl Serialize for $type {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_str(Text(PhantomData))
            }
        }
    )+};
}

by_text!(Preset, IndexKind, Direct, Indirect, Area, Bandwidth, Scheduling, RandomKind, Kernel);

impl Serialize for CausticPhotons {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Aimed(paths) => serializer.serialize_u32(*paths),
            Self::Auto | Self::Shared => serializer.collect_str(self),
        }
    }
}

impl<'de> Deserialize<'de> for CausticPhotons {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;

        impl Visitor<'_> for Either {
            type Value = CausticPhotons;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"auto\", \"shared\" or a number of caustic paths from 1 to 4294967295")
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
                text.parse().map_err(E::custom)
            }

            fn visit_u64<E: serde::de::Error>(self, asked: u64) -> Result<Self::Value, E> {
                let paths = u32::try_from(asked).ok().filter(|paths| *paths > 0);
                paths.map(CausticPhotons::Aimed).ok_or_else(|| E::invalid_value(Unexpected::Unsigned(asked), &self))
            }

            fn visit_f64<E: serde::de::Error>(self, asked: f64) -> Result<Self::Value, E> {
                match whole(asked) {
                    Some(asked) => self.visit_u64(asked),
                    None => Err(E::invalid_value(Unexpected::Float(asked), &self)),
                }
            }
        }

        deserializer.deserialize_any(Either)
    }
}

/// [`Estimator`] with parameters. Those that are left out have the values of the bare name.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum WithParameters {
    Radius(Radius),
    Knn(Knn),
    Paper(Paper),
}

#[derive(Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Radius {
    radius: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Knn {
    #[serde(deserialize_with = "count")]
    k: u32,
    #[serde(default)]
    max_radius: Option<f64>,
}

impl Serialize for Estimator {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Radius { radius } => WithParameters::Radius(Radius { radius }),
            Self::Knn { k, max_radius } => WithParameters::Knn(Knn { k, max_radius }),
            Self::Paper(paper) => WithParameters::Paper(paper),
        }
        .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Estimator {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;

        impl<'de> Visitor<'de> for Either {
            type Value = Estimator;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"radius\", \"knn\", \"paper\", or an object such as {\"knn\": {\"k\": 50}}")
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
                text.parse().map_err(E::custom)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                Ok(match WithParameters::deserialize(MapAccessDeserializer::new(map))? {
                    WithParameters::Radius(Radius { radius }) => Estimator::Radius { radius },
                    WithParameters::Knn(Knn { k, max_radius }) => Estimator::Knn { k, max_radius },
                    WithParameters::Paper(paper) => Estimator::Paper(paper),
                })
            }
        }

        deserializer.deserialize_any(Either)
    }
}

#[cfg(test)]
mod tests {
    use crate::settings::{CausticPhotons, Estimator, Paper, Settings};
    use crate::{Kernel, RandomKind};

    #[test]
    fn settings_are_read_back() {
        let many = Settings {
            estimator: Estimator::Knn { k: 7, max_radius: Some(0.333) },
            kernel: Kernel::Constant,
            caustic_photons: CausticPhotons::Aimed(u32::MAX),
            seed: u64::MAX,
            alpha: 0.123_456_789_012_345,
            radius_factor: 1e-20,
            random: RandomKind::Lcg,
            memory: Some(u64::MAX),
            min_normal_cosine: 0.1,
            ..Settings::default()
        };
        let radius = Settings { estimator: Estimator::Radius { radius: Some(12_345_678.9) }, ..Settings::default() };
        for settings in [Settings::default(), Settings::paper(), many, radius] {
            let text = serde_json::to_string(&settings).unwrap();
            assert_eq!(serde_json::from_str::<Settings>(&text).unwrap(), settings, "{text}");
        }
    }

    #[test]
    fn fields_that_are_left_out_have_their_defaults() {
        let read = |text| serde_json::from_str::<Settings>(text).unwrap();
        assert_eq!(read("{}"), Settings::default());
        let knn = Settings { estimator: Estimator::Knn { k: 50, max_radius: None }, ..Settings::default() };
        assert_eq!(read(r#"{"estimator": "knn"}"#), knn);
        assert_eq!(read(r#"{"estimator": {"knn": {"k": 50}}}"#), knn);
        let paper = Estimator::Paper(Paper { max: 9, ..Paper::default() });
        assert_eq!(read(r#"{"estimator": {"paper": {"max": 9}}}"#).estimator, paper);
        assert_eq!(read(r#"{"estimator": {"radius": {}}, "errors": true}"#).estimator, Settings::default().estimator);
        assert_eq!(read(r#"{"caustic_photons": 3}"#).caustic_photons, CausticPhotons::Aimed(3));
    }

    #[test]
    fn counts_may_be_floats_without_a_fraction() {
        let read = |text| serde_json::from_str::<Settings>(text).unwrap();
        let settings = Settings {
            photons: 100_000,
            caustic_photons: CausticPhotons::Aimed(2000),
            estimator: Estimator::Knn { k: 60, max_radius: None },
            memory: Some(1 << 31),
            irradiance_every: Some(4),
            seed: 7,
            ..Settings::default()
        };
        let text = r#"{"photons": 1e5, "caustic_photons": 2e3, "estimator": {"knn": {"k": 60.0}},
                       "memory": 2147483648.0, "irradiance_every": 4.0, "seed": 7.0, "photon_capacity": null}"#;
        assert_eq!(read(text), settings);
    }

    #[test]
    fn errors_name_the_culprit_and_what_is_known() {
        for (text, words) in [
            (r#"{"photon": 3}"#, ["unknown field `photon`", "`photons`"]),
            (r#"{"photons": -3}"#, ["-3", "a whole number from 0 to 4294967295"]),
            (r#"{"photons": 1.5}"#, ["1.5", "whole"]),
            (r#"{"photons": 5e9}"#, ["5000000000", "4294967295"]),
            (r#"{"seed": 1e17}"#, ["1e+17", "18446744073709551615"]),
            (r#"{"caustic_photons": 0.5}"#, ["0.5", "number of caustic paths"]),
            (r#"{"index": "grid"}"#, ["index is \"grid\"", "morton"]),
            (r#"{"kernel": "cone:1.1"}"#, ["cone:1.1", "epanechnikov"]),
            (r#"{"caustic_photons": 0}"#, ["0", "number of caustic paths"]),
            (r#"{"caustic_photons": "many"}"#, ["many", "shared"]),
            (r#"{"estimator": {"grid": {}}}"#, ["grid", "knn"]),
            (r#"{"estimator": {"knn": {}}}"#, ["missing field", "k"]),
            (r#"{"estimator": {"radius": {"k": 3}}}"#, ["unknown field `k`", "radius"]),
            (r#"{"estimator": 3}"#, ["3", "knn"]),
        ] {
            let message = serde_json::from_str::<Settings>(text).unwrap_err().to_string();
            assert!(words.iter().all(|word| message.contains(word)), "{text}: {message}");
        }
    }
}

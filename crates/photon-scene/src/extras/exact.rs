//! Numbers as decimal strings.

use std::str::FromStr;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// An f64 that is serialized without loss, as a string.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Exact(pub(crate) f64);

impl Serialize for Exact {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // The shortest text that parses to the same number.
        serializer.collect_str(&format_args!("{:?}", self.0))
    }
}

impl<'de> Deserialize<'de> for Exact {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        f64::from_str(&text).map(Self).map_err(|why| D::Error::custom(format!("{text:?}: {why}")))
    }
}

pub(super) type Triple = [Exact; 3];

pub(super) fn exact(values: [f64; 3]) -> Triple {
    values.map(Exact)
}

pub(super) fn plain(values: Triple) -> [f64; 3] {
    values.map(|value| value.0)
}

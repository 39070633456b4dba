//! Names of the values that options take, for programs, configuration files and reports.
//!
//! Each option type implements [`Display`](std::fmt::Display) and [`FromStr`](std::str::FromStr), which are
//! inverses of each other. An unknown name is [`Error::InvalidSetting`], which lists the known ones.

use std::fmt;
use std::str::FromStr;

use crate::error::Error;
use crate::settings::kernel::Kernel;
use crate::settings::preset::Preset;
use crate::settings::{
    Area, Bandwidth, CausticPhotons, Direct, Estimator, IndexKind, Indirect, Paper, RandomKind, Scheduling,
};

/// Implements `ALL`, `name`, `Display` and `FromStr` for an enum whose variants have no fields.
macro_rules! option_names {
    ($option:literal, $type:ident { $first:ident = $first_name:literal $(, $variant:ident = $name:literal)+ }) => {
        impl $type {
            /// All values, in the order of declaration.
            pub const ALL: [Self; [$first_name, $($name),+].len()] = [Self::$first, $(Self::$variant),+];

            /// Name in options and reports; [`str::parse`] reads it back.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    Self::$first => $first_name,
                    $(Self::$variant => $name),+
                }
            }
        }

        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(self.name())
            }
        }

        impl FromStr for $type {
            type Err = Error;

            fn from_str(text: &str) -> Result<Self, Error> {
                let known = Self::ALL.into_iter().find(|value| value.name() == text);
                known.ok_or_else(|| unknown($option, text, concat!("must be one of ", $first_name $(, ", ", $name)+)))
            }
        }
    };
}

option_names!("preset", Preset { Preview = "preview", Balanced = "balanced", Final = "final" });
option_names!("index", IndexKind { Median = "median", Vvh = "vvh", Morton = "morton" });
option_names!("direct", Direct { Nee = "nee", Photons = "photons", None = "none" });
option_names!("indirect", Indirect { Map = "map", Gather = "gather", None = "none" });
option_names!("area", Area { Disc = "disc", Surface = "surface" });
option_names!("bandwidth", Bandwidth { Shared = "shared", PerPixel = "per-pixel" });
option_names!("scheduling", Scheduling { Static = "static", Dynamic = "dynamic" });
option_names!("kernel", Kernel { Constant = "constant", Epanechnikov = "epanechnikov" });
option_names!("random", RandomKind { Counter = "counter", Lcg = "lcg" });

fn unknown(option: &'static str, text: &str, hint: &'static str) -> Error {
    Error::InvalidSetting { name: option, value: format!("{text:?}"), hint }
}

impl Estimator {
    /// The names that [`str::parse`] accepts, each of which stands for an estimator with its default
    /// parameters: a derived radius, 50 nearest photons, [`Paper::default`].
    pub const NAMES: [&'static str; 3] = ["radius", "knn", "paper"];

    /// Name in options and reports, without the parameters.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Radius { .. } => "radius",
            Self::Knn { .. } => "knn",
            Self::Paper(_) => "paper",
        }
    }
}

impl FromStr for Estimator {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        match text {
            "radius" => Ok(Self::Radius { radius: None }),
            "knn" => Ok(Self::Knn { k: 50, max_radius: None }),
            "paper" => Ok(Self::Paper(Paper::default())),
            _ => Err(unknown("estimator", text, "must be one of radius, knn, paper")),
        }
    }
}

impl fmt::Display for CausticPhotons {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.pad("auto"),
            Self::Shared => f.pad("shared"),
            Self::Aimed(paths) => paths.fmt(f),
        }
    }
}

impl FromStr for CausticPhotons {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let hint = "must be auto, shared, or a whole number of paths, at least 1";
        match text {
            "auto" => Ok(Self::Auto),
            "shared" => Ok(Self::Shared),
            _ => match text.parse() {
                Ok(paths) if paths > 0 => Ok(Self::Aimed(paths)),
                _ => Err(unknown("caustic-photons", text, hint)),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn round_trip<T: FromStr<Err = Error> + fmt::Display + PartialEq + fmt::Debug>(all: &[T]) {
        for value in all {
            assert_eq!(value.to_string().parse::<T>().unwrap(), *value);
        }
        assert!("".parse::<T>().is_err() && "Nonsense".parse::<T>().is_err());
    }

    #[test]
    fn every_name_is_read_back() {
        round_trip(&Preset::ALL);
        round_trip(&IndexKind::ALL);
        round_trip(&Direct::ALL);
        round_trip(&Indirect::ALL);
        round_trip(&Area::ALL);
        round_trip(&Bandwidth::ALL);
        round_trip(&Scheduling::ALL);
        round_trip(&RandomKind::ALL);
        round_trip(&[CausticPhotons::Auto, CausticPhotons::Shared, CausticPhotons::Aimed(7)]);
        round_trip(&Kernel::ALL);
        for name in Estimator::NAMES {
            assert_eq!(name.parse::<Estimator>().unwrap().name(), name);
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_known_ones() {
        let message = "box".parse::<IndexKind>().unwrap_err().to_string();
        assert_eq!(message, "index is \"box\", but must be one of median, vvh, morton");
        for bad in ["0", "-1", "1.5", "many"] {
            assert!(bad.parse::<CausticPhotons>().unwrap_err().to_string().contains("shared"), "{bad}");
        }
        assert!("grid".parse::<Estimator>().unwrap_err().to_string().contains("knn"));
    }
}

//! The arguments of texture statements of MTL: options and a file name.

use std::path::Path;

use photon_core::Wrap;

use crate::load::gltf::leaves_folder;
use crate::load::obj::spellings;

/// A texture statement such as `map_Kd -s 2 2 wood grain.png`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// As written.
    pub(super) file: String,
    /// `-s`: factors on the texture coordinates.
    scale: [f64; 2],
    /// `-o`: added to them.
    offset: [f64; 2],
    /// `-clamp on`
    is_clamped: bool,
    /// `-bm`: strength of a normal map.
    pub(super) strength: f64,
    /// Options that are not modelled, verbatim.
    pub(super) others: Vec<String>,
}

impl Map {
    /// An image without options.
    pub(super) fn plain(file: &str) -> Self {
        Self {
            file: file.replace('\\', "/"),
            scale: [1.0; 2],
            offset: [0.0; 2],
            is_clamped: false,
            strength: 1.0,
            others: Vec::new(),
        }
    }

    /// Parses the arguments of a statement.
    pub(super) fn parse(arguments: &str) -> Result<Self, &'static str> {
        let mut map = Self::plain("");
        let mut rest = arguments.trim();
        while let Some((option, after)) = split_option(rest) {
            // The file name may contain spaces, so that the number of arguments tells where it begins.
            let most = match option {
                "-s" | "-o" | "-t" => 3,
                "-mm" => 2,
                "-bm" | "-boost" | "-texres" | "-clamp" | "-blendu" | "-blendv" | "-cc" | "-imfchan" | "-type" => 1,
                _ => return Err("its options must be -s, -o, -t, -mm, -bm, -clamp or another of the MTL format"),
            };
            let is_numeric = matches!(option, "-s" | "-o" | "-t" | "-mm" | "-bm" | "-boost" | "-texres");
            let (values, tail) = take_values(after, most, is_numeric);
            if values.is_empty() {
                return Err("a value must follow each option");
            }
            rest = tail;
            let number = |at: usize| values.get(at).and_then(|word| word.parse::<f64>().ok());
            match option {
                "-s" => map.scale = [number(0).unwrap_or(1.0), number(1).unwrap_or(1.0)],
                "-o" => map.offset = [number(0).unwrap_or(0.0), number(1).unwrap_or(0.0)],
                "-clamp" => map.is_clamped = values[0] == "on",
                "-bm" => map.strength = number(0).unwrap_or(1.0),
                _ => map.others.push(format!("{option} {}", values.join(" "))),
            }
        }
        map.file = rest.replace('\\', "/");
        let numbers = [map.scale, map.offset];
        match numbers.as_flattened().iter().all(|part| (*part as f32).is_finite()) && map.strength.is_finite() {
            _ if map.file.is_empty() => Err("the name of an image must follow"),
            false => Err("the values of its options must be finite numbers"),
            true => Ok(map),
        }
    }

    /// Takes the spelling of its name that is a file in a folder, if one is.
    pub(super) fn in_folder(mut self, folder: &Path) -> Self {
        let is_file = |name: &str| !leaves_folder(name) && folder.join(name).is_file();
        let [written, other] = spellings(&self.file);
        if !is_file(written) && is_file(other) {
            self.file = other.to_owned();
        }
        self
    }

    /// The transform of texture coordinates whose v runs downwards, while that of MTL runs upwards.
    pub(super) fn transform(&self) -> [[f64; 3]; 2] {
        let ([su, sv], [ou, ov]) = (self.scale, self.offset);
        [[su, 0.0, ou], [0.0, sv, 1.0 - sv - ov]]
    }

    pub(super) fn wrap(&self) -> [Wrap; 2] {
        [if self.is_clamped { Wrap::Clamp } else { Wrap::Repeat }; 2]
    }
}

/// Splits an option off the front, if there is one.
fn split_option(text: &str) -> Option<(&str, &str)> {
    if !text.starts_with('-') {
        return None;
    }
    let (option, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    Some((option, rest.trim_start()))
}

/// Splits up to `most` words off the front; only numbers if they must be numeric.
fn take_values(text: &str, most: usize, is_numeric: bool) -> (Vec<&str>, &str) {
    let mut values = Vec::new();
    let mut rest = text;
    while values.len() < most {
        let (word, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        if word.is_empty() || (is_numeric && word.parse::<f64>().is_err()) {
            break;
        }
        values.push(word);
        rest = after.trim_start();
    }
    (values, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_separated_from_the_name() {
        let map = Map::parse("-s 2 3 -o 0.5 -clamp on -mm 0 1 -bm 0.25 wood\\fine grain.png").unwrap();
        assert_eq!((map.file.as_str(), map.strength), ("wood/fine grain.png", 0.25));
        assert_eq!((map.wrap(), map.others.as_slice()), ([Wrap::Clamp; 2], &["-mm 0 1".to_owned()][..]));
        // v' = 1 − (3 (1 − v) + 0).
        assert_eq!(map.transform(), [[2.0, 0.0, 0.5], [0.0, 3.0, -2.0]]);
        let plain = Map::parse("a b.png").unwrap();
        assert_eq!((plain.file.as_str(), plain.transform()), ("a b.png", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        // A file name may begin with a digit.
        assert_eq!(Map::parse("-s 2 2nd.png").unwrap().file, "2nd.png");
        assert_eq!(Map::parse("-s 1 1 1 2.png").unwrap().file, "2.png");
    }

    #[test]
    fn invalid_options_are_refused() {
        for text in ["", "-s 1 1", "-s x.png", "-zoom 2 x.png", "-s nan 1 x.png", "-o 1e300 0 x.png", "-clamp"] {
            assert!(Map::parse(text).is_err(), "{text}");
        }
    }
}

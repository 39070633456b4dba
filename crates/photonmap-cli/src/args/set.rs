//! `--set NAME=VALUE`: options that `--help` does not list.

use std::ffi::OsString;

/// The arguments, with `--set NAME=VALUE` and `--set=NAME=VALUE` as `--NAME=VALUE`, and `--set NAME` as `--NAME`.
pub fn expanded(arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut arguments = arguments.into_iter();
    let mut expanded = Vec::new();
    let option = |setting: OsString| {
        let mut option = OsString::from("--");
        option.push(setting);
        option
    };
    while let Some(argument) = arguments.next() {
        if argument == "--" {
            expanded.push(argument);
            expanded.extend(arguments.by_ref());
        } else if argument == "--set" {
            // Without a value it is left to the parser.
            expanded.push(arguments.next().map_or(argument, option));
        } else if let Some(setting) = argument.to_str().and_then(|text| text.strip_prefix("--set=")) {
            expanded.push(option(setting.into()));
        } else {
            expanded.push(argument);
        }
    }
    expanded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_become_options() {
        let of = |arguments: &[&str]| expanded(arguments.iter().map(OsString::from));
        assert_eq!(of(&["render", "--set", "k=3", "--set=tev", "x"]), ["render", "--k=3", "--tev", "x"]);
        assert_eq!(of(&["render", "--set"]), ["render", "--set"]);
        assert_eq!(of(&["render", "--", "--set", "k=3"]), ["render", "--", "--set", "k=3"]);
    }
}

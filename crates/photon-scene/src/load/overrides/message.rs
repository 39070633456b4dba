//! Messages on override files, in the words of the format instead of those of the parser.

use crate::parameter::Parameter;
use crate::similar;

const KEYS: &str = "docs/scene-files.md lists the valid keys and values";

/// Names of other programs for keys, and those here.
const SYNONYMS: [(&[&str], &str); 9] = [
    (&["color", "colour", "base_color", "basecolor", "diffuse", "reflectance"], "albedo"),
    (&["index", "refractive_index", "index_of_refraction", "eta"], "ior"),
    (&["emissive", "emit", "radiance"], "emission"),
    (&["opacity", "transparency"], "alpha"),
    (&["origin", "eye", "position"], "from"),
    (&["target", "look_at", "lookat"], "to"),
    (&["power", "watts", "strength", "brightness", "color"], "intensity"),
    (&["power", "watts", "intensity", "strength", "color"], "radiance"),
    (&["sigma_s"], "scattering"),
];

/// A fault of a text that is no override file.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Message {
    /// From 1.
    pub(super) line: Option<u64>,
    pub(super) what: String,
    pub(super) hint: String,
}

/// The message on a text that the parser refuses.
pub(super) fn of(text: &str, error: &toml::de::Error) -> Message {
    let start = error.span().map(|span| span.start.min(text.len()));
    let line = start.and_then(|start| text.get(..start)).map(|before| before.matches('\n').count() as u64 + 1);
    let said = error.message().trim().replace('\n', "; ");
    let message = |what: String, hint: String| Message { line, what, hint };
    if let Some((kind, name, names)) = unknown(&said) {
        let what = format!("unknown {kind} '{name}'");
        let lower = name.to_lowercase();
        let ours = SYNONYMS.iter().find(|(others, ours)| others.contains(&&*lower) && names.contains(ours));
        let near =
            ours.map_or_else(|| similar::did_you_mean(name, names), |(_, ours)| format!("did you mean '{ours}'?"));
        // Of a table that is read as a whole, the parser names the first line.
        let found = line.filter(|_| kind == "key").and_then(|line| Some(line + line_of(text, start?, name)?));
        let separator = if near.ends_with('?') { "" } else { ";" };
        return Message { line: found.or(line), what, hint: format!("{near}{separator} {KEYS}") };
    }
    if let Some((found, expected)) = said.split_once(", expected ") {
        let found = found.strip_prefix("invalid type: ").or_else(|| found.strip_prefix("invalid value: "));
        if let Some(found) = found {
            let what = format!("{} is given in place of {}", shown(found), meant(expected));
            let key = line.and_then(|line| text.lines().nth(line as usize - 1)).map(key_of).unwrap_or_default();
            let hint = match key {
                "lights" | "quads" | "cameras" if expected == "a sequence" => {
                    format!("write [[{key}]] above the keys of each of them")
                }
                "portal" if expected == "a sequence" => {
                    "write [[environment.portal]] above the corners of each of them".to_owned()
                }
                _ => KEYS.to_owned(),
            };
            return message(what, hint);
        }
        if let Some(length) = found_length(&said) {
            return message(format!("{length} values are given in place of {}", meant(expected)), KEYS.to_owned());
        }
    }
    if said.starts_with("string values must be quoted") {
        return message("text must be in quotes, such as \"glass\"".to_owned(), "use straight quotes".to_owned());
    }
    if let Some(expected) = said.strip_prefix("wanted ") {
        return message(format!("{} is expected", meant(expected)), KEYS.to_owned());
    }
    if let Some(name) = said.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`')) {
        return message(format!("the key '{name}' is missing"), KEYS.to_owned());
    }
    message(said, KEYS.to_owned())
}

/// The kind of thing that is unknown, its name, and the known names.
fn unknown(said: &str) -> Option<(&'static str, &str, Vec<&str>)> {
    let kinds = [("unknown field `", "key"), ("unknown variant `", "value")];
    let (rest, kind) = kinds.iter().find_map(|(start, kind)| Some((said.strip_prefix(start)?, *kind)))?;
    let (name, rest) = rest.split_once("`, expected ")?;
    Some((kind, name, rest.split('`').skip(1).step_by(2).collect()))
}

fn found_length(said: &str) -> Option<&str> {
    Some(said.strip_prefix("invalid length ")?.split_once(',')?.0)
}

/// The value that the parser found, as the text has it.
fn shown(found: &str) -> String {
    match found {
        "map" => "a table".to_owned(),
        "sequence" => "a list".to_owned(),
        _ => found.split_once(['`', '"']).map_or(found, |(_, value)| value.trim_end_matches(['`', '"'])).to_owned(),
    }
}

/// A description of the value that the parser expects.
fn meant(expected: &str) -> String {
    match expected {
        "f64" => "a number".to_owned(),
        "u32" | "u64" => "a whole number".to_owned(),
        "a boolean" => "true or false".to_owned(),
        "a string" | "path string" | "string or table" => "text in quotes".to_owned(),
        "a map" => "a table".to_owned(),
        "a sequence" => "a list".to_owned(),
        "an array of length 3" => "three numbers in brackets, such as [0, 1, 0]".to_owned(),
        _ => match expected.strip_prefix("an array of length ") {
            Some(length) => format!("{length} values in brackets"),
            None => expected.to_owned(),
        },
    }
}

/// Lines from `start` to the first that gives `key` a value.
fn line_of(text: &str, start: usize, key: &str) -> Option<u64> {
    let gives = |line: &str| line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
    Some(text.get(start..)?.lines().position(gives)? as u64)
}

/// The key of a line: before its value, or the last of a header.
fn key_of(line: &str) -> &str {
    let line = line.trim().trim_start_matches('[');
    let key = line.split(['=', ']']).next().unwrap_or_default().trim();
    key.rsplit('.').next().unwrap_or_default()
}

/// The kinds of materials that have a property, and the verb.
pub(super) fn kinds_with(property: &str) -> String {
    let special = match property {
        "cauchy" | "abbe" | "sellmeier" => "glass and glossy with a transmission have",
        "priority" => "glass, boundary and glossy with a transmission have",
        "anisotropy" => "glass, boundary and glossy have",
        "emission" | "emits_both_sides" => "all but boundary have",
        _ => "",
    };
    match Parameter::find(property) {
        Some(parameter) if special.is_empty() => parameter.kinds_with(),
        None if special.is_empty() => "glass and boundary have".to_owned(),
        _ => special.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::Overrides;

    fn message(text: &str) -> String {
        Overrides::parse(text, Path::new("a.toml")).map(drop).unwrap_err().to_string()
    }

    /// Misspelt keys and values: the line, the name, and the nearest that exist, but no list of thirty.
    #[test]
    fn the_nearest_key_is_named() {
        for (text, expected) in [
            ("[materials.a]\nkind = 'glass'\nalbdo = 1", "line 3: unknown key 'albdo'; did you mean 'albedo'? docs"),
            ("[materials.a]\ncolor = 1", "line 2: unknown key 'color'; did you mean 'albedo'?"),
            ("[materials.a]\nrefractive_index = 1", "did you mean 'ior'?"),
            ("[materials.a]\nkind = 'glas'", "line 2: unknown value 'glas'; did you mean 'glass'?"),
            ("[material.a]\nalbedo = 1", "line 1: unknown key 'material'; did you mean 'materials'?"),
            (
                "# A light.\n[[lights]]\ntype = 'point'\nposition = [0, 0, 0]\nintensty = 3",
                "line 5: unknown key 'intensty'; did you mean 'intensity'?",
            ),
            ("[[lights]]\ntype = 'ponit'", "unknown value 'ponit'; did you mean 'point'?"),
            ("light_units = 'lumen'", "line 1: unknown value 'lumen'; there are 'unitless', 'standard'; docs"),
            ("[environment]\nsky = { elevaton = 30 }", "line 2: unknown key 'elevaton'; did you mean 'elevation'?"),
        ] {
            let found = message(text);
            assert!(found.contains(expected) && found.contains("docs/scene-files.md"), "{expected}: {found}");
        }
        let found = message("[materials.a]\nxyzzy = 1");
        assert!(found.contains("there are '") && found.contains(" more; docs") && !found.contains('…'), "{found}");
    }

    /// Values of another type: what is given, what is expected, and how that is written.
    #[test]
    fn values_are_described_as_they_are_written() {
        for (text, expected) in [
            (
                "[environment]\nsky = 30",
                "line 2: 30 is given in place of a sky, such as { elevation = 30, turbidity = 3 };",
            ),
            ("environment = 'constant'", "constant is given in place of an environment, such as { sky ="),
            ("medium = 3", "3 is given in place of a medium, such as { scattering = 0.1"),
            ("[materials]\nwall = 0.5", "line 2: 0.5 is given in place of the keys of a material, such as { kind ="),
            ("materials = 0.5", "0.5 is given in place of a table"),
            ("lights = 3", "3 is given in place of a list; write [[lights]] above the keys of each"),
            ("[lights]\ntype = 'point'", "a table is given in place of a list; write [[lights]]"),
            ("[quads]\nname = 'a'", "write [[quads]]"),
            ("lights = [3]", "3 is given in place of a light, such as { type = \"point\""),
            ("cameras = [3]", "3 is given in place of a camera with name, from"),
            ("quads = [3]", "3 is given in place of a quadrilateral"),
            ("[environment]\nportal = 3", "3 is given in place of a list; write [[environment.portal]]"),
            ("[environment]\nportal = [3]", "3 is given in place of a portal with corners"),
            ("[[cameras]]\nfrom = 3", "line 2: 3 is given in place of three numbers in brackets, such as [0, 1, 0]"),
            ("[[cameras]]\nfrom = [1, 2]", "2 values are given in place of three numbers in brackets"),
            ("[materials.a]\nior = 'glass'", "line 2: glass is given in place of a number"),
            ("[materials.a]\npriority = 1.5", "1.5 is given in place of a whole number"),
            ("[materials.a]\nnew = 1", "1 is given in place of true or false"),
            ("[materials.a]\nkind = 1", "text in quotes is expected"),
            ("[materials.a]\nphase = 1", "1 is given in place of text in quotes"),
            ("[materials.a]\ngrid = 1", "1 is given in place of text in quotes"),
            ("[materials.a]\nalbedo = 'red'", "a number, or three numbers in brackets, is expected"),
            ("[[lights]]\nposition = [0, 0, 0]", "the key 'type' is missing"),
            ("[[cameras]]\nname = 'a'", "the key 'from' is missing"),
        ] {
            let found = message(text);
            assert!(found.starts_with("a.toml, line") && found.contains(expected), "{expected}: {found}");
        }
    }

    /// The parser's own messages on text that is not TOML.
    #[test]
    fn text_that_is_not_toml_has_its_line() {
        for text in ["[materials.a]\nkind = glass", "[materials.a]\nkind = “glass”"] {
            assert!(message(text).contains("line 2: text must be in quotes, such as \"glass\"; use straight"));
        }
        for text in ["[materials.a\n", "a b c", "[materials.a]\nior = 1.5.5"] {
            let found = message(text);
            assert!(found.starts_with("a.toml, line ") && found.contains("docs/scene-files.md"), "{found}");
        }
    }
}

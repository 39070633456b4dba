//! Messages on command lines that are refused, where those of the parser do not help.

use std::error::Error as _;
use std::ffi::OsString;
use std::num::{ParseFloatError, ParseIntError};
use std::path::Path;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Prints the message on a command line, as given and with its settings as options; returns the exit code.
pub(super) fn report(mut error: clap::Error, given: &[OsString], arguments: &[OsString]) -> ExitCode {
    let own = negative(&error, arguments).or_else(|| no_number(&error)).or_else(|| no_setting(&error, given));
    if let Some(own) = own {
        say!("error: {own}");
        return ExitCode::from(2);
    }
    let hint = hint(&error);
    if error.kind() == ErrorKind::UnknownArgument || hint.is_some() {
        // Values that begin with a dash are not meant, and the value that is spelt likewise is not what the hint says.
        error.remove(ContextKind::Suggested);
        error.remove(ContextKind::SuggestedValue);
    }
    // Help goes to standard output; nobody need read it.
    let _ = error.print();
    if let Some(hint) = hint {
        say!("\n  {hint}");
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}

fn context(error: &clap::Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    }
}

/// The message on a negative number for an option that has none: the parser takes it for an option.
fn negative(error: &clap::Error, arguments: &[OsString]) -> Option<String> {
    let given = context(error, ContextKind::InvalidArg).filter(|_| error.kind() == ErrorKind::UnknownArgument)?;
    // Of -2e5, the parser names -2 alone.
    let is_it = |value: &str| value.starts_with(given) && value.parse().is_ok_and(|number: f64| number <= 0.0);
    arguments.windows(2).find_map(|pair| {
        let (option, value) = (pair[0].to_str()?, pair[1].to_str()?);
        (option.starts_with('-') && is_it(value)).then(|| format!("{option} is {value}, but must not be negative"))
    })
}

/// The message on a value that is no number.
fn no_number(error: &clap::Error) -> Option<String> {
    let source = error.source()?;
    let wanted = if source.is::<ParseFloatError>() {
        "a number, such as 0.05"
    } else if source.is::<ParseIntError>() {
        "a whole number, such as 4"
    } else {
        return None;
    };
    let (option, value) = (context(error, ContextKind::InvalidArg)?, context(error, ContextKind::InvalidValue)?);
    Some(format!("invalid value '{value}' for '{option}': give {wanted}"))
}

/// The message on a setting that does not exist, which the parser takes for an option.
fn no_setting(error: &clap::Error, given: &[OsString]) -> Option<String> {
    let name = context(error, ContextKind::InvalidArg).filter(|_| error.kind() == ErrorKind::UnknownArgument)?;
    let name = name.strip_prefix("--")?;
    let is_it = |text: &str| text.split('=').next() == Some(name);
    let after = |pair: &[OsString]| pair[0] == "--set" && pair[1].to_str().is_some_and(is_it);
    let joined =
        |argument: &OsString| argument.to_str().and_then(|text| text.strip_prefix("--set=")).is_some_and(is_it);
    let is_set = given.windows(2).any(after) || given.iter().any(joined);
    let near = match context(error, ContextKind::SuggestedArg) {
        Some(near) => format!("did you mean {}?", near.trim_start_matches('-')),
        None => "`photonmap man render` describes all".to_owned(),
    };
    is_set.then(|| format!("--set {name}: there is no such setting; {near}"))
}

/// The way to what was probably meant: a scene without a command, or an option by its name in other programs.
fn hint(error: &clap::Error) -> Option<String> {
    let of = |kind| context(error, kind);
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let given = of(ContextKind::InvalidSubcommand)?;
            let is_scene = Path::new(given).extension().is_some() || photon_scene::builtin(given).is_some();
            is_scene.then(|| format!("hint: photonmap render {given}"))
        }
        ErrorKind::UnknownArgument => {
            let given = of(ContextKind::InvalidArg)?;
            let (_, ours) = OTHERS.iter().find(|(names, _)| names.contains(&given))?;
            Some(format!("hint: {ours}"))
        }
        ErrorKind::InvalidValue => {
            let is_gpu = ["gpu", "cuda", "optix", "metal"].contains(&of(ContextKind::InvalidValue)?);
            let is_backend = of(ContextKind::InvalidArg)?.starts_with("--backend");
            (is_gpu && is_backend)
                .then(|| "hint: --backend vulkan renders on a GPU; `photonmap devices` lists them".to_owned())
        }
        _ => None,
    }
}

/// Names of options in other programs, and what to use here.
const OTHERS: [(&[&str], &str); 8] = [
    (&["--spp", "--samples", "-s"], "--passes N, or --time SECONDS; a pass has --camera-samples of them per pixel"),
    (&["--width", "--height", "--resolution", "-w"], "--size 512x512"),
    (&["--gpu", "--cpu", "--cuda"], "--backend vulkan or --backend cpu; `photonmap devices` lists GPUs"),
    (&["--verbose", "-v"], "all messages are shown; --json FILE writes the details of a render"),
    (&["--fov"], "--camera NAME, or fov_degrees of [[cameras]] in an override file"),
    (&["--quiet", "-q"], "progress and warnings go to standard error: 2> /dev/null hides them"),
    (&["--hdri", "--envmap", "--light"], "--environment FILE.exr, or sky:30,3, gradient, constant"),
    (&["--out", "-O"], "-o FILE.png or -o FILE.exr"),
];

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::super::{Cli, set};
    use super::*;

    fn arguments(given: &[&str]) -> Vec<OsString> {
        [&["photonmap"], given].concat().iter().map(OsString::from).collect()
    }

    fn error(given: &[&str]) -> clap::Error {
        Cli::try_parse_from(set::expanded(arguments(given))).unwrap_err()
    }

    #[test]
    fn what_was_probably_meant_is_said() {
        let of = |given: &[&str]| hint(&error(given)).unwrap_or_default();
        assert_eq!(of(&["room.glb"]), "hint: photonmap render room.glb");
        assert_eq!(of(&["cornell"]), "hint: photonmap render cornell");
        for (option, ours) in [("--spp", "--passes"), ("--width", "--size"), ("--gpu", "--backend"), ("-q", "2>")] {
            assert!(of(&["render", "cornell", option, "64"]).contains(ours), "{option}");
        }
        assert!(of(&["render", "--backend", "gpu"]).contains("--backend vulkan"));
        assert_eq!([of(&["render", "--backend", "none"]), of(&["render", "--preset", "gpu"])], ["", ""]);
        assert_eq!(of(&["rendr"]), "");
        assert_eq!(of(&["render", "--nonsense"]), "");
    }

    #[test]
    fn negative_numbers_are_refused_by_the_name_of_their_option() {
        let of = |given: &[&str]| negative(&error(given), &set::expanded(arguments(given)));
        for (option, value) in [("--seed", "-1"), ("--photons", "-2e5"), ("--radius", "-0.5"), ("--threads", "-4")] {
            let expected = format!("{option} is {value}, but must not be negative");
            assert_eq!(of(&["render", "cornell", option, value, "--errors"]), Some(expected));
        }
        assert_eq!(of(&["render", "cornell", "-1"]), None);
        assert_eq!(of(&["render", "cornell", "--nonsense"]), None);
        assert_eq!(of(&["render", "cornell", "--size", "x"]), None);
    }

    #[test]
    fn what_is_no_number_is_said_without_words_of_the_library() {
        let of = |option: &str, value: &str| no_number(&error(&["render", "cornell", option, value]));
        for (option, value, wanted) in
            [("--target-error", "5%", "a number, such as"), ("--seed", "1.5", "a whole number, such as")]
        {
            let text = of(option, value).unwrap();
            assert!(text.contains(&format!("'{value}' for '{option} ")) && text.contains(wanted), "{text}");
        }
        // These have messages of their own.
        assert_eq!([of("--time", "soon"), of("--preset", "best")], [None, None]);
    }

    #[test]
    fn settings_that_do_not_exist_are_named_as_given() {
        let of = |given: &[&str]| no_setting(&error(given), &arguments(given));
        let expected = "--set bounces: there is no such setting;";
        for given in
            [&["render", "--set", "bounces=3"][..], &["render", "--set=bounces=3"], &["render", "--set", "bounces"]]
        {
            let text = of(given).unwrap();
            assert!(text.starts_with(expected), "{text}");
        }
        assert!(of(&["render", "--set", "gather-ray=3"]).unwrap().ends_with("did you mean gather-rays?"));
        assert_eq!([of(&["render", "--bounces", "3"]), of(&["render", "--set", "k=3", "--bounces"])], [None, None]);
    }
}

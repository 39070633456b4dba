//! A render into a film file that is killed again and again: the file is whole whenever it is read, and the render ends with
//! the sums of one that was left alone.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::shell;

const KILLS: u32 = 50;
/// At least so many must come between the first block and the last.
const FEWEST: u32 = 10;
const RENDER: &str = "render cornell-glass --backend cpu --size 96x64 --photons 20000 --errors --passes 160 --grain 2 \
                      --checkpoint 0s --film";

/// Renders, kills and compares.
pub(crate) fn step() -> Result<(), String> {
    shell::run(&["cargo", "build", "--locked", "-p", "photonmap-cli"], &[])?;
    let root = shell::root();
    let folder = root.join("target/kills");
    // It may not be there.
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let program = root.join("target/debug/photonmap");
    let render = |film: &Path| {
        let mut command = Command::new(&program);
        command.args(RENDER.split_whitespace()).arg(film).stderr(Stdio::null());
        command
    };
    let wrong = |error: std::io::Error| format!("{}: {error}", program.display());
    let (alone, killed) = (folder.join("alone.film"), folder.join("killed.film"));
    let begun = Instant::now();
    if !render(&alone).status().map_err(wrong)?.success() {
        return Err("the render that is left alone fails".to_owned());
    }
    let whole = begun.elapsed();
    let expected = sums(&alone)?;

    let (mut state, mut kills, mut unfinished) = (1_u64, 0, 0);
    while kills < KILLS {
        let mut child = render(&killed).spawn().map_err(wrong)?;
        // A linear congruential generator; on average a twelfth of a render that is left alone, of which half is its start.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let delay = whole.as_secs_f64() / 6.0 * ((state >> 33) as f64 / f64::from(1_u32 << 31));
        std::thread::sleep(Duration::from_secs_f64(delay));
        let ended = child.try_wait().map_err(wrong)?;
        child.kill().and_then(|()| child.wait()).map_err(wrong)?;
        if let Some(status) = ended {
            if !status.success() {
                return Err(format!("the film is not continued after {kills} kills: {status}"));
            }
            break;
        }
        kills += 1;
        if killed.exists() {
            shell::capture(&[&program.to_string_lossy(), "info", &killed.to_string_lossy()])?;
            // The comparison notices passes that are missing.
            unfinished += u32::from(sums(&killed)? != expected);
        }
    }
    if !render(&killed).status().map_err(wrong)?.success() {
        return Err("the film is not continued after the last kill".to_owned());
    }
    if unfinished < FEWEST {
        let seconds = whole.as_secs_f64();
        return Err(format!(
            "only {unfinished} of {kills} kills came between the first block and the last, of a render of {seconds:.1} s; {FEWEST} \
             are needed"
        ));
    }
    if sums(&killed)? != expected {
        return Err(format!(
            "after {kills} kills the sums differ: compare {} and {}",
            alone.display(),
            killed.display()
        ));
    }
    eprintln!("{kills} kills, {unfinished} of them before the last block: the same sums");
    Ok(())
}

/// The arrays of a film file: all bytes before its description, which has the seconds of rendering.
fn sums(film: &Path) -> Result<Vec<u8>, String> {
    let mut bytes = fs::read(film).map_err(|error| format!("{}: {error}", film.display()))?;
    let name = b"film.json";
    let at = bytes.windows(name.len()).position(|window| window == name);
    bytes.truncate(at.ok_or_else(|| format!("{}: has no film.json", film.display()))?);
    // The header before the name has the length and the checksum of the description.
    bytes.truncate(bytes.len().saturating_sub(30));
    Ok(bytes)
}

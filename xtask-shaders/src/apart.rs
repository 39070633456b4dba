//! Compiles each kernel in a separate process, which is killed when it takes too long.
//!
//! glslang propagates `precise` from a variable to everything it was computed from. If that leads through a
//! record in a buffer and back, it does not terminate, and allocates all memory.

use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::compile;
use crate::sources::{Shader, read};

const MARK: &str = "--one";

/// A hundred times the time of the longest kernel.
const LIMIT: Duration = Duration::from_secs(20);

/// The arguments of this program, if it is to compile one kernel: its file, and the folder of
/// its includes.
pub(crate) fn asked_for() -> Option<[PathBuf; 2]> {
    let mut arguments = std::env::args_os().skip(1);
    (arguments.next()? == MARK).then_some([arguments.next()?.into(), arguments.next()?.into()])
}

/// Writes the SPIR-V of one kernel to standard output, or the compiler's errors.
pub(crate) fn answer([path, includes]: &[PathBuf; 2]) -> ExitCode {
    let words = read(path).and_then(|text| {
        let kernel = Shader { path: path.clone(), name: String::new(), text };
        compile::compile(&kernel, includes)
    });
    let (code, bytes) = match words {
        Ok(words) => (ExitCode::SUCCESS, words.iter().flat_map(|word| word.to_le_bytes()).collect()),
        Err(message) => (ExitCode::FAILURE, message.into_bytes()),
    };
    // Standard output is a pipe to ourselves.
    if std::io::stdout().write_all(&bytes).is_ok() { code } else { ExitCode::FAILURE }
}

/// The SPIR-V words of one kernel.
///
/// # Errors
/// The compiler's errors, or that it does not terminate.
pub(crate) fn compile(kernel: &Shader, includes: &Path) -> Result<Vec<u32>, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut command = Command::new(program);
    command.arg(MARK).arg(&kernel.path).arg(includes);
    let (good, bytes) = limited(&mut command, LIMIT)?;
    if good {
        Ok(bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect())
    } else {
        Err(String::from_utf8_lossy(&bytes).into_owned())
    }
}

/// Whether a command succeeds, and its output.
fn limited(command: &mut Command, limit: Duration) -> Result<(bool, Vec<u8>), String> {
    let mut child = command.stdout(Stdio::piped()).spawn().map_err(|error| error.to_string())?;
    let pipe = child.stdout.take();
    // Read concurrently, since a full pipe would block the compiler.
    let reader = thread::spawn(move || {
        let mut bytes = Vec::new();
        pipe.map(|mut pipe| pipe.read_to_end(&mut bytes)).transpose().map(|_| bytes)
    });
    let good = wait(&mut child, limit)?;
    let bytes = reader.join().map_err(|_| "the compiler's output was not read")?.map_err(|error| error.to_string())?;
    Ok((good, bytes))
}

fn wait(child: &mut Child, limit: Duration) -> Result<bool, String> {
    let start = Instant::now();
    loop {
        match child.try_wait().map_err(|error| error.to_string())? {
            Some(status) if status.code().is_some() => return Ok(status.success()),
            Some(status) => return Err(format!("the compiler died ({status})")),
            None if start.elapsed() < limit => thread::sleep(Duration::from_millis(2)),
            None => {
                let killed = child.kill().and_then(|()| child.wait());
                killed.map_err(|error| error.to_string())?;
                return Err(format!(
                    "the compiler was stopped after {} s: do not compute a `precise` variable from members of a record \
                     that was read from a buffer; pass them to a function by value",
                    limit.as_secs()
                ));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_end_is_stopped() {
        let sleeper = || {
            let mut command = Command::new("sleep");
            command.arg("100");
            command
        };
        let message = limited(&mut sleeper(), Duration::from_millis(20)).unwrap_err();
        assert!(message.contains("precise"), "{message}");
        let echo = limited(Command::new("echo").arg("word"), LIMIT).unwrap();
        assert_eq!(echo, (true, b"word\n".to_vec()));
        assert!(!limited(&mut Command::new("false"), LIMIT).unwrap().0);
    }
}

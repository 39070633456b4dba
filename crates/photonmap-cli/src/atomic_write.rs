//! Files that appear whole or not at all: written under another name first, and renamed.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::fault::Fault;

/// What writes may raise.
pub type Failure = Box<dyn std::error::Error>;

/// Writes a file. Whatever fails, a full disk too, leaves what was there before, and nothing else.
///
/// # Errors
/// [`Fault::Failure`] names the file and why it could not be written.
pub fn write(path: &Path, save: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>) -> Result<(), Fault> {
    let partial = partial(path);
    let all = || -> Result<(), Failure> {
        let mut file = BufWriter::new(File::create(&partial)?);
        save(&mut file)?;
        // What is still in memory may be what does not fit; dropping it would not say so.
        file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        Ok(fs::rename(&partial, path)?)
    };
    all().map_err(|why| {
        let _ = fs::remove_file(&partial);
        Fault::writing(path, why)
    })
}

/// Writes bytes, likewise.
///
/// # Errors
/// Likewise.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    write(path, |file| Ok(file.write_all(bytes)?))
}

/// Whether [`write()`] could begin: worth knowing before an hour's work.
///
/// # Errors
/// [`Fault::Input`] names the file and why not.
pub fn check(path: &Path) -> Result<(), Fault> {
    let partial = partial(path);
    let made = File::create(&partial).and_then(|_| fs::remove_file(&partial));
    made.map_err(|why| Fault::input(format!("{}: cannot be written: {why}", path.display())))
}

/// Where a file is written before it gets its name.
fn partial(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fails_leaves_what_was_there() {
        let folder = std::env::temp_dir().join(format!("photon-whole-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("a.txt");
        write_bytes(&path, b"good").unwrap();
        let failed = write(&path, |file| {
            file.write_all(b"half of")?;
            Err("no more".into())
        });
        let words = failed.unwrap_err().to_string();
        assert!(words.contains("a.txt") && words.contains("no more"), "{words}");
        assert_eq!(fs::read(&path).unwrap(), b"good");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "nothing else is left");
        check(&path).unwrap();
        assert!(check(&folder.join("none/b.txt")).unwrap_err().to_string().contains("b.txt"));
        fs::remove_dir_all(&folder).unwrap();
    }
}

//! Atomic file writes: a file appears complete under its name, or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use tempfile::NamedTempFile;

/// The errors that a writer may return.
pub type Failure = Box<dyn std::error::Error>;

/// Writes a file through `save`. If anything fails, a full disk included, the previous file is left as it was and
/// nothing else remains; only a process that is killed may leave a file named `.NAME.….partial`.
///
/// The file is on the disk, and so is its name, when this returns: a power failure afterwards does not undo it. Several
/// processes may write the same file at once, each under a partial name of its own that the system guarantees to be new;
/// the last one wins.
///
/// # Errors
/// Those of `save`, and those of the system.
pub fn write(path: &Path, save: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>) -> Result<(), Failure> {
    let (file, partial) = create(path)?.into_parts();
    let mut file = BufWriter::new(file);
    save(&mut file)?;
    // The last write may fail for lack of space; dropping the buffer would hide that.
    file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
    partial.persist(path)?;
    Ok(sync_folder(path)?)
}

/// Makes the name of a file in its folder durable.
#[cfg(unix)]
fn sync_folder(path: &Path) -> io::Result<()> {
    match File::open(folder(path))?.sync_all() {
        // Some file systems have no such operation for folders.
        Err(why) if matches!(why.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        result => result,
    }
}

/// Folders cannot be opened as files on other systems.
#[cfg(not(unix))]
fn sync_folder(_path: &Path) -> io::Result<()> {
    Ok(())
}

/// The folder of a file.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Writes bytes, with the same guarantees.
///
/// # Errors
/// As [`write()`].
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write(path, |file| Ok(file.write_all(bytes)?))
}

/// Checks that [`write()`] could start, so that an invalid path is reported before an hour of rendering.
///
/// # Errors
/// The path is a folder, its folder does not exist, or it cannot be written to.
pub fn check(path: &Path) -> io::Result<()> {
    if path.is_dir() {
        return Err(io::Error::other("it is a folder"));
    }
    create(path).map(drop)
}

/// A temporary file in the folder of `path`, since only there a rename is atomic.
fn create(path: &Path) -> io::Result<NamedTempFile> {
    let name = path.file_name().ok_or_else(|| io::Error::other("it has no file name"))?;
    let mut prefix = std::ffi::OsString::from(".");
    prefix.push(name);
    // With the process, so that a user who finds such a file can tell whether somebody still writes it.
    prefix.push(format!(".{}.", std::process::id()));
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".partial");
    // Temporary files are private by default; pictures have the usual permissions of new files.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder(path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_failed_write_leaves_the_previous_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_bytes(&path, b"good").unwrap();
        let failed = write(&path, |file| {
            file.write_all(b"half of")?;
            Err("no more".into())
        });
        let words = failed.unwrap_err().to_string();
        assert!(words.contains("no more"), "{words}");
        assert_eq!(fs::read(&path).unwrap(), b"good");
        check(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left");
        assert!(check(&folder.path().join("none/b.txt")).is_err());
        assert!(check(folder.path()).unwrap_err().to_string().contains("folder"));
    }

    /// Two writers of one file at a time, many times: the file is always that of one of them.
    #[test]
    fn two_writers_do_not_collide() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        std::thread::scope(|scope| {
            for letter in [b'a', b'b'] {
                let path = &path;
                scope.spawn(move || (0..20).for_each(|_| write_bytes(path, &[letter; 10_000]).unwrap()));
            }
        });
        let bytes = fs::read(&path).unwrap();
        assert!(bytes.len() == 10_000 && bytes.iter().all(|byte| *byte == bytes[0]));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left");
    }

    #[cfg(unix)]
    #[test]
    fn a_file_has_the_usual_permissions() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("a"), folder.path().join("b"));
        write_bytes(&ours, b"").unwrap();
        File::create(&plain).unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}

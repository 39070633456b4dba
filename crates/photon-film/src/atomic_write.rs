//! Atomic file writes: a file appears complete under its name, or not at all.

use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, Seek as _, Write};
use std::path::{Path, PathBuf};

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
/// A symbolic link stays, and what it points to is replaced. The new file has the permissions of the previous one, and its
/// owner if the system allows that. A device, a pipe or `/dev/stdout` is not replaced: the bytes go there once all of them are
/// known.
///
/// # Errors
/// Those of `save`, and those of the system.
pub fn write(path: &Path, save: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>) -> Result<(), Failure> {
    let (path, previous) = match target(path)? {
        Target::File(path, previous) => (path, previous),
        Target::Stream(path) => return write_stream(&path, save),
    };
    let (file, partial) = create(&path)?.into_parts();
    if let Some(previous) = previous {
        keep_owner(&file, &previous);
        file.set_permissions(previous.permissions())?;
    }
    let mut file = BufWriter::new(file);
    save(&mut file)?;
    // The last write may fail for lack of space; dropping the buffer would hide that.
    file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
    partial.persist(&path)?;
    Ok(sync_folder(&path)?)
}

/// Writes to what is no regular file, which may have no positions: by way of a temporary file.
fn write_stream(path: &Path, save: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>) -> Result<(), Failure> {
    let mut file = BufWriter::new(tempfile::tempfile()?);
    save(&mut file)?;
    let mut file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.rewind()?;
    // Behind what is there already, if standard output is a file.
    let mut stream = File::options().append(true).open(path)?;
    io::copy(&mut file, &mut stream)?;
    Ok(())
}

/// What a path leads to.
enum Target {
    /// A regular file, with what is known of it if it exists; no link.
    File(PathBuf, Option<Metadata>),
    /// Anything else that can be written to.
    Stream(PathBuf),
}

/// Follows symbolic links, also to files that do not exist yet.
fn target(path: &Path) -> io::Result<Target> {
    // As many as Linux follows.
    const MAX_LINKS: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..=MAX_LINKS {
        let found = match fs::symlink_metadata(&path) {
            Err(why) if why.kind() == io::ErrorKind::NotFound => return Ok(Target::File(path, None)),
            found => found?,
        };
        let kind = found.file_type();
        if kind.is_dir() {
            return Err(io::Error::other("it is a folder"));
        }
        if kind.is_file() {
            return Ok(Target::File(path, Some(found)));
        }
        // The links in `/proc` are open files, whatever path they show.
        if !kind.is_symlink() || path.starts_with("/proc") {
            return Ok(Target::Stream(path));
        }
        let to = fs::read_link(&path)?;
        path = folder(&path).join(to);
    }
    Err(io::Error::other("it has too many symbolic links"))
}

/// Gives a file the owner and group of the previous one. Only some users may do that.
#[cfg(unix)]
fn keep_owner(file: &File, previous: &Metadata) {
    use std::os::unix::fs::{MetadataExt as _, fchown};
    let _ = fchown(file, Some(previous.uid()), Some(previous.gid()));
}

#[cfg(not(unix))]
fn keep_owner(_file: &File, _previous: &Metadata) {}

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
    match target(path)? {
        Target::File(path, _) => create(&path).map(drop),
        // Opening a pipe would wait for its reader.
        Target::Stream(_) => Ok(()),
    }
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
    builder.tempfile_in(folder(path)).map_err(|why| without_temporary_name(&why, folder(path)))
}

/// The error about a folder in which no temporary file could be made, without the name of that file.
fn without_temporary_name(why: &io::Error, folder: &Path) -> io::Error {
    let shown = folder.display();
    let text = match why.kind() {
        io::ErrorKind::NotFound if folder.is_dir() => format!("the system makes no files in the folder {shown}"),
        io::ErrorKind::NotFound => format!("there is no folder {shown}"),
        _ => {
            let cause = why.get_ref().and_then(|inner| inner.source());
            let cause = cause.map_or_else(|| why.to_string(), ToString::to_string);
            format!("no file can be made in the folder {shown}: {cause}")
        }
    };
    io::Error::new(why.kind(), text)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let words = check(&folder.path().join("none/b.txt")).unwrap_err().to_string();
        assert_eq!(words, format!("there is no folder {}", folder.path().join("none").display()));
        let words = write_bytes(&path.join("b.txt"), b"").unwrap_err().to_string();
        assert!(!words.contains("partial"), "{words}");
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

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_the_file_keeps_its_permissions() {
        use std::os::unix::fs::{PermissionsExt as _, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("data")).unwrap();
        fs::write(at("data/a"), "old").unwrap();
        fs::set_permissions(at("data/a"), fs::Permissions::from_mode(0o640)).unwrap();
        // A link to a link, relative to its folder; a link to a file that is not there yet; one that ends nowhere.
        symlink("data/second", at("first")).unwrap();
        symlink("a", at("data/second")).unwrap();
        symlink("data/new", at("ahead")).unwrap();
        symlink("loop", at("loop")).unwrap();
        for (link, file) in [("first", "data/a"), ("ahead", "data/new")] {
            check(&at(link)).unwrap();
            write_bytes(&at(link), b"written").unwrap();
            assert!(at(link).is_symlink() && !at(file).is_symlink());
            assert_eq!(fs::read(at(file)).unwrap(), b"written");
        }
        assert_eq!(fs::metadata(at("data/a")).unwrap().permissions().mode() & 0o7777, 0o640);
        assert!(check(&at("loop")).is_err() && write_bytes(&at("loop"), b"").is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_and_pipes_are_not_replaced() {
        use std::io::Read as _;
        use std::os::fd::AsRawFd as _;
        use std::os::unix::fs::FileTypeExt as _;
        let folder = tempfile::tempdir().unwrap();
        // A pipe by a name for it, as `/dev/stdout` is one; and what needs to go back within the file, as a zip does.
        let (mut reader, writer) = io::pipe().unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(format!("/proc/self/fd/{}", writer.as_raw_fd()), &link).unwrap();
        check(&link).unwrap();
        write(&link, |file| {
            file.write_all(b"_ello")?;
            file.rewind()?;
            Ok(file.write_all(b"h")?)
        })
        .unwrap();
        drop(writer);
        let mut text = String::new();
        reader.read_to_string(&mut text).unwrap();
        assert_eq!(text, "hello");
        // Standard output that is a file: behind what is there.
        let path = folder.path().join("log");
        fs::write(&path, "before ").unwrap();
        let log = File::options().append(true).open(&path).unwrap();
        write_bytes(Path::new(&format!("/proc/self/fd/{}", log.as_raw_fd())), b"after").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"before after");
        write_bytes(Path::new("/dev/null"), b"gone").unwrap();
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        let full = write_bytes(Path::new("/dev/full"), b"no space").unwrap_err().to_string();
        assert!(full.contains("No space"), "{full}");
    }
}

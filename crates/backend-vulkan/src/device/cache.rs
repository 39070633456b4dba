//! Pipeline cache on disk, kept between runs of the program.
//!
//! A damaged file costs no more than the compile time it would have saved.

use std::ffi::OsString;
use std::fs::TryLockError;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::logical::Limits;
use super::module::Module;

/// Magic bytes of the file; the last one is the version of the format.
const MARK: [u8; 8] = *b"photon\x00\x01";
/// Length of the header: the magic bytes and a hash of the data. Drivers validate only the header of their own
/// data.
const HEAD: usize = 16;
/// Longest time to wait for another process that stores its data.
const PATIENCE: Duration = Duration::from_millis(500);

/// The cache file of one device, driver and set of shaders.
#[derive(Clone, Debug)]
pub(crate) struct DiskCache {
    file: PathBuf,
}

impl DiskCache {
    /// A file in the user's cache folder; `None` if there is no such folder.
    pub(crate) fn of_user(limits: &Limits, modules: &[&Module]) -> Option<Self> {
        Some(Self::within(&folder(&|name| std::env::var_os(name))?, limits, modules))
    }

    /// A file in `folder`, which need not exist yet. The file name is a hash of the driver's pipeline-cache
    /// key, the device, the driver and all SPIR-V: if any of them changes, another file is used.
    pub(crate) fn within(folder: &Path, limits: &Limits, modules: &[&Module]) -> Self {
        let mut hash = Fnv::default();
        hash.add(&limits.cache_key);
        for text in [&limits.name, &limits.driver] {
            hash.add(text.as_bytes());
            hash.add(&[0]);
        }
        for module in modules {
            hash.add(module.bytes);
        }
        Self { file: folder.join(format!("{:016x}.pipelines", hash.0)) }
    }

    /// The cached data; empty if there is no file or it is damaged.
    pub(crate) fn read(&self) -> Vec<u8> {
        let Ok(bytes) = std::fs::read(&self.file) else { return Vec::new() };
        let Some((head, data)) = bytes.split_at_checked(HEAD) else { return Vec::new() };
        if head == self::head(data) {
            return data.to_vec();
        }
        log::warn!("{}: the pipeline cache is damaged and will be replaced", self.file.display());
        Vec::new()
    }

    /// Replaces the data by what `merged` makes of those that other processes may have stored meanwhile, unless that is
    /// `None`. Processes do it one after another, where folders can be locked.
    pub(crate) fn update(&self, merged: impl FnOnce(&[u8]) -> Option<Vec<u8>>) {
        let folder = self.file.parent().unwrap_or(Path::new("."));
        // Failure to store the cache is harmless.
        if let Err(error) = std::fs::create_dir_all(folder) {
            log::warn!("{}: the pipeline cache was not stored: {error}", self.file.display());
            return;
        }
        let lock = std::fs::File::open(folder).ok();
        let until = Instant::now() + PATIENCE;
        while lock.as_ref().is_some_and(|lock| matches!(lock.try_lock(), Err(TryLockError::WouldBlock)))
            && Instant::now() < until
        {
            std::thread::sleep(Duration::from_millis(5));
        }
        if let Some(data) = merged(&self.read()) {
            self.write(&data);
        }
    }

    /// Stores `data`: writes a new file beside the old one and renames it, so that no reader sees a partial
    /// file.
    fn write(&self, data: &[u8]) {
        let written = || {
            std::fs::create_dir_all(self.file.parent().unwrap_or(Path::new(".")))?;
            let beside = self.file.with_extension(format!("{}.new", std::process::id()));
            std::fs::write(&beside, [&head(data), data].concat())?;
            std::fs::rename(&beside, &self.file)
        };
        if let Err(error) = written() {
            log::warn!("{}: the pipeline cache was not stored: {error}", self.file.display());
        }
    }
}

fn head(data: &[u8]) -> [u8; HEAD] {
    let mut hash = Fnv::default();
    hash.add(data);
    let mut head = [0; HEAD];
    head[..8].copy_from_slice(&MARK);
    head[8..].copy_from_slice(&hash.0.to_le_bytes());
    head
}

/// The user's cache folder.
fn folder(variable: &dyn Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let set = |name| variable(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let base = set("XDG_CACHE_HOME").or_else(|| set("LOCALAPPDATA")).or_else(|| Some(set("HOME")?.join(".cache")))?;
    Some(base.join("photon-mapping"))
}

/// 64-bit FNV-1a hash (Fowler, Noll, Vo).
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::Pipelines;
    use crate::{Vulkan, shaders};

    /// A temporary folder for one test, removed at the end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("photon-cache-{}-{name}", std::process::id()));
            let _ = std::fs::remove_dir_all(&path);
            Self(path)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    /// Published values: the hashes of the empty string and of "a".
    #[test]
    fn the_hash_is_fnv_1a() {
        let mut hash = Fnv::default();
        assert_eq!(hash.0, 0xcbf2_9ce4_8422_2325);
        hash.add(b"a");
        assert_eq!(hash.0, 0xaf63_dc4c_8601_ec8c);
    }

    #[test]
    fn the_folder_is_the_users() {
        let with = |set: &'static [(&'static str, &'static str)]| {
            folder(&|name| set.iter().find(|(known, _)| *known == name).map(|(_, value)| OsString::from(value)))
        };
        assert_eq!(with(&[("XDG_CACHE_HOME", "c"), ("HOME", "h")]), Some(PathBuf::from("c/photon-mapping")));
        assert_eq!(with(&[("XDG_CACHE_HOME", ""), ("HOME", "h")]), Some(PathBuf::from("h/.cache/photon-mapping")));
        assert_eq!(with(&[]), None);
    }

    /// If the device, the driver, the driver's own key or any module changes, the file name changes.
    #[test]
    fn the_file_is_of_device_driver_and_shaders() {
        let Some(on) = Vulkan::for_tests() else { return };
        let file = |limits: &Limits, modules: &[&Module]| DiskCache::within(Path::new("f"), limits, modules).file;
        let limits = on.limits();
        let plain = file(limits, &shaders::KERNELS);
        assert_eq!(plain, file(limits, &shaders::KERNELS));
        let mut changed = [limits.clone(), limits.clone(), limits.clone()];
        changed[0].name.push('2');
        changed[1].driver.push('2');
        changed[2].cache_key[15] ^= 1;
        for limits in changed {
            assert_ne!(plain, file(&limits, &shaders::KERNELS));
        }
        assert_ne!(plain, file(limits, &shaders::KERNELS[1..]));
    }

    #[test]
    fn what_was_kept_is_read_and_what_is_damaged_is_not() {
        let Some(on) = Vulkan::for_tests() else { return };
        let folder = Folder::new("damage");
        let cache = DiskCache::within(&folder.0, on.limits(), &shaders::KERNELS);
        assert!(cache.read().is_empty());
        let data: Vec<u8> = (0..1000).map(|i| (i * i % 251) as u8).collect();
        cache.write(&data);
        assert_eq!(cache.read(), data);
        let whole = std::fs::read(&cache.file).unwrap();
        for length in [0, 7, HEAD - 1, HEAD, whole.len() - 1] {
            std::fs::write(&cache.file, &whole[..length]).unwrap();
            assert!(cache.read().is_empty(), "{length}");
        }
        for at in [0, 7, 8, 15, 16, 500, whole.len() - 1] {
            let mut flipped = whole.clone();
            flipped[at] ^= 4;
            std::fs::write(&cache.file, flipped).unwrap();
            assert!(cache.read().is_empty(), "{at}");
        }
        assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 1, "temporary files are left");
    }

    /// Pipelines are created whatever the file contains, and the file is complete afterwards.
    #[test]
    fn pipelines_survive_a_corrupt_file() {
        let Some(mut on) = Vulkan::for_tests() else { return };
        let folder = Folder::new("pipelines");
        let cache = DiskCache::within(&folder.0, on.limits(), &shaders::KERNELS);
        let make = |on: &mut Vulkan| {
            let mut pipelines = Pipelines::new(&on.device, Some(cache.clone())).unwrap();
            let begun = pipelines.begun_with();
            let kernel = pipelines.kernel(&shaders::DEVICE_COPY, 64, &());
            pipelines.compiled(&kernel).unwrap();
            begun
        };
        assert_eq!(make(&mut on), 0);
        let kept = cache.read();
        assert!(!kept.is_empty());
        assert_eq!(make(&mut on), kept.len(), "the second run uses the cache of the first");
        std::fs::write(&cache.file, b"scribble").unwrap();
        assert_eq!(make(&mut on), 0);
        assert_eq!(make(&mut on), cache.read().len());
        // A folder in place of the file can be neither read nor written.
        std::fs::remove_file(&cache.file).unwrap();
        std::fs::create_dir_all(cache.file.join("in the way")).unwrap();
        assert_eq!(make(&mut on), 0);
    }
}

//! Memory that is available to this process, as Linux reports it: of the machine, of its control groups, and of the limit on
//! its address space.

use std::fs;
use std::path::Path;

/// Bytes that this process can still take; `None` where the system does not say.
pub(super) fn available() -> Option<u64> {
    available_in(Path::new("/"))
}

/// The same with another root of the file system, for tests.
fn available_in(root: &Path) -> Option<u64> {
    let read = |path: &str| fs::read_to_string(root.join(path)).ok();
    let kilobytes = |text: &str, key: &str| number(text, key).and_then(|number| number.checked_mul(1024));
    let machine = read("proc/meminfo").and_then(|text| kilobytes(&text, "MemAvailable:"));
    let groups = read("proc/self/cgroup").and_then(|text| {
        let left = |line: &str| -> Option<u64> {
            // Hierarchy, controllers, path: the second version has no controllers.
            let mut fields = line.splitn(3, ':').skip(1);
            let (controllers, path) = (fields.next()?, fields.next()?.trim_start_matches('/'));
            let group = match controllers {
                "" => &V2,
                _ if controllers.split(',').any(|name| name == "memory") => &V1,
                _ => return None,
            };
            let base = root.join(group.base);
            let folder = base.join(path);
            folder.ancestors().take_while(|folder| folder.starts_with(&base)).filter_map(|at| group.left(at)).min()
        };
        text.lines().filter_map(left).min()
    });
    let address_space = read("proc/self/limits").and_then(|limits| {
        let limit = number(&limits, "Max address space")?;
        let used = kilobytes(&read("proc/self/status")?, "VmSize:")?;
        Some(limit.saturating_sub(used))
    });
    [machine, groups, address_space].into_iter().flatten().min()
}

/// The first number behind a key at the beginning of a line.
fn number(text: &str, key: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix(key))?.split_whitespace().next()?.parse().ok()
}

/// Where a version of control groups keeps its figures.
struct ControlGroup {
    base: &'static str,
    limit: &'static str,
    usage: &'static str,
    /// The key of what is in use but can be given back, such as files that were read.
    reclaimable: &'static str,
}

const V1: ControlGroup = ControlGroup {
    base: "sys/fs/cgroup/memory",
    limit: "memory.limit_in_bytes",
    usage: "memory.usage_in_bytes",
    reclaimable: "total_inactive_file ",
};

const V2: ControlGroup =
    ControlGroup { base: "sys/fs/cgroup", limit: "memory.max", usage: "memory.current", reclaimable: "inactive_file " };

impl ControlGroup {
    /// Bytes that are left in a group; `None` without a limit.
    fn left(&self, folder: &Path) -> Option<u64> {
        let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
        let limit: u64 = read(self.limit)?.trim().parse().ok()?;
        let usage: u64 = read(self.usage)?.trim().parse().ok()?;
        let reclaimable = read("memory.stat").and_then(|text| number(&text, self.reclaimable)).unwrap_or(0);
        Some(limit.saturating_sub(usage.saturating_sub(reclaimable)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files of an imagined system.
    fn available_with(files: &[(&str, &str)]) -> Option<u64> {
        let root = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        available_in(root.path())
    }

    #[test]
    fn the_tightest_limit_counts() {
        let machine = ("proc/meminfo", "MemTotal: 16000 kB\nMemAvailable:    8000 kB\n");
        assert_eq!(available_with(&[]), None);
        assert_eq!(available_with(&[machine]), Some(8_192_000));
        // The second version: the limit of an outer group, of which files that were read can be given back.
        let second = ("proc/self/cgroup", "0::/jobs/7\n");
        let [none, limit] =
            [("sys/fs/cgroup/jobs/7/memory.max", "max\n"), ("sys/fs/cgroup/jobs/memory.max", "5000000\n")];
        let usage = ("sys/fs/cgroup/jobs/memory.current", "3000000\n");
        let files = ("sys/fs/cgroup/jobs/memory.stat", "anon 1\ninactive_file 500000\n");
        assert_eq!(available_with(&[machine, second, none, limit, usage]), Some(2_000_000));
        assert_eq!(available_with(&[machine, second, none, limit, usage, files]), Some(2_500_000));
        assert_eq!(available_with(&[machine, second, none]), Some(8_192_000));
        // The first version, whose path in a container is not that in its file system.
        let first = ("proc/self/cgroup", "9:cpu:/a\n4:memory:/outside/8\n");
        let [limit, usage] = [
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "4000000"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "1000000"),
        ];
        assert_eq!(available_with(&[machine, first, limit, usage]), Some(3_000_000));
        let space = ("proc/self/limits", "Limit Soft Hard Units\nMax address space  3000000  unlimited  bytes\n");
        let size = ("proc/self/status", "Name:\tx\nVmSize:\t 1000 kB\n");
        assert_eq!(available_with(&[machine, space, size]), Some(1_976_000));
    }
}

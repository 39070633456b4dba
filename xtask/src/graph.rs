//! The packages of the workspace and their dependencies, read from `cargo metadata`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;

use crate::shell;

/// A package as `cargo metadata` describes it.
#[derive(Debug)]
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) version: String,
    /// The minimum Rust version that it declares.
    pub(crate) rust_version: Option<String>,
    manifest: String,
    edges: Vec<Edge>,
}

#[derive(Debug)]
struct Edge {
    to: String,
    kinds: BTreeSet<Kind>,
}

/// Kind of a dependency.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Normal,
    Build,
    Dev,
}

/// All packages, by their identifier in `cargo metadata`.
#[derive(Debug)]
pub(crate) struct Graph {
    packages: BTreeMap<String, Package>,
    members: Vec<String>,
}

impl Graph {
    /// The graph of this workspace, for all platforms, as in its lock file.
    pub(crate) fn of_workspace() -> Result<Self, String> {
        let text = shell::capture(&["cargo", "metadata", "--format-version", "1", "--locked"])?;
        Self::parse(&text)
    }

    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let root: Value = serde_json::from_str(text).map_err(|error| format!("cargo metadata: {error}"))?;
        let mut edges = BTreeMap::new();
        for node in list(&root["resolve"], "nodes")? {
            let from = list(node, "deps")?;
            edges.insert(string(node, "id")?, from.iter().map(edge).collect::<Result<Vec<_>, _>>()?);
        }
        let mut packages = BTreeMap::new();
        for package in list(&root, "packages")? {
            let id = string(package, "id")?;
            let edges = edges.remove(&id).unwrap_or_default();
            let described = Package {
                name: string(package, "name")?,
                version: string(package, "version")?,
                rust_version: package["rust_version"].as_str().map(str::to_owned),
                manifest: string(package, "manifest_path")?,
                edges,
            };
            packages.insert(id, described);
        }
        let members = list(&root, "workspace_members")?;
        let members = members.iter().filter_map(Value::as_str).map(str::to_owned).collect();
        Ok(Self { packages, members })
    }

    /// The members of the workspace.
    pub(crate) fn members(&self) -> impl Iterator<Item = (&str, &Package)> {
        self.members.iter().filter_map(|id| self.packages.get(id).map(|package| (id.as_str(), package)))
    }

    /// The members under `crates/`, which users depend on.
    pub(crate) fn libraries(&self) -> impl Iterator<Item = (&str, &Package)> {
        self.members().filter(|(_, package)| {
            let folder = Path::new(&package.manifest).parent().and_then(Path::parent);
            folder.and_then(Path::file_name).is_some_and(|name| name == "crates")
        })
    }

    /// Everything reachable from `from` along dependencies of the given kinds, `from` included.
    pub(crate) fn reached<'a>(
        &'a self,
        from: impl Iterator<Item = &'a str>,
        kinds: &[Kind],
    ) -> impl Iterator<Item = &'a Package> {
        let mut seen = BTreeSet::new();
        let mut waiting: Vec<&str> = from.collect();
        while let Some(id) = waiting.pop() {
            let Some(package) = self.packages.get(id) else { continue };
            if seen.insert(id) {
                let wanted = package.edges.iter().filter(|edge| kinds.iter().any(|kind| edge.kinds.contains(kind)));
                waiting.extend(wanted.map(|edge| edge.to.as_str()));
            }
        }
        seen.into_iter().filter_map(|id| self.packages.get(id))
    }
}

fn edge(value: &Value) -> Result<Edge, String> {
    let kinds = list(value, "dep_kinds")?.iter().map(|kind| match kind["kind"].as_str() {
        Some("dev") => Kind::Dev,
        Some("build") => Kind::Build,
        _ => Kind::Normal,
    });
    Ok(Edge { to: string(value, "pkg")?, kinds: kinds.collect() })
}

fn string(value: &Value, key: &str) -> Result<String, String> {
    value[key].as_str().map(str::to_owned).ok_or_else(|| format!("cargo metadata: no text under {key:?}"))
}

fn list<'a>(value: &'a Value, key: &str) -> Result<&'a [Value], String> {
    value[key].as_array().map(Vec::as_slice).ok_or_else(|| format!("cargo metadata: no list under {key:?}"))
}

/// An artificial workspace: the library `core`, the package `benches`, and their dependencies.
#[cfg(test)]
pub(crate) mod sample {
    use serde_json::{Value, json};

    /// Name, version, folder, rust-version.
    pub(crate) type Described<'a> = (&'a str, &'a str, &'a str, Option<&'a str>);
    /// From, to, by position in the list of packages; kind.
    pub(crate) type Edge<'a> = (usize, usize, Option<&'a str>);

    pub(crate) fn graph(packages: &[Described<'_>], edges: &[Edge<'_>]) -> super::Graph {
        let described: Vec<Value> = packages
            .iter()
            .enumerate()
            .map(|(id, (name, version, folder, rust_version))| {
                json!({"id": id.to_string(), "name": name, "version": version, "rust_version": rust_version,
                       "manifest_path": format!("/{folder}/{name}/Cargo.toml")})
            })
            .collect();
        let nodes: Vec<Value> = (0..packages.len())
            .map(|id| {
                let deps: Vec<Value> = edges
                    .iter()
                    .filter(|edge| edge.0 == id)
                    .map(|edge| json!({"pkg": edge.1.to_string(), "dep_kinds": [{"kind": edge.2}]}))
                    .collect();
                json!({"id": id.to_string(), "deps": deps})
            })
            .collect();
        let members: Vec<String> =
            (0..packages.len()).filter(|&id| packages[id].2 != "registry").map(|id| id.to_string()).collect();
        let all = json!({"packages": described, "workspace_members": members, "resolve": {"nodes": nodes}});
        super::Graph::parse(&all.to_string()).unwrap()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_are_the_members_under_crates() {
        let graph = sample::graph(
            &[
                ("core", "1.0.0", "crates", None),
                ("benches", "1.0.0", "top", None),
                ("glam", "0.34.0", "registry", None),
            ],
            &[(0, 2, None)],
        );
        let libraries: Vec<&str> = graph.libraries().map(|(_, package)| package.name.as_str()).collect();
        assert_eq!(libraries, ["core"]);
        assert_eq!(graph.members().count(), 2);
    }

    #[test]
    fn only_the_kinds_asked_for_are_followed() {
        let graph = sample::graph(
            &[("core", "1.0.0", "crates", None), ("a", "1.0.0", "registry", None), ("b", "1.0.0", "registry", None)],
            &[(0, 1, None), (0, 2, Some("dev"))],
        );
        let names = |kinds: &[Kind]| -> Vec<String> {
            graph.reached(["0"].into_iter(), kinds).map(|package| package.name.clone()).collect()
        };
        assert_eq!(names(&[Kind::Normal]), ["core", "a"]);
        assert_eq!(names(&[Kind::Normal, Kind::Dev]), ["core", "a", "b"]);
    }

    #[test]
    fn what_is_not_metadata_is_refused() {
        assert!(Graph::parse("{").is_err());
        assert!(Graph::parse("{\"packages\": []}").is_err());
    }
}

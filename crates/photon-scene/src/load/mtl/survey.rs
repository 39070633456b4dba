//! Which images the materials of MTL files use, before any is decoded: under a limit on memory, all are planned together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use photon_core::Wrap;

use super::map::Map;
use super::{Entry, Library};
use crate::load::budget::{Budget, Shortage};
use crate::load::gltf::leaves_folder;
use crate::load::image::{Header, Plan, Wanted};

/// The uses of an image.
#[derive(Default)]
struct Uses {
    /// Whether its bytes are numbers, not colours.
    encodings: BTreeSet<bool>,
    /// Whether textures of alpha are clamped.
    alphas: BTreeSet<bool>,
    /// Textures of metal and roughness: the other image, and whether they are clamped.
    combined: BTreeSet<(Option<PathBuf>, bool)>,
    /// Materials, and statements with names of files.
    users: Vec<(String, String)>,
}

/// Plans the sizes of all images if memory is limited; returns the place of each path in the plan.
pub(super) fn plan(library: &Library, budget: &Budget) -> Result<(Plan, BTreeMap<PathBuf, usize>), Shortage> {
    let Some(left) = budget.left() else { return Ok((Plan::default(), BTreeMap::new())) };
    let mut images: BTreeMap<PathBuf, Uses> = BTreeMap::new();
    for material in &library.entries {
        record(material, &mut images);
    }
    let (mut wanted, mut planned) = (Vec::new(), BTreeMap::new());
    for (path, uses) in images {
        // One that cannot be read is reported by the material that uses it.
        let Some((header, file)) = Header::of_file(&path, left) else { continue };
        planned.insert(path, wanted.len());
        let copies = (uses.encodings.len() + uses.alphas.len()) as u64;
        wanted.push(Wanted { header, file, copies, made: uses.combined.len() as u64, users: uses.users });
    }
    Ok((Plan::new(wanted, budget)?, planned))
}

fn record(material: &Entry, images: &mut BTreeMap<PathBuf, Uses>) {
    let Entry {
        name, folder, diffuse_map, emissive_map, normal_map, roughness_map, metallic_map, dissolve_map, ..
    } = material;
    let path = |map: &Map| folder.join(&map.file);
    let mut each = |keyword: &str, map: &Option<Map>, is_linear: bool, add: &dyn Fn(&mut Uses, bool)| {
        let Some(map) = map.as_ref().filter(|map| !leaves_folder(&map.file)) else { return };
        let uses = images.entry(path(map)).or_default();
        uses.encodings.insert(is_linear);
        add(uses, map.wrap()[0] == Wrap::Clamp);
        let user = (format!("material '{name}'"), format!("{keyword} {}", map.file));
        if !uses.users.contains(&user) {
            uses.users.push(user);
        }
    };
    each("map_Kd", diffuse_map, false, &|_, _| {});
    each("map_Ke", emissive_map, false, &|_, _| {});
    each("norm", normal_map, true, &|_, _| {});
    let other = metallic_map.as_ref().map(path);
    each("map_Pr", roughness_map, true, &|uses, clamped| {
        uses.combined.insert((other.clone(), clamped));
    });
    let other = roughness_map.as_ref().map(path);
    each("map_Pm", metallic_map, true, &|uses, clamped| {
        uses.combined.insert((other.clone(), clamped));
    });
    each("map_d", dissolve_map, false, &|uses, clamped| {
        uses.alphas.insert(clamped);
    });
}

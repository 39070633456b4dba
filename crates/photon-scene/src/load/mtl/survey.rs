//! Which images the materials of MTL files use, before any is decoded: under a limit on memory, all are planned together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use photon_core::Wrap;

use super::map::Map;
use super::{Entry, Library};
use crate::load::budget::{Budget, Shortage};
use crate::load::gltf::leaves_folder;
use crate::load::image::{Header, ImageError, Plan, Wanted};

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

/// What was found of the images.
#[derive(Default)]
pub(super) struct Survey {
    /// How often images are halved.
    pub(super) plan: Plan,
    /// The place of each path in it.
    pub(super) planned: BTreeMap<PathBuf, usize>,
    /// Images that are not decoded under a limit on memory, and why.
    pub(super) refused: BTreeMap<PathBuf, ImageError>,
    /// Images of `map_Kd` whose alpha is in use, since they are the `map_d` of the same material.
    pub(super) covering: BTreeSet<PathBuf>,
}

/// Plans the sizes of all images if memory is limited.
pub(super) fn plan(library: &Library, budget: &Budget) -> Result<Survey, Shortage> {
    let covering = library.entries.iter().filter_map(covering).collect();
    let Some(left) = budget.left() else { return Ok(Survey { covering, ..Survey::default() }) };
    let mut images: BTreeMap<PathBuf, Uses> = BTreeMap::new();
    for material in &library.entries {
        record(material, &mut images);
    }
    let (mut wanted, mut planned, mut refused) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
    for (path, uses) in images {
        // One that does not exist is reported by the material that uses it.
        let (header, file) = match Header::of_file(&path, left) {
            None => continue,
            Some(Ok(found)) => found,
            Some(Err(why)) => {
                refused.insert(path, why);
                continue;
            }
        };
        planned.insert(path, wanted.len());
        let [encodings, copies, made] =
            [uses.encodings.len(), uses.alphas.len(), uses.combined.len()].map(|count| count as u64);
        wanted.push(Wanted { header, file, encodings, copies, made, users: uses.users });
    }
    Ok(Survey { plan: Plan::new(wanted, 0, budget)?, planned, refused, covering })
}

/// The path of the image that is both the colour and the alpha of a material.
fn covering(material: &Entry) -> Option<PathBuf> {
    let (color, alpha) = (material.diffuse_map.as_ref()?, material.dissolve_map.as_ref()?);
    (color.file == alpha.file).then(|| material.folder.join(&color.file))
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

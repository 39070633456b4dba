//! The text of an override file to begin with: it names everything that can be changed, and changes nothing.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::overrides::Overrides;
use crate::builder::SceneBuilder;
use crate::describe::{AlphaMode, AmbientMedium, CameraDesc, Dispersion, MaterialDesc, PhaseDesc, Projection};
use crate::parameter::{self, Kind, Value};

/// Before the materials.
const HEAD: &str = "\
# Overrides. Nothing in this file changes the scene until the # in front of a line is removed.
# docs/scene-files.md lists all keys. Values of kind: \"lambert\" (diffuse), \"glossy\" (metal, plastic), \"mirror\",
# \"glass\" (a solid), \"boundary\" (of mist or smoke), \"thin\" (a pane).

# For glTF files exported by Blender with the lighting mode Standard, its default:
# light_units = \"standard\"
";

/// After the materials. Lengths are relative to the scene, which may be given in metres or in millimetres.
const TAIL: &str = "
# A square above the scene that shines downwards:
# [[lights]]
# type = \"quad\"
# relative = true
# corner = [-0.25, 1.0, -0.25]
# edges = [[0.5, 0.0, 0.0], [0.0, 0.0, 0.5]]
# radiance = 10.0

# A clear sky:
# [environment]
# sky = { elevation = 30.0, turbidity = 3.0 }
";

impl Overrides {
    /// The text of an override file with the materials and cameras of a scene and their values, and examples of lights, all
    /// commented out: applied as it is, it changes nothing.
    #[must_use]
    pub fn starter(scene: &SceneBuilder) -> String {
        let mut text = HEAD.to_owned();
        let mut found: BTreeMap<&str, (&MaterialDesc, usize)> = BTreeMap::new();
        for material in &scene.materials {
            found.entry(&material.name).or_insert((material, 0)).1 += 1;
        }
        for (name, (material, count)) in found {
            text += &format!("\n[materials.{}]\n", quoted(name));
            if count > 1 {
                text += &format!("# {count} materials have this name; the values are those of the first.\n");
            }
            for (key, value, texture) in entries(material) {
                let replaces = if texture { "  # in place of its texture" } else { "" };
                text += &format!("# {key} = {value}{replaces}\n");
            }
        }
        text += &floor(scene);
        text += TAIL;
        text += &medium(scene);
        for (name, camera) in &scene.cameras {
            text += &camera_text(name, camera);
        }
        text
    }
}

/// The ambient medium, or mist as an example.
fn medium(scene: &SceneBuilder) -> String {
    let example = || {
        let (low, high) = scene.bounds().unwrap_or_default();
        let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        // Two fifths of the light are scattered along the scene.
        let scattering = if extent > 0.0 { 0.5 / extent } else { 0.5 };
        AmbientMedium::new([scattering; 3], [0.0; 3])
    };
    let medium = scene.medium.unwrap_or_else(example);
    // Light from infinity needs bounds.
    let around = scene.bounds().filter(|(low, high)| (0..3).all(|axis| low[axis] < high[axis]));
    let bounds = medium.bounds.or_else(|| around.map(|(low, high)| [low, high]));
    let bounds = bounds.map_or_else(String::new, |corners| format!("# box = {corners:?}\n"));
    let mut text = format!(
        "\n# A medium in a box, or without one everywhere, where no light from infinity arrives.\n# [medium]\n# scattering = \
         {}\n# absorption = {}\n{bounds}",
        color(medium.scattering),
        color(medium.absorption)
    );
    phase(medium.phase).into_iter().for_each(|(key, value)| text += &format!("# {key} = {value}\n"));
    text
}

/// The keys of a phase function, and their values.
fn phase(phase: PhaseDesc) -> Vec<(&'static str, String)> {
    let name = ("phase", format!("\"{}\"", phase.name()));
    match phase {
        PhaseDesc::HenyeyGreenstein { anisotropy } => vec![("anisotropy", number(anisotropy))],
        PhaseDesc::Rayleigh => vec![name],
        PhaseDesc::Mie { droplet_micrometres } => vec![name, ("droplet_micrometres", number(droplet_micrometres))],
    }
}

/// The keys of a material, their values, and whether the key would replace a texture.
fn entries(desc: &MaterialDesc) -> Vec<(&'static str, String, bool)> {
    let kind = Kind::of(&desc.surface);
    let mut list = vec![("kind", format!("\"{}\"", kind.name()), false)];
    for (parameter, value) in parameter::values(desc) {
        let is_textured = parameter.is_textured(desc);
        if is_textured || parameter.is_present(desc) {
            let text = match parameter.in_degrees(value) {
                Value::Number(value) => number(value),
                Value::Color(value) => color(value),
            };
            list.push((parameter.key, text, is_textured));
        }
    }
    let inside = desc.transmission_absorption.filter(|_| desc.transmission > 0.0);
    if let Some(absorption) = inside {
        list.push(("absorption", color(absorption), false));
    }
    if inside.is_some() || matches!(kind, Kind::Glass | Kind::Boundary) {
        list.push(("priority", desc.priority.to_string(), false));
    }
    if desc.phase != PhaseDesc::default() {
        list.extend(phase(desc.phase).into_iter().map(|(key, value)| (key, value, false)));
    }
    if let Some(dispersion) = desc.dispersion {
        list.push((dispersion.name(), dispersion_text(dispersion), false));
    }
    if desc.alpha_mode != AlphaMode::Opaque {
        list.push(("alpha", number(desc.alpha), desc.textures.alpha.is_some()));
    }
    if !desc.is_boundary() {
        list.push(("emission", color(desc.emission), desc.textures.emission.is_some()));
    }
    if desc.is_emissive() {
        list.push(("emits_both_sides", desc.emits_both_sides.to_string(), false));
    }
    list
}

/// A floor that the scene stands on, three times as wide.
fn floor(scene: &SceneBuilder) -> String {
    let Some((low, high)) = scene.bounds() else { return String::new() };
    let size = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let side = |axis: usize, sign: f64| number(rounded(0.5 * (low[axis] + high[axis]) + sign * 1.5 * size));
    let width = number(rounded(3.0 * size));
    format!(
        "\n# A floor that the scene stands on, for shadows and caustics:\n\
         # [materials.floor]\n# new = true\n# albedo = 0.6\n\
         # [[quads]]\n# material = \"floor\"\n\
         # corner = [{}, {}, {}]\n# edges = [[{width}, 0.0, 0.0], [0.0, 0.0, -{width}]]\n",
        side(0, -1.0),
        number(low[1]),
        side(2, 1.0)
    )
}

/// The number to four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

fn camera_text(name: &str, camera: &CameraDesc) -> String {
    let CameraDesc { position, direction, up, projection, lens } = camera;
    let to: [f64; 3] = std::array::from_fn(|axis| position[axis] + direction[axis]);
    let mut text = format!("\n# [[cameras]]\n# name = {}\n", quoted(name));
    for (key, value) in [("from", position), ("to", &to), ("up", up)] {
        let _ = writeln!(text, "# {key} = {}", triple(*value));
    }
    let _ = match projection {
        Projection::Perspective { vertical_fov } => {
            writeln!(text, "# fov_degrees = {}", number(vertical_fov.to_degrees()))
        }
        Projection::Orthographic { half_height } => writeln!(text, "# half_height = {}", number(*half_height)),
    };
    if let Some(lens) = lens {
        let (diameter, distance) = (number(lens.diameter), number(lens.focus_distance));
        let _ = writeln!(text, "# aperture = {diameter}\n# focus = {distance}");
    }
    text
}

/// A string of TOML on one line.
fn quoted(text: &str) -> String {
    let mut quoted = "\"".to_owned();
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            _ if c.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(c));
            }
            _ => quoted.push(c),
        }
    }
    quoted + "\""
}

/// One number if all channels are equal.
fn color(value: [f64; 3]) -> String {
    if value == [value[0]; 3] { number(value[0]) } else { triple(value) }
}

fn triple(value: [f64; 3]) -> String {
    format!("[{}]", value.map(number).join(", "))
}

fn dispersion_text(dispersion: Dispersion) -> String {
    let list =
        |numbers: &[f64]| format!("[{}]", numbers.iter().map(|&value| number(value)).collect::<Vec<_>>().join(", "));
    match dispersion {
        Dispersion::Abbe(abbe) => number(abbe),
        Dispersion::Cauchy(terms) => list(&terms),
        Dispersion::Sellmeier(terms) => list(&terms),
    }
}

/// The shortest number that is read as the same.
fn number(value: f64) -> String {
    format!("{value:?}").to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::{builtin, builtin_names};
    use crate::describe::ThinLens;
    use crate::report::LoadReport;
    use std::path::Path;

    fn applied(text: &str, scene: &SceneBuilder) -> SceneBuilder {
        let mut scene = scene.clone();
        let overrides = Overrides::parse(text, Path::new("starter.toml")).expect(text);
        overrides.apply(&mut scene, &mut LoadReport::default()).expect(text);
        scene
    }

    /// The text with all keys and tables, without the examples that add something and the values that replace a texture.
    fn with_all_values(text: &str) -> String {
        let values = text
            .split("\n# A floor")
            .next()
            .expect("materials")
            .split("\n# A square")
            .next()
            .expect("materials")
            .lines();
        let cameras = text.find("\n# [[cameras]]").map_or("", |at| &text[at..]).lines();
        let uncommented = |line: &str| match line.strip_prefix("# ") {
            Some(entry) if entry.starts_with("light_units") || entry.contains("# in place") => String::new(),
            Some(entry) if entry.contains(" = ") || entry.starts_with('[') => format!("{entry}\n"),
            Some(_) => String::new(),
            None => format!("{line}\n"),
        };
        values.chain(cameras).map(uncommented).collect()
    }

    /// Degrees are converted twice.
    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 4.0 * f64::EPSILON * b.abs()
    }

    /// Of all materials and cameras of the built-in scenes, and of kinds that they lack. A value that replaces a texture
    /// without saying so fails.
    #[test]
    fn its_values_are_those_of_the_scene() {
        let mut scenes: Vec<SceneBuilder> =
            builtin_names().iter().map(|(name, _)| builtin(name).expect("listed")).collect();
        let mut other = SceneBuilder::new();
        let glossy = MaterialDesc::plastic("lacquer \"№ 1\" \\ \n", [0.1, 0.2, 0.7], 0.3)
            .with_clearcoat(0.5, 0.1)
            .with_sheen([0.25, 0.5, 1.0], 0.7)
            .with_specular_color([1.0, 0.5, 0.25])
            .with_anisotropy(0.5, 30.0_f64.to_radians())
            .with_diffuse_transmission(0.25, [0.5, 1.0, 0.5])
            .with_transmission(0.75, Some([0.0, 0.5, 2.0]))
            .with_dispersion(Dispersion::Abbe(31.5))
            .with_priority(3);
        other.material(glossy);
        other.material(MaterialDesc::glass("wax", 1.4).with_scattering([1.0, 2.0, 0.0], -0.5));
        other.material(MaterialDesc::glass("haze", 1.0).with_scattering([1.0; 3], PhaseDesc::Rayleigh));
        let mist = PhaseDesc::Mie { droplet_micrometres: 20.0 };
        other.material(MaterialDesc::boundary("mist", [0.5; 3]).with_scattering([1.0; 3], mist));
        other.material(MaterialDesc::glass("flint", 1.5).with_dispersion(Dispersion::Cauchy([1.6, 0.02])));
        let terms = [1.039_612_12, 0.231_792_344, 1.010_469_45, 0.006_000_698_67, 0.020_017_914_4, 103.560_653];
        other.material(MaterialDesc::glass("crown", 1.5).with_dispersion(Dispersion::Sellmeier(terms)));
        other.material(MaterialDesc::lambert("veil", [1e-7, 0.0, 1.0]).with_alpha(AlphaMode::Blend, 0.5));
        other.material(MaterialDesc::thin("", 1.3));
        other.material(MaterialDesc::mirror("tab\t\u{7f}", [0.9, 0.8, 0.7]).with_both_sides(true));
        let camera = CameraDesc::look_at([1.0, 2.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0], 0.5);
        other.camera("lens", camera.clone().with_lens(ThinLens::new(0.1, 4.0)));
        other.camera("flat", camera.with_projection(Projection::Orthographic { half_height: 2.5 }));
        scenes.push(other);
        for mut scene in scenes {
            // Those of one name share the values of the first.
            for (index, material) in scene.materials.iter_mut().enumerate() {
                material.name += &format!("{index}");
            }
            let text = Overrides::starter(&scene);
            let result = applied(&with_all_values(&text), &scene);
            for (found, given) in result.materials.iter().zip(&scene.materials) {
                assert!(close(found.anisotropy_rotation, given.anisotropy_rotation), "{text}");
                let found = MaterialDesc { anisotropy_rotation: given.anisotropy_rotation, ..found.clone() };
                assert_eq!((&found, text.contains("[materials.")), (given, true), "{text}");
            }
            assert_eq!(result.materials.len(), scene.materials.len());
            assert_eq!(result.cameras.len(), 2 * scene.cameras.len(), "{text}");
            for ((name, found), (known, given)) in result.cameras.iter().zip(&scene.cameras) {
                assert_eq!((name, found.position, found.up, found.lens), (known, given.position, given.up, given.lens));
                match (found.projection, given.projection) {
                    (Projection::Perspective { vertical_fov }, Projection::Perspective { vertical_fov: other }) => {
                        assert!(close(vertical_fov, other))
                    }
                    (found, given) => assert_eq!(found, given),
                }
            }
        }
    }

    #[test]
    fn as_it_is_it_changes_nothing() {
        for (name, _) in builtin_names() {
            let scene = builtin(name).expect("listed");
            let result = applied(&Overrides::starter(&scene), &scene);
            assert_eq!((&result.materials, result.medium), (&scene.materials, scene.medium), "{name}");
            assert_eq!((&result.lights, &result.cameras), (&scene.lights, &scene.cameras), "{name}");
            assert_eq!(result.meshes.len(), scene.meshes.len(), "{name}");
        }
    }

    /// The examples are valid, and shine downwards.
    #[test]
    fn its_examples_work() {
        let scene = builtin("cornell").expect("listed");
        let floor = floor(&scene);
        let text: String = (floor + TAIL)
            .lines()
            .filter_map(|line| line.strip_prefix("# "))
            .filter(|line| !line.ends_with(':'))
            .fold(String::new(), |text, line| text + line + "\n");
        let result = applied(&text, &scene);
        assert!(result.environment.is_some());
        let mesh = result.meshes.last().expect("a quad");
        let [a, b, c] = mesh.triangles[0].map(|index| glam::DVec3::from(mesh.positions[index as usize]));
        assert!((b - a).cross(c - a).normalize_or_zero().distance(glam::DVec3::NEG_Y) < 1e-12);
        assert_eq!(mesh.positions.len(), 4);
        // The floor shines back, and the scene stands on it.
        let (floor, count) = (&result.meshes[scene.meshes.len()], scene.meshes.len());
        assert_eq!((floor.material.0 as usize, result.meshes.len()), (scene.materials.len(), count + 2));
        let (low, _) = scene.bounds().expect("a room");
        assert!(floor.positions.iter().all(|at| at[1] == low[1]), "{:?}", floor.positions);
        let [a, b, c] = floor.triangles[0].map(|index| glam::DVec3::from(floor.positions[index as usize]));
        assert!((b - a).cross(c - a).normalize_or_zero().distance(glam::DVec3::Y) < 1e-12);
    }

    #[test]
    fn materials_of_one_name_are_listed_once() {
        let mut scene = SceneBuilder::new();
        for albedo in [0.25, 0.75] {
            scene.material(MaterialDesc::lambert("twin", [albedo; 3]));
        }
        let text = Overrides::starter(&scene);
        assert_eq!(text.matches("[materials.\"twin\"]").count(), 1);
        assert!(text.contains("# 2 materials have this name") && text.contains("# albedo = 0.25\n"), "{text}");
    }
}

//! `photonmap export`

use std::path::Path;

use crate::support::{channels, folder, refused, render, run, stderr, succeeded};

/// A file with a scene of all materials and lights, in coordinates that single precision cannot represent.
const OVERRIDES: &str = r#"
[materials.white]
albedo = [0.123456789012345, 0.7, 0.3]
[materials.amber]
new = true
kind = "glass"
ior = 1.234567890123
absorption = [0.1, 2.3, 4.5]
tint = [0.9, 0.95, 1.0]
priority = 2
[materials.pane]
new = true
kind = "thin"
ior = 1.4
tint = [0.5, 0.6, 0.7]
[materials.mirror]
new = true
kind = "mirror"
albedo = [0.9, 0.8, 0.7]
[materials.brass]
new = true
kind = "glossy"
albedo = [0.9, 0.7, 0.333333333333333]
metallic = 1
roughness = 0.333333333333333
[materials.varnish]
new = true
kind = "glossy"
albedo = [0.4, 0.2, 0.1]
roughness = 0.123456789012345
specular = 0.777777777777777
ior = 1.456789012345678
[materials.film]
new = true
kind = "glossy"
albedo = [0.4, 0.2, 0.1]
roughness = 0.423456789012345
transmission = 0.333333333333333
ior = 1.456789012345678
[materials.glow]
new = true
emission = 1.7
emits_both_sides = true
[[quads]]
corner = [-0.3, 0.3333333333333333, 0.2]
edges = [[0.6, 0, 0], [0, 0.1, 0]]
material = "pane"
[[quads]]
corner = [-0.7, 0.1, -0.7]
edges = [[0.2, 0, 0], [0, 0.3, 0.1]]
material = "mirror"
[[quads]]
corner = [-0.4, 0.1, 0.4]
edges = [[0.3, 0, 0], [0, 0.2, 0.1]]
material = "brass"
[[quads]]
corner = [0.1, 0.1, 0.4]
edges = [[0.3, 0, 0], [0, 0.2, 0.1]]
material = "varnish"
[[quads]]
corner = [0.4, 0.1, 0.1]
edges = [[0.1, 0, 0], [0, 0.2, 0.1]]
material = "glow"
[[quads]]
corner = [-0.2, 0.4, 0.5]
edges = [[0.4, 0, 0], [0, 0.3, 0.1]]
material = "film"
[[lights]]
type = "point"
position = [0.1, 0.7, 0.2]
intensity = [1.1, 0.3, 0.7]
[[lights]]
type = "spot"
position = [0.0, 0.9, 0.0]
direction = [0.1, -1.3, 0.2]
intensity = 3.3
inner_degrees = 10.1
outer_degrees = 33.3
[[lights]]
type = "directional"
direction = [0.3, -1, -0.4]
irradiance = [0.2, 0.3, 0.4]
[[cameras]]
name = "own"
from = [0.1, 0.8, 2.7]
to = [0.0, 0.7, 0.0]
up = [0.1, 1, 0]
fov_degrees = 47.3
"#;

/// Renders the scene directly and by way of a .glb: all channels are equal.
fn both(folder: &Path, scene: &[&str], name: &str) -> [std::collections::BTreeMap<String, Vec<f32>>; 2] {
    let file = folder.join(format!("{name}.glb"));
    let file = file.to_str().unwrap();
    let output = run("export", &[scene, &["-o", file]].concat());
    succeeded(&output);
    assert!(stderr(&output).contains(&format!("wrote {file}")), "{output:?}");
    let picture = |scene: &[&str], name: &str| {
        let path = folder.join(name);
        let small = ["--size", "20x16", "--photons", "3000", "--passes", "2", "--backend", "cpu"];
        succeeded(&render(&[scene, &small, &["-o", path.to_str().unwrap()]].concat()));
        channels(&path)
    };
    // Nothing is approximated, even what single precision cannot represent.
    [picture(scene, "own.exr"), picture(&[file, "--strict"], "again.exr")]
}

#[test]
fn a_reloaded_scene_gives_the_same_picture_bit_for_bit() {
    let folder = folder("export-glb");
    let overrides = folder.join("all.toml");
    std::fs::write(&overrides, OVERRIDES).unwrap();
    let everything = ["cornell", "--overrides", overrides.to_str().unwrap()];
    let scenes: [&[&str]; 5] = [&["cornell-glass"], &["ring"], &["pool"], &["gloss"], &everything];
    let mut others = Vec::new();
    for (number, scene) in scenes.into_iter().enumerate() {
        let [own, again] = both(&folder, scene, &number.to_string());
        let bits = |all: &std::collections::BTreeMap<String, Vec<f32>>| -> Vec<(String, Vec<u32>)> {
            all.iter().map(|(name, values)| (name.clone(), values.iter().map(|v| v.to_bits()).collect())).collect()
        };
        assert!(own["R"].iter().any(|&v| v > 0.0));
        assert!(bits(&own) == bits(&again), "{scene:?}");
        // The comparison distinguishes different pictures.
        assert!(others.iter().all(|other| *other != bits(&own)));
        others.push(bits(&own));
    }
}

/// What Mitsuba reads: all triangles, lights with their strength, and a camera.
#[test]
fn mitsubas_file_is_complete() {
    let folder = folder("export-xml");
    let file = folder.join("ring.xml");
    let output = run("export", &["ring", "--size", "48x32", "-o", file.to_str().unwrap()]);
    succeeded(&output);
    let text = std::fs::read_to_string(&file).unwrap();
    for part in ["<scene version=\"3.0.0\">", "type=\"spot\"", "type=\"perspective\"", "value=\"48\"", "</scene>"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let mut triangles = 0;
    for name in text.split("name=\"filename\" value=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let header = String::from_utf8_lossy(&bytes[..bytes.len().min(300)]).into_owned();
        let line = header.lines().find(|line| line.starts_with("element face ")).unwrap();
        triangles += line.trim_start_matches("element face ").parse::<usize>().unwrap();
    }
    let explained = String::from_utf8(run("explain", &["ring"]).stdout).unwrap();
    assert!(explained.contains(&format!("ring: {triangles} triangles")), "{triangles}: {explained}");
    let lens = ["--aperture", "0.1", "--focus", "2", "-o", file.to_str().unwrap()];
    succeeded(&run("export", &[&["ring"][..], &lens].concat()));
    let text = std::fs::read_to_string(&file).unwrap();
    for (name, expected) in [("aperture_radius", 0.05), ("focus_distance", 2.0)] {
        let value = text.split(&format!("\"{name}\" value=\"")).nth(1).and_then(|rest| rest.split('"').next());
        let value: f64 = value.unwrap().parse().unwrap();
        assert!(text.contains("type=\"thinlens\"") && (value - expected).abs() < 1e-6, "{name}: {value}");
    }
    assert!(stderr(&output).contains("spot"), "the falloff is approximated: {output:?}");
}

/// Mitsuba refuses media with `sigma_t` above 1: the coefficient is that times the scale.
#[test]
fn absorption_is_written_for_mitsuba() {
    let folder = folder("export-absorption");
    let (file, overrides) = (folder.join("glass.xml"), folder.join("glass.toml"));
    let text = "[materials.blocks]\nkind = \"glass\"\nabsorption = [0.5, 1, 4]\n";
    std::fs::write(&overrides, text).unwrap();
    let arguments = ["cornell", "--overrides", overrides.to_str().unwrap(), "-o", file.to_str().unwrap()];
    succeeded(&run("export", &arguments));
    let text = std::fs::read_to_string(&file).unwrap();
    let medium = text.split("<medium name=\"interior\" type=\"homogeneous\">").nth(1).expect(&text);
    let value = |name: &str| -> Vec<f64> {
        let list = medium.split(&format!("name=\"{name}\" value=\"")).nth(1).and_then(|rest| rest.split('"').next());
        list.expect(medium).split(", ").map(|number| number.parse().unwrap()).collect()
    };
    assert!(text.contains("type=\"volpath\"") && value("albedo") == [0.0; 3], "{text}");
    let (sigma, scale) = (value("sigma_t"), value("scale")[0]);
    for (found, expected) in sigma.iter().zip([0.5, 1.0, 4.0]) {
        assert!(*found <= 1.0 && (found * scale - expected).abs() < 1e-5, "{sigma:?} times {scale}");
    }
    assert_eq!(sigma.len(), 3);
    for (scene, is_nested) in [("milk", true), ("cornell-glass", false)] {
        let output = run("export", &[scene, "-o", file.to_str().unwrap()]);
        succeeded(&output);
        assert_eq!(stderr(&output).contains("within one another"), is_nested, "{output:?}");
    }
}

/// A share of glass is the weight of the second of two surfaces.
#[test]
fn surfaces_that_are_partly_glass_are_written_for_mitsuba() {
    let folder = folder("export-partly-glass");
    let (file, overrides) = (folder.join("mixed.xml"), folder.join("mixed.toml"));
    let text = "[materials.blocks]\nkind = \"glossy\"\nspecular = 0\nroughness = 0\ntransmission = 0.25\nabsorption = 2\n\
                [materials.white]\nkind = \"glossy\"\nspecular = 0\nroughness = 0\ntransmission = 0.5\n";
    std::fs::write(&overrides, text).unwrap();
    let arguments = ["cornell", "--overrides", overrides.to_str().unwrap(), "-o", file.to_str().unwrap()];
    succeeded(&run("export", &arguments));
    let text = std::fs::read_to_string(&file).unwrap();
    for (weight, glass) in [("0.25", "dielectric"), ("0.5", "thindielectric")] {
        let found = text.split(&format!("<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"{weight}\"/>")).nth(1);
        let shape = found.and_then(|rest| rest.split("</shape>").next()).expect(&text);
        let (first, second) = shape.split_once("</bsdf></bsdf>").expect(shape);
        assert!(first.starts_with("<bsdf type=\"twosided\"><bsdf type=\"diffuse\">"), "{first}");
        assert!(second.starts_with(&format!("<bsdf type=\"{glass}\">")), "{second}");
        assert_eq!(second.contains("<medium name=\"interior\""), glass == "dielectric", "{second}");
    }
}

/// Rough metals have the width of their distribution, and a warning where multiple scattering matters.
#[test]
fn rough_metals_are_written_for_mitsuba() {
    let folder = folder("export-metal");
    let (file, overrides) = (folder.join("metal.xml"), folder.join("metal.toml"));
    let export = |roughness: f64| {
        let text = format!(
            "[materials.white]\nkind = \"glossy\"\nalbedo = [0.5, 0.25, 1]\nmetallic = 1\nroughness = {roughness}\n"
        );
        std::fs::write(&overrides, text).unwrap();
        let arguments = ["cornell", "--overrides", overrides.to_str().unwrap(), "-o", file.to_str().unwrap()];
        let output = run("export", &arguments);
        succeeded(&output);
        (std::fs::read_to_string(&file).unwrap(), stderr(&output))
    };
    let (text, warnings) = export(0.5);
    assert!(text.contains("type=\"roughconductor\"") && text.contains("value=\"ggx\""), "{text}");
    assert!(text.contains("<float name=\"alpha\" value=\"0.25\"/>") && text.contains("<rgb name=\"eta\""), "{text}");
    assert!(warnings.contains("material 'white' has no multiple scattering in Mitsuba"), "{warnings}");
    assert!(warnings.contains("material 'white' reflects by the Fresnel equations"), "{warnings}");
    let (text, warnings) = export(0.25);
    assert!(text.contains("<float name=\"alpha\" value=\"0.0625\"/>"), "{text}");
    assert!(!warnings.contains("multiple scattering"), "{warnings}");
    let (text, warnings) = export(0.0);
    assert!(text.contains("type=\"conductor\"><rgb name=\"eta\"") && !text.contains("roughconductor"), "{text}");
    assert!(warnings.contains("material 'white' reflects by the Fresnel equations"), "{warnings}");
}

#[test]
fn what_cannot_be_exported_is_named() {
    let folder = folder("export-bad");
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let glow = path("glow.toml");
    std::fs::write(&glow, "[materials.white]\nemission = 1.0\nemits_both_sides = true\n").unwrap();
    let far = path("far.toml");
    let light = "[[lights]]\ntype = \"point\"\nposition = [0, 0, 0]\nintensity = 1e60\n";
    std::fs::write(&far, light).unwrap();
    let shaded = |name: &str, text: &str| {
        std::fs::write(path(name), text).unwrap();
        path(name)
    };
    let colors = shaded("colors.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
    let normals = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0.1 0 1\nvn 0 0.1 1\nvn 0 0 1\nf 1//1 2//2 3//3\n";
    let normals = shaded("normals.obj", normals);
    let (glb, xml, nowhere) = (path("a.glb"), path("a.xml"), path("no/such/a.glb"));
    let coat = shaded("coat.toml", "[materials.white]\nkind = \"glossy\"\nmetallic = 0.5\n");
    let cases: [(&[&str], &str); 11] = [
        (&["no-such-scene", "-o", &glb], "no-such-scene"),
        (&["ring", "-o", "a.obj"], "a.obj"),
        (&["ring", "-o", &nowhere], "no/such"),
        (&["ring"], "--output"),
        (&["ring", "--size", "0x0", "-o", &xml], "0x0"),
        (&["cornell", "--overrides", &glow, "-o", &xml], "both sides"),
        (&["cornell", "--overrides", &coat, "-o", &xml], "material 'white' has a glossy coat"),
        (&["gloss", "-o", &xml], "the base colour texture of material 'tiles'"),
        (&[&colors, "-o", &xml], "vertex colours cannot be written for Mitsuba"),
        (&[&normals, "-o", &xml], "vertex normals cannot be written for Mitsuba"),
        (&["cornell", "--overrides", &far, "-o", &glb], "override light 0"),
    ];
    for (arguments, culprit) in cases {
        refused(&run("export", arguments), culprit);
    }
}

/// Media around solids and within, per unit of length, with their phase functions.
#[test]
fn media_are_written_for_mitsuba() {
    let folder = folder("export-media");
    let overrides = folder.join("fog.toml");
    let media = "[medium]\nscattering = [0.3, 0.15, 0]\nabsorption = [0.1, 0.05, 0.4]\nanisotropy = 0.5\n\
                 [materials.glass]\nkind = \"boundary\"\nscattering = 2\nabsorption = 6\nphase = \"rayleigh\"\n";
    std::fs::write(&overrides, media).unwrap();
    let file = folder.join("fog.xml");
    succeeded(&run(
        "export",
        &["cornell-glass", "--overrides", overrides.to_str().unwrap(), "-o", file.to_str().unwrap()],
    ));
    let text = std::fs::read_to_string(&file).unwrap();
    let numbers = |medium: &str, name: &str| -> Vec<f64> {
        let (_, rest) = text.split_once(&format!("<medium {medium} type=\"homogeneous\">")).expect(medium);
        let (_, rest) = rest.split_once(&format!("name=\"{name}\" value=\"")).expect(name);
        rest.split_once('"').unwrap().0.split(", ").map(|number| number.parse().unwrap()).collect()
    };
    for (medium, extinction, albedo) in
        [("id=\"ambient\"", [0.4, 0.2, 0.4], [0.75, 0.75, 0.0]), ("name=\"interior\"", [8.0; 3], [0.25; 3])]
    {
        let (sigma, scale, found) =
            (numbers(medium, "sigma_t"), numbers(medium, "scale")[0], numbers(medium, "albedo"));
        for channel in 0..3 {
            assert!((sigma[channel] * scale - extinction[channel]).abs() < 1e-6, "{medium}: {sigma:?} {scale}");
            assert!((found[channel] - albedo[channel]).abs() < 1e-6, "{medium}: {found:?}");
        }
    }
    // The sensor and the ball are in fog.
    for (part, count) in [
        ("<ref id=\"ambient\"/>", 1),
        ("<ref name=\"exterior\" id=\"ambient\"/>", 1),
        ("<phase type=\"hg\"><float name=\"g\" value=\"0.5\"/></phase>", 1),
        ("<phase type=\"rayleigh\"/>", 1),
        ("<phase", 2),
        ("<bsdf type=\"null\"/>", 1),
        ("type=\"volpathmis\"", 1),
    ] {
        assert_eq!(text.matches(part).count(), count, "{part}: {text}");
    }
    // Droplets are a narrow lobe and a table: with steps of 1/512 in the cosine, its integral over the sphere is 1.
    std::fs::write(&overrides, "[medium]\nscattering = 1\nphase = \"mie\"\ndroplet_micrometres = 10\n").unwrap();
    let file = folder.join("mie.xml");
    succeeded(&run(
        "export",
        &["cornell-glass", "--overrides", overrides.to_str().unwrap(), "-o", file.to_str().unwrap()],
    ));
    let text = std::fs::read_to_string(&file).unwrap();
    for lobe in ["name=\"weight\" value=\"0.4819", "name=\"g\" value=\"0.9881"] {
        assert_eq!(text.matches(lobe).count(), 1, "{lobe}");
    }
    let (_, table) = text.split_once("tabphase\"><string name=\"values\" value=\"").unwrap();
    let table = table.split_once('"').unwrap().0.split(", ").map(|value| value.parse().unwrap());
    let table: Vec<f64> = table.collect();
    let ends = 0.5 * (table[0] + table[table.len() - 1]);
    let sum = (table.iter().sum::<f64>() - ends) * 2.0 * std::f64::consts::PI / 512.0;
    assert!(table.len() == 1025 && (sum - 1.0).abs() < 1e-4, "{sum}");
}

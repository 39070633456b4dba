//! Every error of the builder names the object at fault, its value and a hint.

use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, SceneError, Surface, ThinLens};

const FLOOR: [[f64; 3]; 4] = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]];

/// A floor and whatever `add` adds to it.
fn build(add: impl FnOnce(&mut SceneBuilder)) -> Result<photon_scene::Scene, SceneError> {
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [0.5; 3]));
    builder.quad("floor", FLOOR, white);
    add(&mut builder);
    builder.build()
}

/// The error that the builder reports for it.
fn fault(add: impl FnOnce(&mut SceneBuilder)) -> String {
    build(add).map(drop).expect_err("a fault").to_string()
}

fn names(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{message}' does not say '{part}'");
    }
}

#[test]
fn nothing_added_is_no_fault() {
    assert!(build(|_| ()).is_ok());
}

#[test]
fn materials() {
    let material = |desc: MaterialDesc| {
        fault(|builder| {
            builder.material(desc);
        })
    };
    names(
        &material(MaterialDesc::lambert("paint", [0.5, 2.0, 0.5])),
        &["material 'paint'", "albedo", "2.0", "between 0 and 1"],
    );
    names(&material(MaterialDesc::lambert("paint", [0.5, f64::NAN, 0.5])), &["'paint'", "albedo", "NaN"]);
    names(&material(MaterialDesc::mirror("foil", [-0.1, 0.0, 0.0])), &["'foil'", "reflectance", "-0.1"]);
    for ior in [0.0, -1.5, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
        names(&material(MaterialDesc::glass("pane", ior)), &["'pane'", "ior", &format!("{ior:?}"), "above 0"]);
        names(&material(MaterialDesc::thin("pane", ior)), &["'pane'", "ior"]);
    }
    let glass =
        |absorption, tint| MaterialDesc::new("ink", Surface::Dielectric { ior: 1.3, absorption, tint, roughness: 0.0 });
    names(&material(glass([0.0, -1.0, 0.0], [1.0; 3])), &["'ink'", "absorption", "-1.0", "at least 0"]);
    names(&material(glass([f64::INFINITY; 3], [1.0; 3])), &["'ink'", "absorption", "inf"]);
    names(&material(glass([0.0; 3], [1.1; 3])), &["'ink'", "tint", "1.1"]);
    let brass = |base_color, metallic, roughness, specular, ior| {
        let surface = Surface::Glossy { base_color, metallic, roughness, specular, ior };
        material(MaterialDesc::new("brass", surface))
    };
    names(&brass([0.5, 1.5, 0.5], 1.0, 0.5, 1.0, 1.5), &["'brass'", "base_color", "1.5"]);
    for bad in [-0.1, 1.1, f64::NAN] {
        let shown = format!("{bad:?}");
        names(&brass([0.5; 3], bad, 0.5, 1.0, 1.5), &["'brass'", "metallic", &shown, "between 0 and 1"]);
        names(&brass([0.5; 3], 1.0, bad, 1.0, 1.5), &["'brass'", "roughness", &shown, "between 0 and 1"]);
        names(&brass([0.5; 3], 1.0, 0.5, bad, 1.5), &["'brass'", "specular", &shown, "between 0 and 1"]);
    }
    for ior in [-0.1, f64::NAN, f64::INFINITY, 1e300] {
        names(&brass([0.5; 3], 1.0, 0.5, 1.0, ior), &["'brass'", "ior", &format!("{ior:?}"), "finite and at least 0"]);
    }
    for emission in [-1.0, f64::NAN, f64::INFINITY] {
        let area_light = MaterialDesc::emissive("light", [0.0; 3], [emission; 3]);
        names(&material(area_light), &["'light'", "emission", "finite"]);
    }
}

#[test]
fn meshes() {
    let mesh = |positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>| {
        fault(|builder| {
            let red = builder.material(MaterialDesc::lambert("red", [0.5; 3]));
            builder.mesh("teapot", positions, triangles, red);
        })
    };
    let corners = || vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    names(&mesh(corners(), vec![[0, 1, 2], [0, 1, 3]]), &["mesh 'teapot'", "triangle 1", "vertex 3", "there are 3"]);
    names(&mesh(Vec::new(), vec![[0, 0, 0]]), &["'teapot'", "there are 0"]);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut positions = corners();
        positions[2][1] = bad;
        names(&mesh(positions, vec![[0, 1, 2]]), &["'teapot'", "vertex 2", &format!("{bad:?}"), "finite"]);
        // One that no triangle uses may be anything.
        let unused = |builder: &mut SceneBuilder| {
            let red = builder.material(MaterialDesc::lambert("red", [0.5; 3]));
            let positions = corners().into_iter().chain([[bad, 0.0, f64::MAX]]).collect();
            builder.mesh("teapot", positions, vec![[0, 1, 2]], red);
        };
        assert!(build(unused).is_ok_and(|scene| scene.view().positions.len() == 7));
        let mut builder = SceneBuilder::new();
        unused(&mut builder);
        assert!(photon_scene::glb(&builder).is_ok());
    }
    let huge = vec![[-1.7e308; 3], [1.7e308; 3], [0.0; 3]];
    names(&mesh(huge, vec![[0, 1, 2]]), &["extent", "unit of length"]);
    let foreign = fault(|builder| {
        let mut other = SceneBuilder::new();
        let ids: Vec<_> = (0..3).map(|_| other.material(MaterialDesc::lambert("x", [0.0; 3]))).collect();
        builder.quad("alien", FLOOR, ids[2]);
    });
    names(&foreign, &["'alien'", "material number 2", "1 of this builder"]);
    let flat = fault(|builder| {
        let area_light = builder.material(MaterialDesc::emissive("glow", [0.0; 3], [1.0; 3]));
        builder.mesh("light", vec![[0.0; 3], [1.0; 3], [2.0; 3]], vec![[0, 1, 2]], area_light);
    });
    names(&flat, &["'light'", "'glow'", "no area", "point light"]);
    // That a light is far away is not the fault of the others.
    let far = fault(|builder| {
        let area_light = builder.material(MaterialDesc::emissive("glow", [0.5; 3], [1.0; 3]));
        builder.mesh("light", vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]], area_light);
        builder.light("star", LightDesc::Point { position: [1e30, 0.0, 0.0], intensity: [1.0; 3] });
    });
    names(&far, &["the distance of the farthest light", "times the extent", "directional light"]);
}

#[test]
fn lights() {
    let light = |desc: LightDesc| fault(|builder| builder.light("sun", desc));
    let position = [0.0, 1.0, 0.0];
    names(&light(LightDesc::Point { position, intensity: [-1.0; 3] }), &["light 'sun'", "intensity", "-1.0"]);
    names(&light(LightDesc::Point { position: [f64::NAN; 3], intensity: [1.0; 3] }), &["'sun'", "position", "NaN"]);
    let spot = |direction, inner_angle, outer_angle| {
        light(LightDesc::Spot { position, direction, intensity: [1.0; 3], inner_angle, outer_angle })
    };
    let down = [0.0, -1.0, 0.0];
    names(&spot([0.0; 3], 0.1, 0.2), &["'sun'", "direction", "not be zero"]);
    names(&spot([f64::INFINITY; 3], 0.1, 0.2), &["'sun'", "direction", "inf"]);
    for outer in [0.0, -0.1, 1.6, 1e-6, f64::NAN] {
        names(&spot(down, 0.0, outer), &["'sun'", "outer angle", &format!("{outer:?}"), "90 degrees"]);
    }
    for inner in [-0.1, 0.3, f64::NAN] {
        names(&spot(down, inner, 0.2), &["'sun'", "inner angle", &format!("{inner:?}")]);
    }
    let sun = |direction, irradiance| light(LightDesc::Directional { direction, irradiance });
    names(&sun([0.0; 3], [1.0; 3]), &["'sun'", "direction"]);
    names(&sun(down, [f64::INFINITY; 3]), &["'sun'", "irradiance", "inf"]);
    names(&light(LightDesc::Point { position, intensity: [1e308; 3] }), &["power of all lights", "inf"]);
}

#[test]
fn cameras() {
    let camera = |desc: CameraDesc| fault(|builder| builder.camera("eye", desc));
    let look = |to, up, fov| CameraDesc::look_at([0.0, 0.0, 5.0], to, up, fov);
    let (origin, up) = ([0.0; 3], [0.0, 1.0, 0.0]);
    for fov in [0.0, -1.0, std::f64::consts::PI, 7.0, f64::NAN] {
        names(
            &camera(look(origin, up, fov)),
            &["camera 'eye'", "field of view", &format!("{fov:?}"), "between 0 and 180 degrees"],
        );
    }
    names(&camera(look([0.0, 0.0, 5.0], up, 1.0)), &["'eye'", "direction"]);
    names(&camera(look([f64::NAN; 3], up, 1.0)), &["'eye'", "direction", "NaN"]);
    names(&camera(look(origin, [0.0, 0.0, -2.0], 1.0)), &["'eye'", "up", "parallel"]);
    names(&camera(look(origin, [0.0; 3], 1.0)), &["'eye'", "up"]);
    for half_height in [0.0, -1.0, f64::INFINITY] {
        let projection = Projection::Orthographic { half_height };
        names(&camera(look(origin, up, 1.0).with_projection(projection)), &["'eye'", "half the height"]);
    }
    let lens = |diameter, focus_distance| ThinLens::new(diameter, focus_distance);
    for diameter in [-1.0, f64::NAN, f64::INFINITY] {
        let text = camera(look(origin, up, 1.0).with_lens(lens(diameter, 1.0)));
        names(&text, &["'eye'", "diameter of its lens", &format!("{diameter:?}")]);
    }
    for focus in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let text = camera(look(origin, up, 1.0).with_lens(lens(0.1, focus)));
        names(&text, &["'eye'", "distance of its focus", &format!("{focus:?}")]);
    }
    let flat = look(origin, up, 1.0).with_projection(Projection::Orthographic { half_height: 1.0 });
    names(&camera(flat.with_lens(lens(0.1, 1.0))), &["'eye'", "lens", "orthographic"]);
    let scene = build(|builder| builder.camera("eye", look(origin, up, 1.0))).expect("a scene");
    let with = |diameter, focus| scene.camera_with_lens(None, lens(diameter, focus), 1, 1);
    names(&with(0.1, 0.0).expect_err("no focus").to_string(), &["'eye'", "distance of its focus"]);
    names(&with(1e300, 1.0).expect_err("too large").to_string(), &["the lens of camera 'eye'", "1e300"]);
    names(&with(0.1, 1e-300).expect_err("too near").to_string(), &["the lens of camera 'eye'", "1e-300"]);
    let of = |name, width, height| scene.camera(name, width, height).expect_err("a fault").to_string();
    names(&of(Some("ear"), 1, 1), &["'ear'", "cameras are: eye"]);
    names(&of(None, 0, 3), &["0x3", "at least 1"]);
    names(&of(None, u32::MAX, 2), &["2^32"]);
    let blind = build(|_| ()).expect("a scene").camera(Some("eye"), 1, 1).expect_err("no camera").to_string();
    names(&blind, &["no camera", "override file"]);
    let far = CameraDesc::look_at([1e300, 0.0, 0.0], origin, up, 1.0);
    let scene = build(|builder| builder.camera("far", far)).expect("a scene");
    names(&scene.camera(None, 1, 1).expect_err("too far").to_string(), &["'far'", "1e300"]);
}

#[test]
fn frames_of_extreme_directions_are_unit() {
    // Denormal, huge, parallel to the axes or nearly so: the numerics of a camera frame must not depend on that.
    for direction in
        [[0.0, 0.0, 1e-310], [1e300, -1e300, 1e300], [0.0, -1.0, 0.0], [1e-9, -1.0, 1e-12], [5e-324, 0.0, 0.0]]
    {
        let scene = build(|builder| {
            let up = if direction[1] == 0.0 { [0.0, 1e-200, 0.0] } else { [0.0, 0.0, 1e200] };
            let position = [0.0, 3.0, 5.0];
            let projection = Projection::Perspective { vertical_fov: 1.0 };
            builder.camera("eye", CameraDesc::new(position, direction, up, projection));
            builder.light("sun", LightDesc::Directional { direction, irradiance: [1.0; 3] });
        })
        .expect("sound");
        let camera = scene.camera(None, 1, 1).expect("a camera");
        let [forward, right, up] = [camera.forward, camera.right, camera.up].map(glam::Vec3::from);
        assert!((forward.length() - 1.0).abs() < 1e-6, "{direction:?}: {camera:?}");
        for cosine in [forward.dot(right), forward.dot(up), right.dot(up)] {
            assert!(cosine.abs() < 1e-6, "{direction:?}: {camera:?}");
        }
        let light = glam::Vec3::from(scene.view().lights[0].direction);
        assert!((light.length() - 1.0).abs() < 1e-6, "{direction:?}: {light:?}");
    }
}

#[test]
fn oddities_are_warnings() {
    let warnings = |add: fn(&mut SceneBuilder)| build(add).expect("odd but sound").warnings().join("\n");
    assert_eq!(warnings(|_| ()), "");
    let far = warnings(|builder| {
        builder.light("star", LightDesc::Point { position: [0.0, 1e6, 0.0], intensity: [1.0; 3] });
    });
    names(&far, &["directional lights"]);
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [0.5; 3]));
    builder.quad("floor", FLOOR.map(|at| at.map(|part| part + 1e6)), white);
    names(&builder.build().expect("far away").warnings().join("\n"), &["away from the origin"]);
}

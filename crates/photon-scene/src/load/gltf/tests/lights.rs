//! Lights and cameras.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::file::{File, says};
use crate::describe::{LightDesc, Projection};

/// A file with one light below a node.
fn lit(light: &str, node: &str) -> File {
    File::new()
        .with("extensions", format!(r#"{{"KHR_lights_punctual": {{"lights": [{{{light}}}]}}}}"#))
        .with("extensionsUsed", r#"["KHR_lights_punctual"]"#)
        .with("extensionsRequired", r#"["KHR_lights_punctual"]"#)
        .with(
            "nodes",
            format!(r#"[{{"mesh": 0}}, {{{node} "extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}]"#),
        )
        .with("scenes", r#"[{"nodes": [0, 1]}]"#)
}

fn file_with_camera(camera: &str, node: &str) -> File {
    File::new()
        .with("cameras", format!("[{{{camera}}}]"))
        .with("nodes", format!(r#"[{{"mesh": 0}}, {{{node} "camera": 0}}]"#))
        .with("scenes", r#"[{"nodes": [0, 1]}]"#)
}

#[test]
fn candela_are_watts_per_steradian() {
    let file = lit(
        r#""type": "point", "name": "bulb", "intensity": 3, "color": [1, 0.5, 0]"#,
        r#""translation": [1, 2, 3], "scale": [9, 9, 9],"#,
    );
    let (builder, report) = file.load();
    assert_eq!(
        builder.lights,
        [("bulb".into(), LightDesc::Point { position: [1., 2., 3.], intensity: [3., 1.5, 0.] })]
    );
    assert!(report.lines.iter().all(|line| !line.subject.contains("light")), "{report}");
    // The resulting power: 4π times the mean intensity.
    let scene = builder.build().unwrap();
    assert!((scene.units().power - 4.0 * PI * 1.5).abs() < 1e-12);
}

#[test]
fn spots_and_directions_shine_along_minus_z() {
    // A quarter turn about x takes −z to +y.
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let turn = format!(r#""rotation": [{h}, 0, 0, {h}],"#);
    let spot = r#""type": "spot", "intensity": 2, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}"#;
    let LightDesc::Spot { direction, intensity, inner_angle, outer_angle, .. } =
        lit(spot, &turn).load().0.lights[0].1.clone()
    else {
        panic!("not a spot")
    };
    assert!((direction[1] - 1.0).abs() < 1e-12 && direction[2].abs() < 1e-12, "{direction:?}");
    assert_eq!((intensity, inner_angle, outer_angle), ([2.; 3], 0.25, 0.5));

    let sun = r#""type": "directional", "intensity": 4, "color": [0.25, 0.5, 1]"#;
    let (builder, _) = lit(sun, "").load();
    assert_eq!(
        builder.lights[0],
        ("light 0".into(), LightDesc::Directional { direction: [0., 0., -1.], irradiance: [1., 2., 4.] })
    );
}

#[test]
fn cones_have_defaults_and_may_be_half_spaces() {
    let angles = |file: File| match file.load().0.lights[0].1 {
        LightDesc::Spot { inner_angle, outer_angle, .. } => (inner_angle, outer_angle),
        _ => panic!("not a spot"),
    };
    let (inner, outer) = angles(lit(r#""type": "spot", "spot": {}"#, ""));
    assert!(inner == 0.0 && (outer - FRAC_PI_4).abs() < 1e-7);
    // π/2 as f32 lies above π/2, which must not make it an error.
    let wide = lit(r#""type": "spot", "spot": {"outerConeAngle": 1.5707963267948966}"#, "");
    assert_eq!(angles(wide.clone()).1, FRAC_PI_2);
    assert!(wide.load().0.build().is_ok());
    let bare = lit(r#""type": "spot""#, "");
    assert!(says(&bare.load().1, "light 0", "no cone"));
}

#[test]
fn ranges_are_reported() {
    let (_, report) = lit(r#""type": "point", "range": 5"#, "").load();
    assert!(says(&report, "light 0", "range"));
}

#[test]
fn cameras_look_along_minus_z() {
    let perspective =
        r#""type": "perspective", "name": "eye", "perspective": {"yfov": 0.5, "znear": 0.1, "aspectRatio": 2}"#;
    let (builder, report) = file_with_camera(perspective, r#""translation": [0, 1, 5],"#).load();
    assert!(says(&report, "camera 'eye'", "2.000 times"), "{report}");
    let (name, camera) = &builder.cameras[0];
    assert_eq!((name.as_str(), camera.position), ("eye", [0., 1., 5.]));
    assert_eq!((camera.direction, camera.up), ([0., 0., -1.], [0., 1., 0.]));
    assert_eq!(camera.projection, Projection::Perspective { vertical_fov: 0.5 });
    let orthographic = r#""type": "orthographic", "orthographic": {"xmag": 4, "ymag": 3, "znear": 0, "zfar": 9}"#;
    let (builder, report) = file_with_camera(orthographic, r#""scale": [2, 2, 2],"#).load();
    assert!(says(&report, "camera 'camera 0'", "1.333 times") && report.is_exact(), "{report}");
    let equal = r#""type": "orthographic", "orthographic": {"xmag": 3, "ymag": 3, "znear": 0, "zfar": 9}"#;
    assert!(file_with_camera(equal, "").load().1.lines.is_empty());
    assert_eq!(builder.cameras[0].0, "camera 0");
    assert_eq!(builder.cameras[0].1.projection, Projection::Orthographic { half_height: 3.0 });
}

#[test]
fn cameras_of_one_name_can_be_told_apart() {
    let file = file_with_camera(r#""type": "perspective", "perspective": {"yfov": 1, "znear": 1}"#, "")
        .with("nodes", r#"[{"camera": 0}, {"camera": 0, "name": "other"}]"#);
    let names: Vec<String> = file.load().0.cameras.into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["camera 0", "camera 0 at node 1 'other'"]);
}

#[test]
fn bad_lights_and_cameras_are_named() {
    for (file, words) in [
        (lit(r#""type": "tube""#, ""), &["light 0", "unknown type"][..]),
        (lit(r#""type": "point", "intensity": -1"#, ""), &["light 0", "intensity"]),
        (lit(r#""type": "spot", "spot": {"innerConeAngle": 1, "outerConeAngle": 0.5}"#, ""), &["light 0", "angle"]),
        (lit(r#""type": "directional""#, r#""name": "n", "scale": [0, 0, 0],"#), &["node 1 'n'", "scaled to zero"]),
        (
            lit(r#""type": "point""#, "").with("extensions", r#"{"KHR_lights_punctual": {"lights": []}}"#),
            &["node 1", "light 0"],
        ),
        (file_with_camera(r#""type": "perspective""#, ""), &["camera 0", "lacks"]),
        (file_with_camera(r#""type": "fisheye""#, ""), &["camera 0"]),
        (file_with_camera("", "").with("cameras", "[]"), &["node 1", "camera 0"]),
        (file_with_camera(r#""type": "perspective", "perspective": {"yfov": 4, "znear": 1}"#, ""), &["camera 0", "4"]),
    ] {
        let error = file.error();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
}

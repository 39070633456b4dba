//! `photonmap map`

use std::path::Path;

use crate::support::{folder, has_vulkan, photonmap, refused};

/// A .npy file of points.
fn save(path: &Path, points: &[[f32; 3]]) {
    save_as(path, &format!("({}, 3)", points.len()), points);
}

/// A .npy file of float32.
fn save_as(path: &Path, shape: &str, points: &[[f32; 3]]) {
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    while (11 + header.len()) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(points.iter().flatten().flat_map(|x| x.to_le_bytes()));
    std::fs::write(path, bytes).unwrap();
}

fn load(path: &Path) -> (String, Vec<u32>) {
    let bytes = std::fs::read(path).unwrap();
    let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let word = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    (String::from_utf8_lossy(&bytes[10..end]).into_owned(), bytes[end..].chunks(4).map(word).collect())
}

#[test]
fn the_map_finds_what_brute_force_finds() {
    let folder = folder("map");
    // Coordinates on a coarse grid: many photons are at equal distance from a query.
    let point = |i: u32| [i % 7, i / 7 % 5, i / 35 % 3].map(|c| c as f32 * 0.25);
    let photons: Vec<_> = (0..200).map(point).collect();
    let queries: Vec<_> = (0..20).map(|i| point(i * 11 + 3).map(|c| c + 0.05)).collect();
    let (p, q, out) = (folder.join("p.npy"), folder.join("q.npy"), folder.join("out.npy"));
    save(&p, &photons);
    save(&q, &queries);
    let run = |backend: &str, arguments: &[&str]| {
        let mut command = photonmap("map");
        command.args(["--backend", backend]);
        command.arg("--photons").arg(&p).arg("--queries").arg(&q).arg("--neighbours").arg(&out).args(["--json", "-"]);
        let output = command.args(arguments).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["backend"], backend);
        assert!(report["seconds_build"].is_number() && report["seconds_query"].is_number());
        load(&out)
    };
    let sorted = |query: &[f32; 3], reach: f32| {
        let mut all: Vec<(f32, u32)> = photons
            .iter()
            .zip(0..)
            .map(|(photon, id)| {
                let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| photon[axis] - query[axis]);
                (x * x + y * y + z * z, id)
            })
            .filter(|(square, _)| *square <= reach * reach)
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all
    };
    let all = ["cpu", "vulkan"].into_iter().filter(|&backend| backend == "cpu" || has_vulkan());
    let cases = all.flat_map(|backend| ["median", "vvh", "morton"].map(|index| (backend, index)));
    for (backend, index) in cases {
        for (k, reach) in [(10, f32::INFINITY), (10, 0.3), (300, f32::INFINITY)] {
            let (k_text, reach_text) = (k.to_string(), reach.to_string());
            let mut arguments = vec!["--k", &k_text, "--index", index];
            if reach.is_finite() {
                arguments.extend(["--max-radius", &reach_text]);
            }
            let (header, found) = run(backend, &arguments);
            assert!(header.contains("<u4") && header.contains(&format!("({}, {k})", queries.len())), "{header}");
            for (query, row) in queries.iter().zip(found.chunks(k)) {
                let mut expected: Vec<u32> = sorted(query, reach).into_iter().map(|(_, id)| id).take(k).collect();
                expected.resize(k, u32::MAX);
                assert_eq!(row, expected, "{backend} {index} {k} {reach}");
            }
        }
        let (header, counts) = run(backend, &["--radius", "0.4", "--index", index]);
        assert!(header.contains("(20,)"), "{header}");
        for (query, count) in queries.iter().zip(counts) {
            assert_eq!(count as usize, sorted(query, 0.4).len());
        }
    }
    // Powers of two at which squares of 32 bits overflow and underflow change no neighbour.
    for backend in ["cpu", "vulkan"].into_iter().filter(|&backend| backend == "cpu" || has_vulkan()) {
        let (_, plain) = run(backend, &["--k", "10"]);
        for factor in [2.0_f32.powi(100), 2.0_f32.powi(-110)] {
            let scaled = |points: &[[f32; 3]]| points.iter().map(|point| point.map(|c| c * factor)).collect::<Vec<_>>();
            save(&p, &scaled(&photons));
            save(&q, &scaled(&queries));
            assert_eq!(run(backend, &["--k", "10"]).1, plain, "{backend} {factor}");
        }
        save(&p, &photons);
        save(&q, &queries);
    }
}

/// Photons near segments, beside brute force; at a radius that many of them have exactly, and one that none has.
#[test]
fn beams_find_what_brute_force_finds() {
    let folder = folder("map-beams");
    let point = |i: u32| [i % 7, i / 7 % 5, i / 35 % 3].map(|c| c as f32 * 0.25);
    let photons: Vec<_> = (0..200).map(point).collect();
    // Along axes, askew, beyond the photons, and of no length.
    let ends = |i: u32| match i % 4 {
        0 => [point(i), [9.0, point(i)[1], point(i)[2]]],
        1 => [point(i * 11 + 3), point(i * 31 + 17).map(|c| c + 0.1)],
        2 => [[-20.0, 1.0, 3.0], point(i * 5).map(|c| 2.0 * c)],
        _ => [point(i), point(i)],
    };
    let beams: Vec<_> = (0..40).map(ends).collect();
    let (p, b, out) = (folder.join("p.npy"), folder.join("b.npy"), folder.join("out.npy"));
    save(&p, &photons);
    for (radius, shape, index) in [(0.25, "(40, 2, 3)", "morton"), (0.4, "(40, 6)", "vvh"), (0.25, "(40, 6)", "median")]
    {
        save_as(&b, shape, beams.as_flattened());
        let mut command = photonmap("map");
        command.arg("--photons").arg(&p).arg("--beams").arg(&b).arg("--neighbours").arg(&out);
        let output = command.args(["--radius", &radius.to_string(), "--index", index, "--json", "-"]).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(
            (&report["backend"], &report["beams"], &report["queries"]),
            (&"cpu".into(), &true.into(), &40.into())
        );
        let (header, counts) = load(&out);
        assert!(header.contains("(40,)"), "{header}");
        for (number, ([a, b], count)) in beams.iter().zip(counts).enumerate() {
            let near = |photon: &&[f32; 3]| {
                let [axis, to]: [[f64; 3]; 2] =
                    [b, *photon].map(|end| std::array::from_fn(|i| f64::from(end[i]) - f64::from(a[i])));
                let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                let foot = (dot(axis, to) / dot(axis, axis).max(1e-30)).clamp(0.0, 1.0);
                let beside = [0, 1, 2].map(|i| to[i] - foot * axis[i]);
                dot(beside, beside) <= f64::from(radius as f32) * f64::from(radius as f32)
            };
            assert_eq!(count as usize, photons.iter().filter(near).count(), "{number} {radius} {index}");
        }
    }
    let (photons, beams) = (p.to_str().unwrap(), b.to_str().unwrap());
    for (arguments, culprit) in [
        (&["--beams", beams][..], "--radius"),
        (&["--beams", beams, "--k", "3"], "cannot be used with"),
        (&["--beams", beams, "--queries", photons, "--radius", "1"], "--queries"),
        (&["--beams", photons, "--radius", "1"], "shape (200,3); give a float32 array of shape (N, 2, 3)"),
        (&["--beams", beams, "--radius=-1"], "--radius is -1"),
        (&["--beams", beams, "--radius", "1", "--backend", "vulkan"], "--beams is searched on the CPU"),
    ] {
        refused(&photonmap("map").args(["--photons", photons]).args(arguments).output().unwrap(), culprit);
    }
    save_as(&b, "(1, 6)", &[[0.0; 3], [f32::INFINITY, 0.0, 0.0]]);
    let output = photonmap("map").args(["--photons", photons, "--beams", beams, "--radius", "1"]).output().unwrap();
    refused(&output, "b.npy: segment 0 has the coordinates [inf");
}

/// Rows are as long as was asked for, but take no memory while few photons are searched: 2³¹ columns would take 8 GiB.
#[test]
fn more_neighbours_than_there_are_take_no_memory() {
    let folder = folder("map-many");
    let points = folder.join("p.npy");
    save(&points, &[[0.0; 3], [1.0; 3]]);
    let files = ["--photons", points.to_str().unwrap(), "--queries", points.to_str().unwrap(), "--backend", "cpu"];
    let output = photonmap("map").args(files).args(["--k", "2147483648"]).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    // Too close together beside the largest coordinate.
    save(&points, &[[0.0; 3], [1.0; 3], [1e-36; 3]]);
    refused(&photonmap("map").args(files).args(["--k", "2"]).output().unwrap(), "query 0 and photon 2 are");
    refused(&photonmap("map").args(files).args(["--radius", "1e-36"]).output().unwrap(), "--radius is 1e-36");
}

#[test]
fn what_is_wrong_is_named() {
    let folder = folder("map-bad");
    let (good, nan, bad) = (folder.join("good.npy"), folder.join("nan.npy"), folder.join("bad.npy"));
    save(&good, &[[0.0; 3]]);
    save(&nan, &[[0.0; 3], [f32::NAN; 3]]);
    std::fs::write(&bad, b"no array").unwrap();
    let good = good.to_str().unwrap();
    let cases: [(&Path, &[&str], &str); 8] = [
        (&bad, &["--k", "1"], "bad.npy"),
        (&nan, &["--k", "1"], "point 1"),
        (&nan, &["--k", "1", "--backend", "cpu"], "nan.npy: point 1"),
        (&nan, &["--radius", "1"], "which are not finite"),
        (&folder.join("gone.npy"), &["--k", "1"], "gone.npy"),
        (Path::new(good), &["--k", "0"], "k is 0"),
        (Path::new(good), &["--radius", "inf"], "radius"),
        (Path::new(good), &[], "--k"),
    ];
    for (photons, arguments, culprit) in cases {
        let files = ["--photons", photons.to_str().unwrap(), "--queries", good];
        refused(&photonmap("map").args(files).args(arguments).output().unwrap(), culprit);
    }
    // The same for queries, on either backend.
    let files = ["--photons", good, "--queries", nan.to_str().unwrap(), "--k", "1"];
    for backend in ["cpu", "auto"] {
        let output = photonmap("map").args(files).args(["--backend", backend]).output().unwrap();
        refused(&output, "nan.npy: point 1 has the coordinates [NaN, NaN, NaN], which are not finite");
    }
}

/// A pipe would be waited for.
#[cfg(unix)]
#[test]
fn pipes_are_refused() {
    let folder = folder("map-pipes");
    let (pipe, good) = (folder.join("pipe"), folder.join("good.npy"));
    save(&good, &[[0.0; 3]]);
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let [pipe, good] = [&pipe, &good].map(|path| path.to_str().unwrap());
    for (command, arguments) in [
        ("map", &["--photons", pipe, "--queries", good, "--k", "1"][..]),
        ("map", &["--photons", good, "--queries", pipe, "--k", "1"]),
        ("compare", &[pipe, pipe]),
        ("info", &[pipe]),
    ] {
        let output = photonmap(command).args(arguments).output().unwrap();
        refused(&output, "not a regular file");
    }
}

//! The picture of a render while it is rendered.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::support::{folder, passes, photonmap, refused, succeeded};

const SCENE: [&str; 9] = ["cornell", "--size", "24x16", "--photons", "3000", "--backend", "cpu", "--exposure", "auto"];

/// The preview ends as the picture; without a terminal or a viewer, the options are refused before anything is rendered.
#[test]
fn a_preview_ends_as_the_picture() {
    let folder = folder("preview");
    let (picture, preview) = (folder.join("a.png"), folder.join("preview.png"));
    let render = |preview: &str, more: &[&str]| {
        let files = ["-o", picture.to_str().unwrap(), "--preview", preview];
        photonmap("render").args(SCENE).args(files).args(more).output().unwrap()
    };
    succeeded(&render(preview.to_str().unwrap(), &["--passes", "3"]));
    assert_eq!(std::fs::read(&preview).unwrap(), std::fs::read(&picture).unwrap());
    refused(&render("preview.gif", &[]), "preview.gif: the name of a picture ends in");
    refused(&render("none/preview.png", &[]), "none/preview.png");
    let preview = preview.to_str().unwrap();
    refused(&render(preview, &["--show"]), "--show: standard error is not a terminal");
    refused(&render(preview, &["--tev=127.0.0.1:1"]), "--tev=127.0.0.1:1");
    refused(&render(preview, &["--serve", "everywhere"]), "--serve");
}

/// While a render goes on, its preview changes, and is a whole picture whenever it is read.
#[test]
fn a_preview_follows_the_render() {
    let folder = folder("preview-during");
    let preview = folder.join("preview.png");
    let mut child = photonmap("render")
        .args(&SCENE[..7])
        // Of a given exposure: the picture that the backend shows, without a film.
        .args(["--exposure", "0.5", "--time", "300", "--preview", preview.to_str().unwrap()])
        .args(["-o", folder.join("a.png").to_str().unwrap()])
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut seen: Vec<Vec<u8>> = Vec::new();
    let begun = Instant::now();
    while seen.len() < 3 && begun.elapsed() < Duration::from_secs(60) {
        if let Ok(bytes) = std::fs::read(&preview)
            && seen.last() != Some(&bytes)
        {
            seen.push(bytes);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(seen.len(), 3, "pictures of one, two and four passes");
    let pictures: Vec<Vec<u8>> = seen
        .iter()
        .map(|bytes| {
            let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
            let mut pixels = vec![0; 24 * 16 * 3];
            assert_eq!(reader.output_buffer_size(), Some(pixels.len()), "24 x 16 pixels of three bytes");
            reader.next_frame(&mut pixels).unwrap();
            pixels
        })
        .collect();
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
    assert!(pictures.iter().flatten().any(|&value| value > 20), "they are not black");
}

/// A page shows the passes of a running render; when it is closed, the render goes on.
#[test]
fn a_page_shows_a_running_render() {
    let folder = folder("serve");
    let mut child = photonmap("render")
        .args(SCENE)
        .args(["--time", "300", "--serve", "127.0.0.1:0", "-o", folder.join("a.png").to_str().unwrap()])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let address =
        lines.find_map(|line| Some(line.unwrap().strip_prefix("watch at http://")?.trim_end_matches('/').to_owned()));
    let address = address.expect("the address is printed");
    let mut seen = Vec::new();
    for _ in 0..1200 {
        let passes = passes(&address);
        if passes > 0 && seen.last() != Some(&passes) {
            seen.push(passes);
        }
        if seen.len() == 3 {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(seen.len() == 3 && seen.is_sorted(), "{seen:?}");
}

/// Readers that stall, of the page and of a viewer, withhold neither the picture nor the end of the program.
#[test]
fn stalled_readers_withhold_nothing() {
    let folder = folder("stalled");
    let picture = folder.join("a.png");
    let viewer = TcpListener::bind("127.0.0.1:0").unwrap();
    let mut child = photonmap("render")
        .args(["cornell", "--size", "1024x1024", "--photons", "1000", "--backend", "cpu", "--passes", "3"])
        .args(["--serve", "0", &format!("--tev={}", viewer.local_addr().unwrap())])
        .args(["-o", picture.to_str().unwrap()])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let _viewer = viewer.accept().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let address =
        lines.find_map(|line| Some(line.strip_prefix("watch at http://")?.trim_end_matches('/').to_owned())).unwrap();
    while passes(&address) == 0 {
        std::thread::sleep(Duration::from_millis(20));
    }
    // 12 MB, of which nothing is read.
    let mut page = TcpStream::connect(&address).unwrap();
    page.write_all(b"GET /layer/picture HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    let begun = Instant::now();
    while !picture.exists() {
        assert!(begun.elapsed() < Duration::from_secs(120), "the picture is withheld");
        std::thread::sleep(Duration::from_millis(5));
    }
    let written = Instant::now();
    assert!(child.wait().unwrap().success());
    // Two seconds for both, and what a busy machine adds.
    assert!(written.elapsed() < Duration::from_secs(8), "{:?}", written.elapsed());
    let text = lines.collect::<Vec<_>>().join("\n");
    assert!(text.contains("warning: tev: the viewer reads too slowly"), "{text}");
    drop(page);
}

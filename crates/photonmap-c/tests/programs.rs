//! Programs in C and C++, compiled and run: the examples, and bad input to every function.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "test code")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use photon_image::exr_file;
use photonmap::cpu::Cpu;
use photonmap::{Film, Pipeline, Render, Settings, View, scene};

const SANITIZERS: &str = "-fsanitize=address,undefined";

/// A folder with the installed library, and how programs are compiled there.
struct Place {
    folder: tempfile::TempDir,
    flags: Vec<String>,
}

fn run(command: &mut Command) -> Output {
    command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"))
}

#[track_caller]
fn succeed(command: &mut Command) -> Output {
    let output = run(command);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{command:?}: {}\n{}", text(&output.stdout), text(&output.stderr));
    output
}

impl Place {
    fn new() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = tempfile::tempdir().unwrap();
        // Where cargo has built the libraries, and this test.
        let built = std::env::current_exe().unwrap().parent().unwrap().to_path_buf();
        succeed(Command::new(root.join("install.sh")).args([folder.path(), &built]));
        let mut place = Self { folder, flags: Vec::new() };
        place.flags = place.pkg_config();
        // Not every system has the sanitizers.
        let empty = place.path("empty.c");
        std::fs::write(&empty, "int main(void) { return 0; }\n").unwrap();
        if run(Command::new("cc").arg(SANITIZERS).arg(&empty).arg("-o").arg(place.path("empty"))).status.success() {
            place.flags.extend([SANITIZERS, "-fno-sanitize-recover=undefined"].map(str::to_owned));
        } else {
            let required = std::env::var_os("PHOTON_REQUIRE_SANITIZERS").is_some_and(|value| value != "0");
            assert!(!required, "{SANITIZERS} is not possible here; Debian: gcc with libasan and libubsan");
        }
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The flags of pkg-config, or those that it would give.
    fn pkg_config(&self) -> Vec<String> {
        let (include, lib) = (self.path("include"), self.path("lib"));
        let mut flags =
            vec![format!("-I{}", include.display()), format!("-L{}", lib.display()), "-lphotonmap".to_owned()];
        let mut command = Command::new("pkg-config");
        command.args(["--cflags", "--libs", "photonmap"]).env("PKG_CONFIG_PATH", lib.join("pkgconfig"));
        if let Ok(output) = command.output() {
            assert!(output.status.success(), "{output:?}");
            let text = String::from_utf8(output.stdout).unwrap();
            assert_eq!(text.split_whitespace().collect::<Vec<_>>(), flags);
        }
        flags.push(format!("-Wl,-rpath,{}", lib.display()));
        flags
    }

    /// Compiles a program without any warning; returns its path.
    fn compile(&self, compiler: &str, standard: &str, source: &str) -> PathBuf {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join(source);
        let program = self.path(source.file_stem().unwrap().to_str().unwrap());
        let warnings = ["-Wall", "-Wextra", "-pedantic", "-Werror", standard];
        let mut command = Command::new(compiler);
        succeed(command.args(warnings).arg(&source).args(&self.flags).arg("-lm").arg("-o").arg(&program));
        program
    }
}

/// The film of the example `render`, made in Rust.
fn film(passes: u32) -> Film {
    let scene = scene::builtin("cornell-glass").unwrap().build().unwrap();
    let view = View { camera: scene.camera(None, 96, 64).unwrap(), width: 96, height: 64 };
    let settings = Settings { photons: 20_000, errors: true, ..Settings::default() };
    let mut renderer = Pipeline::new(Cpu::new().unwrap(), &scene.view(), view, settings).unwrap();
    for index in 0..passes {
        renderer.pass(index, &mut ()).unwrap();
    }
    renderer.film().unwrap()
}

#[test]
fn programs_in_c_and_cpp_compile_without_warnings_and_give_the_pictures_of_rust() {
    let place = Place::new();
    let render = place.compile("cc", "-std=c99", "../../examples/c/render.c");
    let [exr, png, sums] = ["a.exr", "a.png", "a.film"].map(|name| place.path(name));
    succeed(Command::new(&render).args(["cornell-glass", "2"]).args([&exr, &png, &sums]));
    let expected = film(2);
    assert_eq!(exr_file::read(&exr).unwrap().pixels, expected.beauty());
    assert_eq!(photonmap::film::load(&sums).unwrap().0, expected);
    assert!(png.metadata().unwrap().len() > 1000);
    let output = run(Command::new(&render).args(["no-such-scene", "2"]).arg(&exr));
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && text.contains("error 1: no built-in scene"), "{text}");

    let host = place.compile("c++", "-std=c++17", "../../examples/c/host.cpp");
    let output = succeed(&mut Command::new(host));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("2048 in the longest") && text.contains("stopped after"), "{text}");

    let (denoiser, source) = (place.path("libOpenImageDenoise.so"), "../photonmap-cli/tests/program/denoise/oidn.c");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join(source);
    succeed(Command::new("cc").args(["-shared", "-fPIC", "-o"]).args([&denoiser, &source]));
    let faults = place.compile("cc", "-std=c99", "tests/c/faults.c");
    succeed(Command::new(faults).arg(&denoiser).current_dir(place.folder.path()));
}

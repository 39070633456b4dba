//! Writes `docs/studies/data/requirements.txt`: features that are not required cost nothing. Instructions on the CPU by
//! callgrind, of the shaders by `spirv-opt`; bytes, time and equality of bits by the study that prints the rows.

use std::fmt::Write as _;
use std::fs;

use photon_core::Features;

use crate::shell;

const FILE: &str = "docs/studies/data/requirements.txt";

/// The kernels that are specialised by features, and the GLSL line that declares them.
const KERNELS: [&str; 6] =
    ["stages/emit", "stages/trace", "stages/eye", "stages/direct", "stages/final_gather", "stages/area"];

/// Features that are left out together.
const FEATURES: [(&str, Features); 23] = [
    ("nothing", Features::NONE),
    ("mirrors", Features::MIRROR),
    ("glass, solid and thin", Features::DIELECTRIC.union(Features::THIN).union(Features::ABSORPTION)),
    ("absorption", Features::ABSORPTION),
    ("glossy surfaces", Features::GLOSSY),
    ("rough glass", Features::ROUGH_GLASS),
    ("clearcoats", Features::CLEARCOAT.union(Features::COATED_LIGHTS)),
    ("anisotropy", Features::ANISOTROPY),
    ("diffuse transmission", Features::DIFFUSE_TRANSMISSION),
    ("sheen", Features::SHEEN),
    ("normals of clearcoats", Features::CLEARCOAT_NORMALS),
    ("specular colours", Features::SPECULAR_COLORS),
    ("alpha", Features::ALPHA),
    ("partial transmission", Features::PARTIAL_TRANSMISSION),
    ("portals", Features::PORTALS),
    (
        "textures, normals, colours",
        Features::TEXTURES
            .union(Features::TEXTURED_LIGHTS)
            .union(Features::SHADING_NORMALS)
            .union(Features::NORMAL_MAPS)
            .union(Features::VERTEX_COLORS),
    ),
    ("area lights", Features::AREA_LIGHTS),
    ("point lights", Features::POINT_LIGHTS),
    ("spot lights", Features::SPOT_LIGHTS),
    ("directional lights", Features::DIRECTIONAL_LIGHTS.union(Features::SUN)),
    ("environment", Features::ENVIRONMENT),
    ("light tree", Features::LIGHT_TREE),
    ("lens", Features::THIN_LENS),
];

/// Writes the document.
pub(crate) fn write() -> Result<(), String> {
    for tool in ["valgrind", "spirv-opt", "spirv-dis", "glslangValidator"] {
        if !shell::present(&[tool, "--version"]) {
            return Err(format!("{tool} is not installed (Debian: valgrind, spirv-tools, glslang-tools)"));
        }
    }
    let rows = [cpu()?, shaders()?, measured(&[])?].join("\n");
    fs::write(shell::root().join(FILE), format!("{}\n", rows.trim_end())).map_err(|error| format!("{FILE}: {error}"))
}

fn measured(arguments: &[&str]) -> Result<String, String> {
    let run = ["cargo", "run", "--quiet", "--locked", "-p", "studies", "--bin", "requirements", "--"];
    shell::capture(&[&run, arguments].concat())
}

/// Instructions per path, from the difference between runs of two lengths, and of a whole pass, from that between
/// runs of one pass and of two.
fn cpu() -> Result<String, String> {
    let mut text = "### Instructions on the CPU (callgrind)\n\n\
                    Per photon path; *a pass* is a whole pass of 2000 paths and 64×64 pixels as derived, in millions.\n\n\
                    | scene | derived | widened | more | a pass |\n|---|---|---|---|---|\n"
        .to_owned();
    let (short, long) = (2000_u32, 6000_u32);
    for name in measured(&["--scenes"])?.lines() {
        let mut of_pass = 0.0;
        let mut each = |how: &str| -> Result<f64, String> {
            let one = instructions(name, how, short, 1)? as f64;
            if how == "derived" {
                of_pass = (instructions(name, how, short, 2)? as f64 - one) / 1e6;
            }
            Ok((instructions(name, how, long, 1)? as f64 - one) / f64::from(long - short))
        };
        let (derived, widened) = (each("derived")?, each("widened")?);
        let more = 100.0 * (widened / derived - 1.0);
        let _ = writeln!(text, "| {name} | {derived:.0} | {widened:.0} | {more:+.1} % | {of_pass:.1} |");
    }
    Ok(text)
}

fn instructions(scene: &str, how: &str, paths: u32, passes: u32) -> Result<u64, String> {
    let program = shell::root().join("target/debug/requirements");
    let (paths, passes) = (paths.to_string(), passes.to_string());
    let program = program.to_string_lossy();
    let command = [
        "valgrind",
        "--tool=callgrind",
        "--callgrind-out-file=/dev/stdout",
        "--quiet",
        &program,
        "--work",
        scene,
        how,
        &paths,
        &passes,
    ];
    let output = shell::capture(&command)?;
    let total =
        output.lines().find_map(|line| line.strip_prefix("summary: ").or_else(|| line.strip_prefix("totals: ")));
    total.and_then(|words| words.trim().parse().ok()).ok_or_else(|| "callgrind gave no total".to_owned())
}

/// Instructions of each kernel specialised to all features but one, compared with the same kernel compiled from
/// GLSL without that feature.
fn shaders() -> Result<String, String> {
    let mut text = "### Instructions of SPIR-V, specialised and with dead code removed\n\n\
                    Without the feature: specialised / compiled without it from the start, and the reduction against all \
                    features in per cent. Declarations before the first function are not counted.\n\n\
                    | without | "
        .to_owned();
    text += &KERNELS.join(" | ");
    text += " |\n|---";
    text += &"|---".repeat(KERNELS.len());
    text += "|\n";
    let full: Vec<usize> =
        KERNELS.iter().map(|kernel| compiled(kernel, None, Features::ALL.bits())).collect::<Result<_, _>>()?;
    for (name, features) in FEATURES {
        let without = Features::ALL.difference(features).bits();
        let _ = write!(text, "| {name} |");
        for (kernel, full) in KERNELS.iter().zip(&full) {
            let specialised = compiled(kernel, None, without)?;
            let struck_out = compiled(kernel, Some(without), without)?;
            let less = 100.0 * (1.0 - specialised as f64 / *full as f64);
            let _ = write!(text, " {specialised} / {struck_out}, −{less:.0} % |");
        }
        text.push('\n');
    }
    Ok(text)
}

/// Instructions of a kernel for these features: of the original GLSL, or with features removed.
/// Compiled here in both cases, since compiler versions generate different code.
fn compiled(kernel: &str, struck: Option<u32>, features: u32) -> Result<usize, String> {
    let root = shell::root();
    let source = fs::read_to_string(root.join(format!("shaders-glsl/{kernel}.comp"))).map_err(|e| e.to_string())?;
    let named = "layout(constant_id = 0) const uint FEATURES = 511;";
    if !source.contains(named) {
        return Err(format!("{kernel}.comp does not have the line {named:?}"));
    }
    let folder = root.join("target/requirements");
    fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let (glsl, spirv) = (folder.join("kernel.comp"), folder.join("kernel.spv"));
    let source = match struck {
        // Aiming is not a feature bit, but off if nothing is aimed at: removed as well.
        Some(left) => source
            .replace(named, &format!("const uint FEATURES = {left}u;"))
            .replace("layout(constant_id = 3) const bool AIMED", "const bool AIMED")
            .replace("layout(constant_id = 6) const bool AIMED", "const bool AIMED"),
        None => source,
    };
    fs::write(&glsl, source).map_err(|error| error.to_string())?;
    let (glsl, spirv) = (glsl.to_string_lossy(), spirv.to_string_lossy());
    shell::capture(&["glslangValidator", "--target-env", "vulkan1.2", "-V", "-Ishaders-glsl", "-o", &spirv, &glsl])?;
    count(&spirv, features)
}

/// Number of instructions that remain when the constant is folded and dead code is removed.
fn count(file: &str, features: u32) -> Result<usize, String> {
    let out = shell::root().join("target/requirements.spv");
    let out = out.to_string_lossy();
    let value = format!("0:{features}");
    shell::capture(&[
        "spirv-opt",
        "--target-env=vulkan1.2",
        "--scalar-block-layout",
        "--set-spec-const-default-value",
        &value,
        "--freeze-spec-const",
        "--fold-spec-const-op-composite",
        "--strip-debug",
        "--ccp",
        "--eliminate-dead-branches",
        "--merge-return",
        "--inline-entry-points-exhaustive",
        "--eliminate-dead-functions",
        "--private-to-local",
        "--scalar-replacement=100",
        "--ssa-rewrite",
        "--ccp",
        "--eliminate-dead-branches",
        "--merge-blocks",
        "--simplify-instructions",
        "--redundancy-elimination",
        "--eliminate-dead-code-aggressive",
        "--eliminate-dead-const",
        "-o",
        &out,
        file,
    ])?;
    let listing = shell::capture(&["spirv-dis", "--no-header", &out])?;
    // Everything before the first function is a declaration.
    Ok(listing.lines().skip_while(|line| !line.contains("OpFunction ")).count())
}

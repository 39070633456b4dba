//! Every function of the GLSL library is compared with its Rust twin over a table of inputs.
//!
//! The bounds are stated once for each function, in [`table`] or, for functions that read tables of a scene, in a
//! module of their own; and in `docs/studies/data/shader-bounds.txt`.

mod alpha;
mod area;
mod bias;
mod compare;
mod draw;
mod environment;
mod environment_limits;
mod flushed;
mod gloss_caustics;
mod glossy;
mod grid;
pub(crate) mod layout;
mod light_sampler;
mod light_tree;
mod light_tree_condition;
mod light_tree_limits;
mod listed;
mod maps;
mod media;
mod medium;
mod narrow;
mod narrow_lobes;
pub(crate) mod parameters;
mod photon_format;
mod projection;
mod rough;
mod rough_glass;
mod rules;
mod scene;
mod shade;
mod shaded_scene;
mod shading_normal;
mod shadow_terminator;
mod solid_angle;
pub(crate) mod specialization;
pub(crate) mod spirv;
mod table;
mod texture;
mod triangle;

use bytemuck::{Pod, Zeroable};
use photon_core::{Requirements, Result, SceneView, Settings};

use self::compare::Denormals;
use self::table::{Row, Twin};
use crate::Vulkan;
use crate::device::Module;
use crate::scene::VulkanScene;
use crate::specialization::Constants;

/// The inputs of one call: words, or the bits of floats.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
struct Input([u32; 12]);

/// The outputs of one call; unused words are 0.
type Output = [u32; 8];

parameters! {
    struct Push =>
        PROBE_ALPHA PROBE_AREA PROBE_BIAS PROBE_BSDF PROBE_ENVIRONMENT PROBE_GLOSS_CAUSTICS PROBE_GLOSSY
        PROBE_GRID PROBE_KERNEL PROBE_LIGHT_SAMPLER PROBE_LIGHT_TREE PROBE_MATH PROBE_MEDIA PROBE_MEDIUM PROBE_OCTAHEDRAL PROBE_OFFSET
        PROBE_PHOTON_FORMAT PROBE_PROJECTION PROBE_RANDOM PROBE_ROUGH_GLASS PROBE_SAMPLING PROBE_SHADE
        PROBE_SHADING_NORMAL PROBE_SHADOW_TERMINATOR PROBE_SOLID_ANGLE PROBE_TEXTURE PROBE_TRIANGLE
    {
        inputs: u64,
        outputs: u64,
        count: u32,
        padding: u32,
    }
}

specialized!(
    probe_constants: ProbeConstants => PROBE_ALPHA PROBE_AREA PROBE_BIAS PROBE_BSDF PROBE_ENVIRONMENT PROBE_GLOSS_CAUSTICS PROBE_GLOSSY
        PROBE_GRID PROBE_KERNEL PROBE_LIGHT_SAMPLER PROBE_LIGHT_TREE PROBE_MATH PROBE_MEDIUM PROBE_OCTAHEDRAL PROBE_OFFSET PROBE_PHOTON_FORMAT
        PROBE_PROJECTION PROBE_RANDOM PROBE_ROUGH_GLASS
        PROBE_SAMPLING PROBE_SHADE PROBE_SHADING_NORMAL PROBE_SHADOW_TERMINATOR PROBE_SOLID_ANGLE PROBE_TEXTURE
        PROBE_TRIANGLE,
    2 function: u32; default features shared_groups media
);

/// Evaluates function number `function` of a probe for the inputs.
fn run(on: &mut Vulkan, module: &'static Module, function: u32, inputs: &[Input]) -> Result<Vec<Output>> {
    dispatch(on, module, &ProbeConstants { function }, inputs)
}

fn dispatch(
    on: &mut Vulkan,
    module: &'static Module,
    constants: &impl Constants,
    inputs: &[Input],
) -> Result<Vec<Output>> {
    let from = on.memory("inputs", size_of_val(inputs) as u64)?;
    let to = on.memory("outputs", (inputs.len() * size_of::<Output>()) as u64)?;
    on.write(&from, 0, bytemuck::cast_slice(inputs))?;
    on.fill_words(&to, 0, to.bytes(), u32::MAX)?;
    let kernel = on.kernel(module, 64, constants);
    let count = inputs.len() as u32;
    let push = Push { inputs: from.address(), outputs: to.address(), count, padding: 0 };
    on.dispatch(&kernel, &push, u64::from(count.div_ceil(64)))?;
    let mut outputs = vec![[0; 8]; inputs.len()];
    on.read(&to, 0, bytemuck::cast_slice_mut(&mut outputs))?;
    Ok(outputs)
}

/// Draws the inputs of a row, puts `last` into their last words, and evaluates the function.
fn run_row(on: &mut Vulkan, row: &Row, last: &[u32]) -> (Vec<Input>, Vec<Output>) {
    run_with(on, row, &ProbeConstants { function: row.function }, last)
}

/// The same with other specialization constants.
fn run_with(on: &mut Vulkan, row: &Row, constants: &impl Constants, last: &[u32]) -> (Vec<Input>, Vec<Output>) {
    let mut inputs = draw::inputs(row.draw);
    for input in &mut inputs {
        input.0[12 - last.len()..].copy_from_slice(last);
    }
    let outputs = dispatch(on, row.module, constants, &inputs).unwrap();
    (inputs, outputs)
}

/// [`compare::worst`], with denormals as the device handles them.
fn worst_of(on: &mut Vulkan, row: &Row, inputs: &[Input], outputs: &[Output]) -> std::result::Result<f64, String> {
    compare::worst(row, inputs, outputs, Denormals::of(on).unwrap())
}

/// Asserts that a function, called with `last` in the last words of its inputs, is within its bound of its twin, and that
/// `wrong`, a slightly different twin, is not.
fn assert_twin(on: &mut Vulkan, row: &Row, last: &[u32], wrong: Twin) {
    let (inputs, outputs) = run_row(on, row, last);
    let share = worst_of(on, row, &inputs, &outputs).unwrap();
    eprintln!("{:<28} {share:>9.3e} of {}", row.name, row.bound);
    let wrong = Row { twin: wrong, ..*row };
    assert!(worst_of(on, &wrong, &inputs, &outputs).is_err(), "{}", row.name);
}

/// An address as two words of an input, the low one first.
fn words_of(address: u64) -> [u32; 2] {
    [address as u32, (address >> 32) as u32]
}

/// A scene with everything that functions may read.
fn whole_scene(on: &mut Vulkan, view: &SceneView<'_>) -> VulkanScene {
    VulkanScene::new(on, view, &Requirements::everything(&Settings::default())).unwrap()
}

/// All functions that are compared.
fn all_rows() -> Vec<Row> {
    let single = vec![triangle::row(), photon_format::row()];
    let shading =
        [texture::rows(), shading_normal::rows(), shade::rows(), environment::rows(), glossy::rows(), alpha::rows()]
            .concat();
    let shading = [shading, shadow_terminator::rows(), narrow::rows(), narrow_lobes::rows()].concat();
    [
        table::rows(),
        light_sampler::rows(),
        grid::rows(),
        light_tree::rows(),
        media::rows(),
        medium::rows(),
        projection::rows(),
        shading,
        single,
    ]
    .concat()
}

/// Checks every row of the table and reports all that fail.
#[test]
fn every_function_is_within_its_bound_of_its_twin() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let denormals = Denormals::of(&mut on).unwrap();
    eprintln!("{}, denormals {denormals:?}", on.limits().name);
    let mut failures = Vec::new();
    for row in table::rows() {
        let inputs = draw::inputs(row.draw);
        let outputs = run(&mut on, row.module, row.function, &inputs).unwrap();
        match compare::worst(&row, &inputs, &outputs, denormals) {
            Ok(worst) => eprintln!("{:<24} {worst:>9.3e} of {}", row.name, row.bound),
            Err(message) => failures.push(message),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The table in the documentation matches this one.
#[test]
fn the_documentation_states_the_bounds() {
    // Read at run time: a moved target folder must not refer to the old checkout.
    let folder = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| "crates/backend-vulkan".into());
    let text = std::fs::read_to_string(std::path::Path::new(&folder).join("../../docs/studies/data/shader-bounds.txt"))
        .unwrap();
    for row in all_rows() {
        let line = format!("| {} | {} |", row.name, row.bound);
        assert!(
            text.lines().any(|known| known == line),
            "docs/studies/data/shader-bounds.txt does not contain: {line}"
        );
    }
}

/// A twin with one fused multiply-add is detected.
#[test]
fn a_function_that_rounds_otherwise_fails() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let denormals = Denormals::of(&mut on).unwrap();
    let mut row = table::rows().into_iter().find(|row| row.name == "barycentric").unwrap();
    let inputs = draw::inputs(row.draw);
    let outputs = run(&mut on, row.module, row.function, &inputs).unwrap();
    compare::worst(&row, &inputs, &outputs, denormals).unwrap();
    row.twin = table::fused_barycentric;
    let message = compare::worst(&row, &inputs, &outputs, denormals).unwrap_err();
    assert!(message.starts_with("barycentric"), "{message}");
}

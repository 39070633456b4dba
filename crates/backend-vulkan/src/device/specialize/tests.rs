use photon_core::{Features, MediaFeatures};

use super::instructions::{Instruction, op, read};
use super::*;
use crate::device::Module;
use crate::shaders;

fn instructions(words: &[u32]) -> Vec<Instruction<'_>> {
    read(&words[HEADER..]).unwrap()
}

/// Names of a module's functions, without their parameter types.
fn functions(words: &[u32]) -> Vec<String> {
    let all = instructions(words);
    let name = |id: u32| {
        let named = all.iter().find(|i| i.op == op::NAME && i.words[1] == id).unwrap();
        let bytes: Vec<u8> = named.words[2..].iter().flat_map(|word| word.to_le_bytes()).collect();
        String::from_utf8(bytes).unwrap().split(['(', '\0']).next().unwrap().to_owned()
    };
    all.iter().filter(|i| i.op == op::FUNCTION).map(|i| name(i.words[2])).collect()
}

fn with_features(module: &Module, features: Features) -> Vec<u32> {
    specialize(&module.words(), &[(0, features.bits()), (1, 64)])
}

/// Nothing is left to specialise, every function that is called is there, and every id that is used is defined once.
#[test]
fn every_module_is_complete() {
    for module in shaders::KERNELS.iter().chain(&shaders::TEST_KERNELS) {
        let plain = module.words();
        let of_features =
            [Features::empty(), Features::DIELECTRIC, Features::GLOSSY | Features::ALPHA, Features::all()]
                .map(|features| with_features(module, features));
        let nothing: Vec<_> = (0..16).map(|id| (id, u32::from(id == 1))).collect();
        for words in of_features.into_iter().chain([specialize(&plain, &nothing)]) {
            let all = instructions(&words);
            let open = all.iter().filter(|i| (op::SPEC_CONSTANT_TRUE..=op::SPEC_CONSTANT_OP).contains(&i.op)).count();
            assert_eq!(open, 0, "{}", module.name);
            assert!(words.len() <= plain.len(), "{}", module.name);
            let defined: Vec<u32> = all.iter().filter(|i| i.op == op::FUNCTION).map(|i| i.words[2]).collect();
            let constants: Vec<u32> =
                all.iter().take_while(|i| i.op != op::FUNCTION).filter_map(Instruction::result).collect();
            for copy in all.iter().filter(|i| i.op == op::COPY_OBJECT && constants.contains(&i.words[3])) {
                let constant = all.iter().find(|i| i.result() == Some(copy.words[3])).unwrap();
                assert_eq!(constant.words[1], copy.words[1], "{}: of another type", module.name);
            }
            let calls = all.iter().filter(|i| i.op == op::FUNCTION_CALL);
            assert!(calls.into_iter().all(|call| defined.contains(&call.words[3])), "{}", module.name);
            let labels: Vec<u32> = all.iter().filter(|i| i.op == op::LABEL).map(|i| i.words[1]).collect();
            for jump in all.iter().filter(|i| i.op == op::BRANCH) {
                assert!(labels.contains(&jump.words[1]), "{}", module.name);
            }
        }
    }
}

/// A feature that a scene lacks leaves no function behind; one that it has keeps its own.
#[test]
fn functions_of_absent_features_are_removed() {
    let of = |features| functions(&with_features(&shaders::STAGES_EYE, features));
    let has = |functions: &[String], start: &str| functions.iter().any(|name| name.starts_with(start));
    let plain = of(Features::empty());
    let glossy = of(Features::GLOSSY);
    let rough = of(Features::ROUGH_GLASS);
    assert!(!has(&plain, "glossy_") && !has(&plain, "rough_glass_") && !has(&plain, "texture"), "{plain:?}");
    assert!(has(&glossy, "glossy_") && !has(&glossy, "rough_glass_"), "{glossy:?}");
    assert!(has(&rough, "rough_glass_"), "{rough:?}");
    assert!(plain.len() < glossy.len());
    let traced = |media: MediaFeatures| {
        let (features, media) = (Features::ABSORPTION.bits(), (MediaFeatures::SCATTERING | media).bits());
        functions(&specialize(&shaders::STAGES_TRACE.words(), &[(0, features), (1, 64), (7, media)]))
    };
    assert!(!has(&traced(MediaFeatures::NONE), "grid_walk") && has(&traced(MediaFeatures::GRIDS), "grid_walk"));
    let emit = |features| functions(&with_features(&shaders::STAGES_EMIT, features));
    let (sky, portals) = (Features::ENVIRONMENT, Features::ENVIRONMENT | Features::PORTALS);
    assert!(has(&emit(sky), "environment_") && !has(&emit(sky), "portal"), "{:?}", emit(sky));
    assert!(has(&emit(portals), "portals_sample"), "{:?}", emit(portals));
}

/// What is not understood is not changed.
#[test]
fn other_words_are_returned() {
    let module = shaders::STAGES_EYE.words();
    for words in [&[][..], &module[..HEADER], &module[..module.len() - 1], &[7; 40]] {
        assert_eq!(specialize(words, &[(0, 1)]), words);
    }
}

//! Tests of the Vulkan layer in isolation.

use std::sync::Arc;

use ash::vk;
use photon_core::{Backend, Error, Photon, Stage, StopCondition};

use super::instance::Instance;
use crate::sort::KeyConstants;
use crate::{Vulkan, shaders};

parameters! {
    struct CopyPush => DEVICE_COPY {
        from: u64,
        to: u64,
        count: u32,
        plus: u32,
    }
}

/// Long chains of commands, each of which depends on the previous one.
#[test]
fn commands_wait_for_each_other() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    const COUNT: u32 = 100_000;
    let ping = on.memory("ping", u64::from(COUNT) * 4).unwrap();
    let pong = on.memory("pong", u64::from(COUNT) * 4).unwrap();
    let kernel = on.kernel(&shaders::DEVICE_COPY, 64, &());
    on.fill_words(&ping, 0, u64::from(COUNT) * 4, 7).unwrap();
    for turn in 0..600 {
        let (from, to) = if turn % 2 == 0 { (&ping, &pong) } else { (&pong, &ping) };
        let push = CopyPush { from: from.address(), to: to.address(), count: COUNT, plus: 1 };
        on.dispatch(&kernel, &push, u64::from(COUNT.div_ceil(64))).unwrap();
    }
    let mut words = vec![0_u32; COUNT as usize];
    on.read(&ping, 0, bytemuck::cast_slice_mut(&mut words)).unwrap();
    assert!(words.iter().all(|&word| word == 607));
}

/// More marks than commands of a submission, none of which is made: the error ends with the pass.
#[test]
fn marks_of_an_abandoned_pass_are_no_fault() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    photon_core::TransportBackend::stop_when(&mut on, Some(StopCondition::new(|| true)));
    for turn in 0..600 {
        on.mark(Some(if turn % 2 == 0 { Stage::Eye } else { Stage::Trace }));
    }
    assert!(matches!(on.fault, Some(Error::Cancelled)));
    photon_core::TransportBackend::stop_when(&mut on, None);
    on.timings().unwrap();
}

/// Transfers larger than the staging buffer, of an odd number of bytes.
#[test]
fn what_is_uploaded_comes_back() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let photon = |i: u32| Photon { position: [i as f32, 0.5, -1.0], direction: i, ..Photon::default() };
    for count in [0_u32, 1, 1000, 1_500_000] {
        let photons: Vec<Photon> = (0..count).map(photon).collect();
        let there = on.upload("photons", &photons).unwrap();
        let mut back = vec![photon(9)];
        on.download(&there, &mut back).unwrap();
        assert_eq!(back, photons);
    }
    let mut bytes = [0_u8; 7];
    let memory = on.memory("odd", 7).unwrap();
    on.write(&memory, 0, b"sevenly").unwrap();
    on.read(&memory, 0, &mut bytes).unwrap();
    assert_eq!(&bytes, b"sevenly");
}

#[test]
fn a_buffer_larger_than_any_allocation_is_an_error() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    assert!(matches!(
        on.alloc::<Photon>("photons: global", 1 << 40),
        Err(Error::OutOfMemory { label: "photons: global", .. })
    ));
    let largest = on.limits().max_allocation;
    // Where that exceeds the maximum number of photons, the error is about the number.
    if largest / 32 < u64::from(u32::MAX) {
        let found = on.alloc::<Photon>("photons: global", largest / 32 + 1).unwrap_err();
        let Error::AllocationTooLarge { label: "photons: global", bytes, limit } = found else { panic!("{found:?}") };
        assert_eq!((bytes, limit), ((largest / 32 + 1) * 32, largest));
    }
    // A label that no error has named before, and the same again.
    for _ in 0..2 {
        let label = format!("scratch {}", 7);
        let Err(Error::AllocationTooLarge { label, .. }) = on.memory(&label, u64::MAX) else { panic!("a buffer") };
        assert_eq!(label, "scratch 7");
    }
}

/// Buffers may be dropped while pending commands use them.
#[test]
fn dropped_memory_lives_until_it_is_done_with() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let kernel = on.kernel(&shaders::DEVICE_COPY, 64, &());
    let last = on.memory("last", 4096).unwrap();
    for turn in 0..40 {
        let first = on.memory("first", 4096).unwrap();
        on.fill_words(&first, 0, 4096, turn).unwrap();
        on.dispatch(&kernel, &CopyPush { from: first.address(), to: last.address(), count: 1024, plus: 0 }, 16)
            .unwrap();
    }
    let mut words = [0_u32; 1024];
    on.read(&last, 0, bytemuck::cast_slice_mut(&mut words)).unwrap();
    assert!(words.iter().all(|&word| word == 39));
}

#[test]
fn stages_are_timed() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let memory = on.memory("some", 64 << 20).unwrap();
    for _ in 0..600 {
        on.mark(Some(Stage::Build));
        on.fill_words(&memory, 0, 4096, 1).unwrap();
        on.mark(Some(Stage::Film));
    }
    on.mark(Some(Stage::Estimate));
    on.fill_words(&memory, 0, 64 << 20, 1).unwrap();
    on.mark(None);
    let timings = on.timings().unwrap();
    assert!(timings.get(Stage::Estimate) > 0.0 && timings.get(Stage::Build) > 0.0);
    assert!(timings.get(Stage::Trace) <= 0.0);
    assert!(on.timings().unwrap().get(Stage::Estimate) <= 0.0);
}

/// The validation layer is active: it reports misuse, and a device with validation panics when dropped.
#[test]
fn validation_sees_what_is_wrong() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    if !on.is_watched() {
        return;
    }
    let memory = on.memory("some buffer", 64).unwrap();
    // Past the end of the buffer, through the recorder, which does not check.
    on.recorder.fill(&memory, 0, 1 << 20, 0).unwrap();
    on.recorder.forget();
    let said = on.validation_messages().join("\n");
    assert!(said.contains("some buffer"), "{said}");
    assert_fails(on);
}

/// Commands are labelled with the name of their stage.
#[test]
fn messages_about_commands_name_their_stage() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    // The layer names the stage only for misuse within a command buffer, and real drivers crash when such
    // commands are recorded.
    if !on.is_watched() || on.limits().loop_turns == 0 {
        eprintln!("skipped: needs lavapipe with the validation layer");
        return;
    }
    on.mark(Some(Stage::Gather));
    let commands = on.recorder.commands().unwrap();
    // SAFETY: recorded without a pipeline, which causes the message, and discarded.
    unsafe { on.device.raw.cmd_dispatch(commands, 1, 1, 1) };
    on.recorder.forget();
    let said = on.validation_messages().join("\n");
    assert!(said.contains(&format!("[in {}]", Stage::Gather.name())), "{said}");
    assert_fails(on);
}

/// Dropping a device with validation messages panics.
fn assert_fails(on: Vulkan) {
    let dropped = std::panic::catch_unwind(std::panic::AssertUnwindSafe(move || drop(on)));
    assert!(dropped.is_err());
}

/// Synchronization is validated as well: two unordered writes to one place are reported.
#[test]
fn validation_sees_a_missing_barrier() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    if !on.is_watched() {
        return;
    }
    let memory = on.memory("some", 64).unwrap();
    let twice = |on: &mut Vulkan| {
        on.fill_words(&memory, 0, 64, 1)?;
        on.fill_words(&memory, 0, 64, 2)
    };
    twice(&mut on).unwrap();
    assert_eq!(on.validation_messages(), Vec::<String>::new(), "the recorder's own barriers do");
    on.unordered(twice).unwrap();
    on.recorder.forget();
    let said = on.validation_messages().join("\n");
    assert!(said.contains("SYNC-HAZARD-WRITE"), "{said}");
    assert_fails(on);
}

/// Every kind of object that a device creates has the name that debuggers and messages show.
#[test]
fn every_object_has_a_name() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let memory = on.memory("a label", 1 << 20).unwrap();
    on.mark(Some(Stage::Build));
    let kernel = on.kernel(&shaders::DEVICE_COPY, 64, &());
    let push = CopyPush { from: memory.address(), to: memory.address(), count: 0, plus: 0 };
    on.dispatch(&kernel, &push, 1).unwrap();
    on.mark(None);
    on.finish().unwrap();
    let named = on.device.named();
    for kind in [
        vk::ObjectType::DEVICE,
        vk::ObjectType::QUEUE,
        vk::ObjectType::DEVICE_MEMORY,
        vk::ObjectType::BUFFER,
        vk::ObjectType::SHADER_MODULE,
        vk::ObjectType::PIPELINE_LAYOUT,
        vk::ObjectType::PIPELINE_CACHE,
        vk::ObjectType::PIPELINE,
        vk::ObjectType::COMMAND_POOL,
        vk::ObjectType::COMMAND_BUFFER,
        vk::ObjectType::SEMAPHORE,
        vk::ObjectType::QUERY_POOL,
    ] {
        assert!(named.iter().any(|(known, name)| *known == kind && !name.is_empty()), "{kind:?}: {named:?}");
    }
    let has = |kind, text: &str| named.iter().any(|(known, name)| *known == kind && name == text);
    assert!(has(vk::ObjectType::BUFFER, "a label") && has(vk::ObjectType::PIPELINE, "device_copy"));
}

/// One pipeline per module and set of constants, compiled once.
#[test]
fn pipelines_are_compiled_once() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let mut pipeline = |module, workgroup, key_words| {
        let kernel = on.kernel(module, workgroup, &KeyConstants { key_words });
        on.pipeline(&kernel).unwrap()
    };
    let first = pipeline(&shaders::SORT_COUNT, 64, 1);
    assert_eq!(first, pipeline(&shaders::SORT_COUNT, 64, 1));
    assert_ne!(first, pipeline(&shaders::SORT_COUNT, 32, 1));
    assert_ne!(first, pipeline(&shaders::SORT_COUNT, 64, 2));
    assert_ne!(first, pipeline(&shaders::SORT_SCATTER, 64, 1));
}

/// A driver is not unloaded between one device and the next: all devices share an instance, and those with
/// validation share another.
#[test]
fn devices_opened_one_after_another_share_an_instance() {
    let Some(first) = Vulkan::for_tests() else { return };
    let watched = first.is_watched();
    drop(first);
    for validation in [false, watched] {
        let shared = Instance::shared(validation).unwrap();
        for _ in 0..3 {
            let on = Vulkan::with_options(&crate::Options { validation, ..crate::Options::default() }).unwrap();
            assert!(on.validation_messages().is_empty());
            assert!(Arc::ptr_eq(&shared, &Instance::shared(validation).unwrap()));
        }
    }
    if watched {
        assert!(!Arc::ptr_eq(&Instance::shared(false).unwrap(), &Instance::shared(true).unwrap()));
    }
}

/// Each of many identical messages is reported: if the layer suppressed duplicates, those of another device
/// would be lost.
#[test]
fn a_message_counts_for_its_own_device_alone() {
    const TIMES: usize = 24;
    let Some(before) = Vulkan::for_tests() else { return };
    if !before.is_watched() {
        return;
    }
    let mut wrong = Vulkan::for_tests().unwrap();
    let mut after = Vulkan::for_tests().unwrap();
    let memory = wrong.memory("some buffer", 64).unwrap();
    // Past the end, through the recorder, which does not check.
    for _ in 0..TIMES {
        wrong.recorder.fill(&memory, 0, 1 << 20, 0).unwrap();
    }
    wrong.recorder.forget();
    let said = wrong.validation_messages();
    assert_eq!(said.iter().filter(|message| message.contains("some buffer")).count(), TIMES, "{said:?}");
    // Later objects and commands are tracked as well, and not attributed to the other device.
    let fine = after.memory("another", 64).unwrap();
    after.fill_words(&fine, 0, 64, 1).unwrap();
    after.finish().unwrap();
    assert_eq!([before.validation_messages(), after.validation_messages()], [const { Vec::<String>::new() }; 2]);
    assert_fails(wrong);
    drop((before, after));
}

/// A buffer that is still alive when its device is destroyed is reported.
#[test]
fn what_is_left_over_is_a_message_too() {
    let Some(on) = Vulkan::for_tests() else { return };
    if !on.is_watched() || on.limits().loop_turns == 0 {
        eprintln!("skipped: needs lavapipe with the validation layer");
        return;
    }
    let info = vk::BufferCreateInfo::default().size(64).usage(vk::BufferUsageFlags::TRANSFER_DST);
    // SAFETY: the device is alive; the test is about the buffer never being destroyed.
    let left = unsafe { on.device.raw.create_buffer(&info, None) }.unwrap();
    on.device.name(left, "left over");
    assert_eq!(on.validation_messages(), Vec::<String>::new());
    assert_fails(on);
}

/// A kernel that the driver refuses is an error of whoever dispatches it, each time; others are not affected.
#[test]
fn a_kernel_that_does_not_compile_is_an_error() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    on.device.injection.refuse_kernels(true);
    let refused = on.kernel(&shaders::DEVICE_COPY, 64, &());
    for _ in 0..2 {
        let error = on.pipeline(&refused).unwrap_err();
        assert!(matches!(&error, photon_core::Error::Backend { .. }), "{error:?}");
        let source = std::error::Error::source(&error).unwrap().to_string();
        assert!(source.contains("device_copy"), "{source}");
    }
    on.device.injection.refuse_kernels(false);
    let made = on.kernel(&shaders::DEVICE_COPY, 32, &());
    assert!(on.pipeline(&made).is_ok());
}

//! Photons of a scene, for other programs.

use std::ffi::c_char;

use photonmap::cpu::Cpu;
use photonmap::{
    Backend, Batch, MapKind, MediaDeposits, Pass, PerMap, Photon, PhotonRay, Requirements, Settings, TransportBackend,
    octahedral,
};

use crate::error::{Fault, PmStatus, Result, call, free};
use crate::options;
use crate::pointer;
use crate::scene::PmScene;

/// PmPhotonArrays.kinds: a photon straight from a light.
pub const PM_PHOTON_DIRECT: u8 = 0;
/// A photon that came by way of mirrors and glass alone.
pub const PM_PHOTON_CAUSTIC: u8 = 1;
/// A photon that was scattered diffusely before.
pub const PM_PHOTON_GLOBAL: u8 = 2;

/// Photons that were traced. Several threads may read them at once.
#[derive(Debug)]
pub struct PmPhotons {
    photons: Vec<(MapKind, Photon)>,
    center: [f64; 3],
    scale: f64,
    /// Factor from a photon's power to watts.
    watts: f64,
}

/// Arrays for the photons. Each may be NULL.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmPhotonArrays {
    /// sizeof(PmPhotonArrays).
    pub size: usize,
    /// 3 coordinates for each photon, user space.
    pub positions: *mut f64,
    /// Normal of the surface on the side where the photon arrived, 3 for each.
    pub normals: *mut f32,
    /// Direction towards where the photon came from, 3 for each.
    pub directions: *mut f32,
    /// Flux in RGB, W, 3 for each.
    pub powers: *mut f32,
    /// One of PM_PHOTON_… for each.
    pub kinds: *mut u8,
}

pointer::versioned!(PmPhotonArrays);

/// Most photons, so that an absurd number is refused instead of filling the memory.
const MAX_PHOTONS: u64 = 1 << 31;

impl PmPhotons {
    fn trace(scene: &PmScene, settings: &Settings, pass: u32) -> Result<Self> {
        let (view, units) = (scene.scene.view(), scene.scene.units());
        let mut on = Cpu::new()?;
        let mut required = Requirements::of(&view, settings);
        required.maps = PerMap::splat(true);
        if view.triangles.is_empty() {
            return Err(photonmap::Error::NoTriangles.into());
        }
        if view.lights.is_empty() {
            return Err(photonmap::Error::NoLight.into());
        }
        let prepared = on.prepare(&view, &required)?;
        let mut stages = on.stages(&required, settings)?;
        let pass = Pass { seed: settings.seed, index: pass, random: settings.random, sample: 0, samples: 1 };
        let step = settings.photons.min(on.batch());
        let mut rays = on.alloc::<PhotonRay>("photon rays", u64::from(step))?;
        let mut photons = Vec::new();
        let mut first = 0;
        while first < settings.photons {
            let paths = first..settings.photons.min(first.saturating_add(step));
            let batch = Batch { pass, paths: paths.clone() };
            stages.emitter.emit(&mut on, &prepared, &batch, &mut rays)?;
            let capacity = u64::from(step) * u64::from(settings.max_bounces.min(64));
            let mut capacity = capacity.min(MAX_PHOTONS) / 8 + 1024;
            let maps = loop {
                let mut maps = PerMap::from_fn(|_| None);
                for kind in MapKind::ALL {
                    maps[kind] = Some(on.alloc::<Photon>(kind.label(), capacity)?);
                }
                let deposits = maps.each_mut().map(Option::as_mut);
                stages.tracer.trace(&mut on, &prepared, &batch, &rays, deposits, MediaDeposits::default())?;
                let mut needed = 0;
                for buffer in maps.values().flatten() {
                    needed = needed.max(on.fill(buffer)?.needed);
                }
                if needed <= capacity {
                    break maps;
                }
                capacity = needed;
            };
            let found: u64 = maps.values().flatten().map(|buffer| buffer.as_slice().len() as u64).sum();
            let all = photons.len() as u64 + found;
            let refused =
                || Fault::new(PmStatus::OutOfMemory, format!("{all} photons are too many; trace fewer paths"));
            if all > MAX_PHOTONS || photons.try_reserve(found as usize).is_err() {
                return Err(refused());
            }
            for (kind, buffer) in maps.iter() {
                let found = buffer.iter().flat_map(|buffer| buffer.as_slice());
                photons.extend(found.map(|&photon| (kind, photon)));
            }
            first = paths.end;
        }
        let watts = units.power / f64::from(settings.photons);
        Ok(Self { photons, center: units.center, scale: units.scale, watts })
    }
}

/// Traces the photons of a pass of a scene on the CPU: as many paths as the setting `photons` says, each of which leaves a
/// photon at every surface that scatters diffusely.
///
/// `settings` as for pm_renderer_new(). `*photons` is to be freed with pm_photons_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_photons_trace(
    scene: *const PmScene,
    settings: *const c_char,
    pass: u32,
    photons: *mut *mut PmPhotons,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle and text, and pointer to a handle.
        unsafe {
            pointer::hand_out(photons, || {
                PmPhotons::trace(pointer::shared(scene, "scene")?, &options::settings(settings)?, pass)
            })
        }
    })
}

/// Number of photons; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_photons_count(photons: *const PmPhotons) -> usize {
    // SAFETY: the caller's handle.
    crate::error::length(|| Ok(unsafe { pointer::shared(photons, "photons") }?.photons.len()))
}

/// Copies photons into arrays of `count` elements or triples, which has to be pm_photons_count().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_photons_copy(
    photons: *const PmPhotons,
    arrays: *const PmPhotonArrays,
    count: usize,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle and struct.
        let (from, to) = unsafe { (pointer::shared(photons, "photons")?, pointer::read(arrays)?) };
        if count != from.photons.len() {
            return Err(Fault::argument(format!("count is {count}, but there are {} photons", from.photons.len())));
        }
        let room = |is_null: bool, width: usize| if is_null { 0 } else { count * width };
        // SAFETY: the caller's arrays, of which those that are NULL have no elements.
        let (positions, normals, directions, powers, kinds) = unsafe {
            (
                pointer::array_mut(to.positions, room(to.positions.is_null(), 3), "positions")?,
                pointer::array_mut(to.normals, room(to.normals.is_null(), 3), "normals")?,
                pointer::array_mut(to.directions, room(to.directions.is_null(), 3), "directions")?,
                pointer::array_mut(to.powers, room(to.powers.is_null(), 3), "powers")?,
                pointer::array_mut(to.kinds, room(to.kinds.is_null(), 1), "kinds")?,
            )
        };
        let all = || from.photons.iter().map(|(_, photon)| photon);
        for (slot, photon) in positions.as_chunks_mut::<3>().0.iter_mut().zip(all()) {
            *slot = [0, 1, 2].map(|axis| f64::from(photon.position[axis]) * from.scale + from.center[axis]);
        }
        for (slot, photon) in normals.as_chunks_mut::<3>().0.iter_mut().zip(all()) {
            *slot = octahedral::unpack(photon.normal).into();
        }
        for (slot, photon) in directions.as_chunks_mut::<3>().0.iter_mut().zip(all()) {
            *slot = octahedral::unpack(photon.direction).into();
        }
        for (slot, photon) in powers.as_chunks_mut::<3>().0.iter_mut().zip(all()) {
            *slot = photon.power.map(|power| (f64::from(power) * from.watts) as f32);
        }
        for (slot, (kind, _)) in kinds.iter_mut().zip(&from.photons) {
            *slot = match kind {
                MapKind::Direct => PM_PHOTON_DIRECT,
                MapKind::Caustic => PM_PHOTON_CAUSTIC,
                _ => PM_PHOTON_GLOBAL,
            };
        }
        Ok(())
    })
}

/// Frees photons; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_photons_free(photons: *mut PmPhotons) {
    // SAFETY: the caller's handle.
    free(|| unsafe { pointer::free(photons) });
}

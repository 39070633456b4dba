//! The kernels of photon tracing: `follow`, compiled for sets of lobes and flags.

use photon_core::Features;

use super::{Follow, follow};

/// Flag beside the bits of the lobes: paths are aimed.
pub(super) const AIMED: u64 = 1 << 32;
/// Flag beside the bits of the lobes: solids are nested or overlap.
pub(super) const NESTED: u64 = 1 << 33;

/// Flag beside the bits of the lobes: only photons for the reflection of glossy surfaces are stored.
pub(super) const REFLECTED: u64 = 1 << 34;
/// The kernel for them, with all lobes.
pub(super) const REFLECTIONS: u64 = Features::ALL.bits() as u64 | AIMED | NESTED | REFLECTED;
/// Flag beside the bits of the lobes: paths pause before each ray ([`Paused`]).
pub(super) const BATCHED: u64 = 1 << 35;
/// Flag beside the bits of the lobes: some medium scatters light.
pub(super) const SCATTERS: u64 = 1 << 36;
/// The kernel for it, with all lobes.
pub(super) const SCATTERING: u64 = SHADED | Features::RANDOM_SURFACES.bits() as u64 | SCATTERS;
/// All lobes of reflection and transmission, without textures, shading normals and all that needs them.
const ALL: u64 = Features::DIFFUSE
    .union(Features::MIRROR)
    .union(Features::DIELECTRIC)
    .union(Features::THIN)
    .union(Features::ABSORPTION)
    .bits() as u64;
/// The kernel for diffuse surfaces with textures or shading normals.
const MATTE: u64 = Features::DIFFUSE.union(Features::MATTE).bits() as u64;
/// The kernel for surfaces with textures or shading normals, with all lobes.
pub(super) const SHADED: u64 = ALL | NESTED | Features::SHADED.bits() as u64;

/// Lobes, and what surfaces have beside them, less alpha.
const SURFACES: Features =
    Features::SPECULAR.union(Features::ABSORPTION).union(Features::SHADED).union(Features::PARTIAL_TRANSMISSION);

/// Selects the kernel compiled for these lobes. Nested solids, surfaces with textures or shading normals or that disperse
/// light, and those where a random word decides what a ray meets have one kernel each with all lobes.
pub(super) fn kernel(features: Features, (nested, disperses): (bool, bool), aimed: bool) -> Follow {
    const D: Features = Features::DIFFUSE;
    const M: Features = D.union(Features::MIRROR);
    const GLASS: Features = Features::DIELECTRIC.union(Features::THIN);
    const ABSORBING: Features = GLASS.union(Features::ABSORPTION);
    let mirrors = features.intersects(Features::MIRROR);
    let absorbs = features.intersects(Features::ABSORPTION);
    let lobes = (features.intersects(GLASS), absorbs, mirrors);
    // Nothing on surfaces but what diffuse ones have: paths are not aimed, and there are no solids.
    let is_matte = !features.intersects(SURFACES.difference(D.union(Features::MATTE))) && !aimed && !nested;
    if is_matte && features.intersects(Features::RANDOM_SURFACES) {
        return follow::<{ MATTE | Features::ALPHA.bits() as u64 }>;
    }
    if is_matte && features.intersects(Features::SHADED) {
        return follow::<MATTE>;
    }
    if features.intersects(Features::RANDOM_SURFACES) {
        const RANDOM: u64 = SHADED | Features::RANDOM_SURFACES.bits() as u64;
        return if aimed { follow::<{ RANDOM | AIMED }> } else { follow::<RANDOM> };
    }
    if features.intersects(Features::SHADED) || disperses {
        return if aimed { follow::<{ SHADED | AIMED }> } else { follow::<SHADED> };
    }
    if nested && lobes.0 {
        return if aimed { follow::<{ ALL | NESTED | AIMED }> } else { follow::<{ ALL | NESTED }> };
    }
    if aimed {
        return match lobes {
            (false, ..) => follow::<{ M.bits() as u64 | AIMED }>,
            (true, false, _) => follow::<{ M.union(GLASS).bits() as u64 | AIMED }>,
            (true, true, _) => follow::<{ ALL | AIMED }>,
        };
    }
    match lobes {
        (false, _, false) => follow::<{ D.bits() as u64 }>,
        (false, _, true) => follow::<{ M.bits() as u64 }>,
        (true, false, false) => follow::<{ D.union(GLASS).bits() as u64 }>,
        (true, false, true) => follow::<{ M.union(GLASS).bits() as u64 }>,
        (true, true, false) => follow::<{ D.union(ABSORBING).bits() as u64 }>,
        (true, true, true) => follow::<{ ALL }>,
    }
}

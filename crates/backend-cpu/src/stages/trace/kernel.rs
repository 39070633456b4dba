//! The kernels of photon tracing: `follow`, compiled for sets of lobes and flags.

use photon_core::Features;

use super::{Follow, follow};

/// Flag beside the bits of the lobes: paths are aimed.
pub(super) const AIMED: u32 = 1 << 31;
/// Flag beside the bits of the lobes: solids are nested or overlap.
pub(super) const NESTED: u32 = 1 << 30;

/// Flag beside the bits of the lobes: only photons for the reflection of glossy surfaces are stored.
pub(super) const REFLECTED: u32 = 1 << 29;
/// The kernel for them, with all lobes.
pub(super) const REFLECTIONS: u32 = Features::ALL.bits() | AIMED | NESTED | REFLECTED;
/// Flag beside the bits of the lobes: paths pause before each ray ([`Paused`]).
pub(super) const BATCHED: u32 = 1 << 28;
/// All lobes of reflection and transmission, without textures, shading normals and all that needs them.
const ALL: u32 = Features::DIFFUSE
    .union(Features::MIRROR)
    .union(Features::DIELECTRIC)
    .union(Features::THIN)
    .union(Features::ABSORPTION)
    .bits();
/// The kernel for surfaces with textures or shading normals, with all lobes.
pub(super) const SHADED: u32 = ALL | NESTED | Features::SHADED.bits();

/// Selects the kernel compiled for these lobes. Nested solids, surfaces with textures or shading normals, and those with
/// alpha have one kernel each with all lobes.
pub(super) fn kernel(features: Features, nested: bool, aimed: bool) -> Follow {
    const D: Features = Features::DIFFUSE;
    const M: Features = D.union(Features::MIRROR);
    const GLASS: Features = Features::DIELECTRIC.union(Features::THIN);
    const ABSORBING: Features = GLASS.union(Features::ABSORPTION);
    let mirrors = features.intersects(Features::MIRROR);
    let absorbs = features.intersects(Features::ABSORPTION);
    let lobes = (features.intersects(GLASS), absorbs, mirrors);
    if features.contains(Features::ALPHA) {
        const ALPHA: u32 = SHADED | Features::ALPHA.bits();
        return if aimed { follow::<{ ALPHA | AIMED }> } else { follow::<ALPHA> };
    }
    if features.intersects(Features::SHADED) {
        return if aimed { follow::<{ SHADED | AIMED }> } else { follow::<SHADED> };
    }
    if nested && lobes.0 {
        return if aimed { follow::<{ ALL | NESTED | AIMED }> } else { follow::<{ ALL | NESTED }> };
    }
    if aimed {
        return match lobes {
            (false, ..) => follow::<{ M.bits() | AIMED }>,
            (true, false, _) => follow::<{ M.union(GLASS).bits() | AIMED }>,
            (true, true, _) => follow::<{ ALL | AIMED }>,
        };
    }
    match lobes {
        (false, _, false) => follow::<{ D.bits() }>,
        (false, _, true) => follow::<{ M.bits() }>,
        (true, false, false) => follow::<{ D.union(GLASS).bits() }>,
        (true, false, true) => follow::<{ M.union(GLASS).bits() }>,
        (true, true, false) => follow::<{ D.union(ABSORBING).bits() }>,
        (true, true, true) => follow::<{ ALL }>,
    }
}

//! Structs that the host writes and kernels read. Each is declared once in Rust, and a test compares names, offsets and
//! types of its members with those in the SPIR-V.

use bytemuck::Pod;

use crate::device::Module;

/// Maximum size in bytes of parameters that are push constants. Longer ones are written to memory, and only their address is
/// pushed.
pub(crate) const MAX_PUSHED: usize = 32;

/// The parameters of a dispatch.
pub(crate) trait Parameters: Pod {
    /// The kernels that have these parameters.
    const MODULES: &'static [&'static Module];
}

/// `host_struct! { struct Line { origin: [f32; 3], .. } }` declares a struct that the kernels know by the same name, and a
/// test of that name.
macro_rules! host_struct {
    ($(#[$attribute:meta])* $vis:vis struct $name:ident { $($members:tt)+ }) => {
        laid_out! { $(#[$attribute])* $vis struct $name { $($members)+ } }

        #[cfg(test)]
        #[test]
        #[expect(non_snake_case, reason = "named as the struct")]
        fn $name() {
            crate::probe::layout::check_struct::<$name>(stringify!($name));
        }
    };
}

/// `parameters! { struct CountPush => SORT_COUNT { keys: u64, .. } }` declares the parameters of those kernels, and a test of
/// that name: in GLSL they are `push`, a block of push constants up to [`MAX_PUSHED`] bytes, or the address of one.
macro_rules! parameters {
    ($(#[$attribute:meta])* $vis:vis struct $name:ident => $($module:ident)+ { $($members:tt)+ }) => {
        laid_out! { $(#[$attribute])* $vis struct $name { $($members)+ } }

        impl crate::parameters::Parameters for $name {
            const MODULES: &'static [&'static crate::device::Module] = &[$(&crate::shaders::$module),+];
        }

        #[cfg(test)]
        #[test]
        #[expect(non_snake_case, reason = "named as the struct")]
        fn $name() {
            crate::probe::parameters::check_parameters::<$name>();
        }
    };
}

/// Declares a struct and, for tests, lists its members.
macro_rules! laid_out {
    ($(#[$attribute:meta])* $vis:vis struct $name:ident {
        $($(#[$member_attribute:meta])* $member_vis:vis $member:ident: $type:ty),+ $(,)?
    }) => {
        $(#[$attribute])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        $vis struct $name {
            $($(#[$member_attribute])* $member_vis $member: $type),+
        }

        #[cfg(test)]
        impl crate::probe::layout::Listed for $name {
            fn members() -> Vec<crate::probe::spirv::Member> {
                vec![$(crate::probe::layout::member::<$type>(stringify!($member), std::mem::offset_of!($name, $member))),+]
            }
        }
    };
}

//! Specialization constants by name: a struct for each kernel, whose names, ids and types a test compares with the
//! compiled kernel. Constant 1, the workgroup size, is passed separately, since every kernel has it.

use photon_core::{Features, MediaFeatures, PhotonFormat};

use crate::device::Module;

/// Values of the specialization constants of some modules.
pub(crate) trait Constants {
    /// The modules that have these constants.
    const MODULES: &'static [&'static Module];

    /// Ids and values.
    fn words(&self) -> Vec<(u32, u32)>;
}

/// Every constant has its default value.
impl Constants for () {
    const MODULES: &'static [&'static Module] = &[];

    fn words(&self) -> Vec<(u32, u32)> {
        Vec::new()
    }
}

/// A value as a kernel receives it.
pub(crate) trait Constant {
    /// Whether it may be passed for a `bool` in GLSL; everything may be passed for a `uint`.
    #[cfg(test)]
    const IS_BOOL: bool = false;

    /// The word.
    fn word(self) -> u32;
}

impl Constant for u32 {
    fn word(self) -> u32 {
        self
    }
}

impl Constant for bool {
    #[cfg(test)]
    const IS_BOOL: bool = true;

    fn word(self) -> u32 {
        self.into()
    }
}

impl Constant for Features {
    fn word(self) -> u32 {
        self.bits()
    }
}

impl Constant for MediaFeatures {
    fn word(self) -> u32 {
        self.bits()
    }
}

impl Constant for PhotonFormat {
    fn word(self) -> u32 {
        self.number()
    }
}

/// `specialized!(key_constants: KeyConstants => SORT_COUNT SORT_SCATTER, 2 key_words: u32)` defines the struct
/// `KeyConstants` and the test `key_constants`, which compares ids, names and types with the SPIR-V of those modules;
/// in GLSL the names are in capitals. The list may end in `; default` and names of constants that are not set.
macro_rules! specialized {
    ($test:ident: $constants:ident => $($module:ident)+, $($id:literal $name:ident: $type:ty),+
        $(; default $($unset:ident)+)?) => {
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $constants {
            $(pub(crate) $name: $type),+
        }

        impl crate::specialization::Constants for $constants {
            const MODULES: &'static [&'static crate::device::Module] = &[$(&crate::shaders::$module),+];

            fn words(&self) -> Vec<(u32, u32)> {
                vec![$(($id, crate::specialization::Constant::word(self.$name))),+]
            }
        }

        #[cfg(test)]
        #[test]
        fn $test() {
            use crate::specialization::{Constant, Constants};
            let set = [$(($id, stringify!($name), <$type as Constant>::IS_BOOL)),+];
            let unset: &[&str] = &[$($(stringify!($unset)),+)?];
            for module in <$constants as Constants>::MODULES {
                let checked = crate::probe::specialization::check(&module.words(), &set, unset);
                checked.unwrap_or_else(|message| panic!("{}: {message}", module.name));
            }
        }
    };
}

//! Checks that push constants have the same layout in Rust as in the compiled kernels: one line beside each
//! struct generates the test.

/// `pushed!(count_push_layout: CountPush => SORT_COUNT, keys counts)` defines the test `count_push_layout`,
/// which compares the members, by their names in the shader, with the push constants in the SPIR-V of those
/// modules.
macro_rules! pushed {
    ($test:ident: $record:ident => $($module:ident)+, $($member:ident)+) => {
        #[cfg(test)]
        #[test]
        fn $test() {
            fn bytes<R, T>(_: fn(&R) -> &T) -> u32 {
                size_of::<T>() as u32
            }
            let members = [$((
                stringify!($member),
                std::mem::offset_of!($record, $member) as u32,
                bytes(|record: &$record| &record.$member),
            )),+];
            for module in [$(&crate::shaders::$module),+] {
                let checked = crate::probe::push::check(&module.words(), size_of::<$record>(), &members);
                checked.unwrap_or_else(|message| panic!("{}: {message}", module.name));
            }
        }
    };
}

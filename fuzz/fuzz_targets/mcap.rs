#![cfg_attr(fuzzing, no_main)]

#[cfg(fuzzing)]
libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    alula_fuzz::files::mcap(data);
});

#[cfg(not(fuzzing))]
fn main() {}

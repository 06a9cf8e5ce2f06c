#![cfg_attr(fuzzing, no_main)]

#[cfg(fuzzing)]
libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    alula_fuzz::mission::run(data);
});

#[cfg(not(fuzzing))]
fn main() {}

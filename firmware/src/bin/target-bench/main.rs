//! The bench on the target: instructions, stack and flash of the core's functions on an emulated Cortex-M4F.
//!
//! One program, two halves: built for the target it is the image that measures, built for the host it is the
//! runner that builds that image, starts it under QEMU and prints the table.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image;

#[cfg(not(target_os = "none"))]
mod runner;

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    match runner::main() {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("target-bench: {error}");
            std::process::ExitCode::FAILURE
        }
    }
}

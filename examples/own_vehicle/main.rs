//! A vehicle of one's own in Rust: `vehicle.rs`, as `alula-sil new` leaves it, and the loop around it.
//!
//! `cargo run --example own_vehicle` runs it for a second; `cargo build --release --example own_vehicle --target thumbv7em-none-eabihf` compiles it
//! for a microcontroller, whose sensors and motors take the places of `measured` and `command`.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod vehicle;

use alula::prelude::*;

/// Period of the control loop [s].
const PERIOD: f32 = 0.01;

/// What the estimator knows: here a vehicle that hovers in still air, and is asked to climb at 1 m/s.
fn measured() -> GuidanceInput {
    let reference = Reference {
        velocity: Ned::new(0.0, 0.0, -1.0),
        ..Reference::default()
    };
    GuidanceInput::default()
        .orientation(Orientation::NOSE_UP)
        .air(Air::Wind(Ned::ZERO))
        .reference(reference)
}

/// The guidance for a second, one step a period; `command` goes to rate loop and motors. The error is a number in `vehicle.rs` that is none.
fn fly(mut command: impl FnMut(&GuidanceOutput)) -> Result<(), ParameterError> {
    let guidance = vehicle::guidance()?;
    let mut state = GuidanceState::default();
    for _ in 0..100 {
        // Safe commands, until good inputs have come for a while: keep the motors to yourself as long as the mode is not `Flying`.
        let output = guidance.update(&mut state, &measured(), PERIOD);
        command(&output);
        // 16 times a second, and at once when the reference jumps. It takes longer than a step: a task of lower priority may do it.
        if output.plan_due {
            guidance.plan(&mut state);
        }
    }
    Ok(())
}

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), ParameterError> {
    let mut last = GuidanceOutput::default();
    fly(|output| last = *output)?;
    println!("{}: thrust {:.1} N", last.mode.name(), last.command.thrust);
    assert_eq!(last.mode, Mode::Flying);
    // More than the weight: it is to climb.
    assert!(last.command.thrust > vehicle::guidance()?.vehicle().weight());
    Ok(())
}

/// Where the start-up code of the board jumps to.
#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
pub extern "C" fn main() -> ! {
    let _ = fly(|output| {
        // To the board's rate loop and motors.
        core::hint::black_box(output.command);
    });
    loop {
        core::hint::spin_loop();
    }
}

/// The core does not panic; the language asks for this all the same.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

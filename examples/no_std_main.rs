//! A control loop without an operating system: what a `main` on a microcontroller looks like, with the sensors and the motors left to its board.
//!
//! `cargo build --release --example no_std_main --target thumbv7em-none-eabihf` compiles it. On a computer it runs for a second.
#![cfg_attr(target_os = "none", no_std, no_main)]

use alula::guidance::Air;
use alula::planar::{Attitude, Inertial, PlanarGuidanceInput, Reference};
use alula::{
    Combined, CombinedParameters, Guidance, GuidanceParameters, GuidanceState, ParameterError,
    Vehicle, VehicleParameters,
};

/// Period of the control loop [s].
const PERIOD: f32 = 0.01;

/// What the state estimator tells.
#[derive(Clone, Copy, Default)]
struct Estimate {
    /// Velocity over ground (down, forward) [m/s].
    velocity: Inertial,
    /// Velocity through the air, likewise [m/s].
    air: Inertial,
    /// Attitude θ [rad].
    theta: f32,
}

/// What the board gives and takes.
trait Board {
    /// Waits for the next period; false when the flight is over.
    fn next_period(&mut self) -> bool;
    /// Where the vehicle is.
    fn estimate(&mut self) -> Estimate;
    /// What the pilot or the mission asks for.
    fn reference(&mut self) -> Reference;
    /// Thrust [N] and angular rate [rad/s], to the rate loop.
    fn command(&mut self, thrust: f32, rate: f32);
}

/// Everything that can be refused is refused here, before the flight; no step of the loop fails.
fn fly(board: &mut impl Board) -> Result<(), ParameterError> {
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3)?;
    let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
    let guidance = Guidance::new(vehicle, &GuidanceParameters::default())?;
    let mut memory = GuidanceState::default();
    while board.next_period() {
        let Estimate {
            velocity,
            air,
            theta,
        } = board.estimate();
        let input = PlanarGuidanceInput::default()
            .velocity(velocity)
            .attitude(Attitude::from_angle(theta))
            .air(Air::Velocity(air))
            .reference(board.reference());
        let guided = guidance.update_in_plane(&mut memory, &input, PERIOD);
        // In every mode the command is one to be flown. It begins with the safe one, no thrust, until good inputs have come for a while.
        board.command(guided.command.thrust, guided.command.rate);
    }
    Ok(())
}

/// A board on a bench: it stands still, nose up.
struct Bench {
    periods: u32,
    last_thrust: f32,
}

impl Board for Bench {
    fn next_period(&mut self) -> bool {
        let more = self.periods > 0;
        self.periods = self.periods.saturating_sub(1);
        more
    }
    fn estimate(&mut self) -> Estimate {
        Estimate::default()
    }
    fn reference(&mut self) -> Reference {
        Reference::default()
    }
    fn command(&mut self, thrust: f32, _rate: f32) {
        self.last_thrust = thrust;
    }
}

const BENCH: Bench = Bench {
    periods: 100,
    last_thrust: 0.0,
};

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), ParameterError> {
    let mut board = BENCH;
    fly(&mut board)?;
    println!("hover: {:.1} N", board.last_thrust);
    // Near the weight of the 9 kg that are believed in.
    assert!((board.last_thrust - 88.3).abs() < 5.0);
    Ok(())
}

/// Where the start-up code of the board jumps to.
#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
pub extern "C" fn main() -> ! {
    let mut board = BENCH;
    let _ = fly(&mut board);
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

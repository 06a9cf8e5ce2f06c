//! The paper's law, bare: a state and a reference in, thrust and angular rate out. `cargo run --example bare_law`
use alula::planar::{Attitude, GainParameters, Gains, Inertial, Reference, State, VelocityControl};
use alula::{
    Combined, CombinedParameters, ParameterError, Parameters, Vehicle, VehicleParameters,
    aerodynamic_constant,
};

fn main() -> Result<(), ParameterError> {
    // What the controller believes of the aircraft: a 3 kg tail-sitter, 0.35 m² of wing in air of 1.2 kg/m³.
    let vehicle = Vehicle::new(
        VehicleParameters::DEFAULT
            .mass(3.0)
            .k_a(aerodynamic_constant(1.2, 0.35)?)
            .thrust_max(47.0),
        Combined::new(CombinedParameters::NACA_0021_RE_160E3)?,
    )?;
    let control = VelocityControl::new(vehicle, Gains::new(GainParameters::PAPER)?);

    println!("speed [m/s]  θ [°]  thrust [N]  rate [rad/s]");
    for (speed, pitch) in [
        (0.0_f32, 0.0_f32),
        (5.0, -35.0),
        (12.0, -70.0),
        (18.0, -84.0),
    ] {
        // Vectors are (down, forward). θ = 0 is nose up, −90° nose forward.
        let state = State {
            velocity: Inertial::new(0.0, speed),
            attitude: Attitude::from_angle(pitch.to_radians()),
            ..State::default()
        };
        let reference = Reference {
            velocity: Inertial::new(0.0, speed),
            acceleration: Inertial::new(0.0, 1.0),
        };
        // A fault comes without a command: no thrust and no rotation is the safe one.
        let command = control.robust(&state, &reference, None).unwrap_or_default();
        assert!(command.thrust.is_finite() && command.rate.is_finite());
        println!(
            "{speed:11} {pitch:6} {:11.2} {:13.2}",
            command.thrust, command.rate
        );
    }
    Ok(())
}

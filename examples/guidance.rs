//! The guidance around the law, flying a vehicle that is simulated in a few lines: from hover to 18 m/s and back. `cargo run --example guidance`
use alula::guidance::Air;
use alula::*;

const DT: f32 = 0.01;

fn main() -> Result<(), ParameterError> {
    let vehicle = Vehicle::new(
        VehicleParameters {
            mass: 3.0,
            k_a: aerodynamic_constant(1.2, 0.35)?,
            thrust_max: 47.0,
            ..VehicleParameters::PAPER
        },
        Combined::new(CombinedParameters::NACA_0021_RE_160E3)?,
    )?;
    let guidance = Guidance::new(vehicle, &GuidanceParameters::DEFAULT)?;
    let mut memory = GuidanceState::default();

    // (down, forward); still air, a vehicle that does at once what it is told.
    let (mut velocity, mut theta) = (Inertial::ZERO, 0.0_f32);
    let (mut altitude, mut lowest) = (0.0_f32, 0.0_f32);
    for step in 0..4500 {
        let t = step as f32 * DT;
        // Forward at 2 m/s² to 18 m/s, on for ten seconds, and back.
        let acceleration = match t {
            1.0..10.0 => 2.0,
            20.0..29.0 => -2.0,
            _ => 0.0,
        };
        let speed = (2.0 * (t - 1.0)).clamp(0.0, 18.0) - (2.0 * (t - 20.0)).clamp(0.0, 18.0);
        let attitude = Attitude::from_angle(theta);
        let input = PlanarGuidanceInput {
            velocity,
            attitude,
            air: Air::Velocity(velocity),
            reference: Reference {
                velocity: Inertial::new(0.0, speed),
                acceleration: Inertial::new(0.0, acceleration),
            },
            ..PlanarGuidanceInput::default()
        };
        let command = guidance.update_in_plane(&mut memory, &input, DT).command;

        // The vehicle: thrust along the nose, the wing's force, gravity.
        let air = AirData::new(attitude.to_body(velocity), vehicle.thrust_line());
        let force = vehicle.aerodynamic_force(&air) + Body::new(-command.thrust, 0.0);
        let force = attitude.to_inertial(force);
        velocity = Inertial::new(
            velocity.down() + DT * (force.down() / vehicle.mass() + vehicle.gravity()),
            velocity.forward() + DT * force.forward() / vehicle.mass(),
        );
        theta += DT * command.rate;
        altitude -= DT * velocity.down();
        lowest = lowest.min(altitude);
        if step % 250 == 0 {
            println!(
                "{t:5.1} s  {:6.2} m/s of {speed:5.2}  θ {:6.1}°  altitude {altitude:6.2} m  thrust {:5.1} N",
                velocity.forward(),
                theta.to_degrees(),
                command.thrust
            );
        }
    }
    assert!(velocity.norm() < 0.5, "back in hover: {velocity:?}");
    assert!(lowest > -5.0, "it sank to {lowest} m");
    Ok(())
}

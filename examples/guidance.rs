//! `cargo run --example guidance`
use alula::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 9 kg, k_a = ρΣ/2 = 0.51 kg/m, thrust to 196 N, a NACA 0021 wing.
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3)?;
    let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
    let guidance = Guidance::new(vehicle, &GuidanceParameters::default())?;
    let mut state = GuidanceState::default();

    // Hovering with the nose up in still air, asked to fly north at 10 m/s.
    let input = GuidanceInput::default()
        .velocity(Ned::ZERO)
        .orientation(Orientation::NOSE_UP)
        .air(Air::Wind(Ned::ZERO))
        .reference(Reference {
            velocity: Ned::new(10.0, 0.0, 0.0),
            ..Reference::default()
        });
    for _ in 0..10 {
        let output = guidance.update(&mut state, &input, 0.01);
        if output.plan_due {
            guidance.plan(&mut state);
        }
        let Command { thrust, rates, .. } = output.command;
        let BodyRates { roll, pitch, yaw } = rates;
        println!("{thrust} N, {roll} {pitch} {yaw} rad/s");
    }
    Ok(())
}

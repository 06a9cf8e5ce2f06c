use alula::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 9 kg, k_a = ρΣ/2 = 0.51 kg/m, thrust to 196 N, a NACA 0021 wing.
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3)?;
    let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
    let guidance = Guidance::new(vehicle, &GuidanceParameters::DEFAULT)?;
    let mut state = GuidanceState::default();

    // Hovering with the nose up; asked to fly north at 10 m/s. Quaternion w, x, y, z of the autopilot's axes.
    let attitude = Quaternion {
        w: 0.5_f32.sqrt(),
        x: 0.0,
        y: 0.5_f32.sqrt(),
        z: 0.0,
    };
    let input = GuidanceInput {
        velocity: Ned::new(0.0, 0.0, 0.0),
        orientation: Orientation::from_quaternion(&attitude, BodyAxes::NoseForward)?,
        air: Air::Wind(Ned::new(0.0, 0.0, 0.0)),
        reference: Reference {
            velocity: Ned::new(10.0, 0.0, 0.0),
            ..Reference::default()
        },
        ..GuidanceInput::default()
    };
    for _ in 0..10 {
        let output = guidance.update(&mut state, &input, 0.01);
        let [p, q, r] = BodyAxes::NoseForward.components(output.command.rates);
        println!(
            "{}: {} N, {p} {q} {r} rad/s",
            output.mode.name(),
            output.command.thrust
        );
    }
    Ok(())
}

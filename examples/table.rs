//! Measured coefficients: a table of rows, checked and made into polynomials by the compiler. `cargo run --example table`
use alula::aero::{Node, Polar};
use alula::planar::PlanarGuidanceInput;
use alula::{
    Aerodynamics as _, AngleOfAttack, Guidance, GuidanceParameters, GuidanceState, ParameterError,
    Parameters, Table, Vehicle, VehicleParameters, aerodynamic_constant,
};

/// A symmetric section from 0 to 180°: angle of attack [°], c_L, c_D. Room for sixteen rows.
const POLAR: Polar<15> = match Polar::new(&[
    Node::from_degrees(0.0, 0.0, 0.012),
    Node::from_degrees(4.0, 0.40, 0.014),
    Node::from_degrees(8.0, 0.75, 0.022),
    Node::from_degrees(11.0, 0.92, 0.040),
    Node::from_degrees(14.0, 0.70, 0.180),
    Node::from_degrees(20.0, 0.68, 0.330),
    Node::from_degrees(30.0, 0.90, 0.620),
    Node::from_degrees(45.0, 1.02, 1.100),
    Node::from_degrees(60.0, 0.85, 1.500),
    Node::from_degrees(90.0, 0.05, 1.900),
    Node::from_degrees(120.0, -0.80, 1.500),
    Node::from_degrees(135.0, -0.95, 1.080),
    Node::from_degrees(150.0, -0.80, 0.600),
    Node::from_degrees(170.0, -0.70, 0.120),
    Node::from_degrees(180.0, 0.0, 0.025),
]) {
    Ok(polar) => polar,
    // A row that is wrong does not compile.
    Err(_) => panic!(),
};
static TABLE: Polar<15> = POLAR;

fn main() -> Result<(), ParameterError> {
    let model = Table::new(&TABLE);
    let at = |degrees: f32| model.coefficients(AngleOfAttack::from_radians(degrees.to_radians()));
    println!("α [°]    c_L    c_D");
    for degrees in [0.0, 5.5, 9.5, 16.0, 75.0, -8.0] {
        let c = at(degrees);
        println!("{degrees:5} {:6.3} {:6.3}", c.c_l, c.c_d);
    }
    // Through the rows, and odd on the other side.
    assert!((at(8.0).c_l - 0.75).abs() < 1e-4 && (at(-8.0).c_l + 0.75).abs() < 1e-4);

    let vehicle = Vehicle::new(
        VehicleParameters::DEFAULT
            .mass(3.0)
            .k_a(aerodynamic_constant(1.2, 0.35)?)
            .thrust_max(47.0),
        model,
    )?;
    let guidance = Guidance::new(vehicle, &GuidanceParameters::default())?;
    // It stands in still air. The guidance wants to have seen good inputs for a while before it flies.
    let (input, mut memory) = (PlanarGuidanceInput::default(), GuidanceState::default());
    let mut thrust = 0.0;
    for _ in 0..100 {
        let guided = guidance.update_in_plane(&mut memory, &input, 0.01);
        thrust = guided.command.thrust;
    }
    println!("the guidance flies it: {thrust:.2} N");
    assert!(thrust > 20.0);
    Ok(())
}

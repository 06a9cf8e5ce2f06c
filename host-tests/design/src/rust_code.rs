//! A vehicle as Rust: a module that makes its guidance.

use std::fmt::Write as _;

use super::code::Coded;
use alula_sim::experiment::AerodynamicsSpec;

/// A number of Rust in single precision.
fn float(x: f32) -> String {
    format!("{x:?}")
}

/// The module of the vehicle `name`: `guidance` makes its guidance, with every number that its file came to. It needs `alula` alone, and no heap.
pub fn rust_code(name: &str, coded: &Coded) -> String {
    let mut text = format!(
        "//! {name}, as {name}.toml has it: `alula-sil code {name}.toml` makes it anew. `mod vehicle;`, then `vehicle::guidance()`, once.\n\n"
    );
    let (kind, model) = match (
        &coded.vehicle.aerodynamics,
        coded.vehicle.aerodynamics.parameters(),
    ) {
        (AerodynamicsSpec::Table { polar }, _) => {
            let rows = polar.rows.len();
            text += "use alula::aero::{Node, Polar};\nuse alula::{\n    Guidance, GuidanceParameters, ParameterError, Parameters as _, Table, Vehicle,\n    VehicleParameters,\n};\n\n";
            let _ = writeln!(
                text,
                "// Angle of attack to the zero-lift line [rad], c_L, c_D.\n#[rustfmt::skip]\n#[allow(clippy::approx_constant)] // a row at 30° is no constant of mathematics\nstatic POLAR: Polar<{rows}> = match Polar::new(&["
            );
            for row in polar.rows {
                let [alpha, c_l, c_d] = row.map(|x| float(x as f32));
                let _ = writeln!(
                    text,
                    "    Node {{ alpha: {alpha}, c_l: {c_l}, c_d: {c_d} }},"
                );
            }
            text += "]) {\n    Ok(polar) => polar,\n    // A row that is wrong does not compile.\n    Err(_) => panic!(),\n};\n\n";
            ("Table<'static>", "Table::new(&POLAR)".to_owned())
        }
        (spec, Ok(parameters)) => {
            let kind = match spec {
                AerodynamicsSpec::LargeAngle(_) => "LargeAngle",
                AerodynamicsSpec::SmallAngle(_) => "SmallAngle",
                _ => "Combined",
            };
            let _ = writeln!(
                text,
                "use alula::{{\n    Guidance, GuidanceParameters, {kind}, {kind}Parameters, ParameterError, Parameters as _, Vehicle, VehicleParameters,\n}};\n"
            );
            let fields = parameters.rows().iter().enumerate();
            let fields: Vec<String> = fields
                .map(|(i, row)| format!("{}: {}", row.name, float(parameters.get(i))))
                .collect();
            (
                kind,
                format!("{kind}::new({kind}Parameters {{ {} }})?", fields.join(", ")),
            )
        }
        (other, Err(_)) => unreachable!("a table is one: {other:?}"),
    };
    let _ = write!(
        text,
        "/// Its coefficients.\npub type Model = {kind};\n\n\
         /// The guidance of the vehicle.\n///\n/// # Errors\n/// None, unless the numbers are changed.\n\
         #[rustfmt::skip]\n#[allow(clippy::approx_constant, clippy::excessive_precision)] // numbers as the file came to them\n\
         pub fn guidance() -> Result<Guidance<Model>, ParameterError> {{\n    let mut aircraft = VehicleParameters::DEFAULT;\n"
    );
    for (field, value) in coded.of_vehicle() {
        let _ = writeln!(text, "    aircraft.{field} = {};", float(value));
    }
    text += "    let mut parameters = GuidanceParameters::DEFAULT;\n";
    for (field, value) in coded.of_guidance() {
        let _ = writeln!(text, "    parameters.{field} = {};", float(value));
    }
    let _ = write!(
        text,
        "    Guidance::new(Vehicle::new(aircraft, {model})?, &parameters)\n}}\n"
    );
    text
}

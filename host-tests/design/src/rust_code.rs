//! The vehicle as Rust: a module that makes its guidance.

use std::fmt::Write as _;

use super::Design;
use alula_sim::experiment::AerodynamicsSpec;
use alula_sim::named::on_one_line;

/// A number of Rust in single precision.
fn float(x: f64) -> String {
    format!("{:?}", x as f32)
}

/// The module of the vehicle `name`: `guidance` makes a guidance by the rules that made its file. It needs `alula` alone, and no heap.
pub fn rust_text(name: &str, design: &Design) -> String {
    let facts = &design.facts;
    let [least, most] = facts.thrust();
    let mut text = format!(
        "//! {name}, made by `alula-sil new`: `mod vehicle;`, then `vehicle::guidance()`, once.\n\n"
    );
    let model = match &design.wing.aerodynamics {
        AerodynamicsSpec::Table { polar } => {
            let rows = polar.rows.len();
            text += "use alula::aero::{Node, Polar};\nuse alula::{\n    Guidance, GuidanceParameters, ParameterError, Parameters as _, ResponseParameters, Table,\n    Vehicle, VehicleParameters,\n};\n\n";
            for sentence in &design.wing.story {
                let _ = writeln!(text, "// {}.", on_one_line(sentence));
            }
            let _ = writeln!(
                text,
                "#[rustfmt::skip]\n#[allow(clippy::approx_constant)] // a row at 30° is no constant of mathematics\nstatic POLAR: Polar<{rows}> = match Polar::new(&["
            );
            for &[alpha, c_l, c_d] in polar.rows {
                let [alpha, c_l, c_d] = [alpha, c_l, c_d].map(float);
                let _ = writeln!(
                    text,
                    "    Node {{ alpha: {alpha}, c_l: {c_l}, c_d: {c_d} }},"
                );
            }
            text += "]) {\n    Ok(polar) => polar,\n    // A row that is wrong does not compile.\n    Err(_) => panic!(),\n};\n\n/// Its coefficients.\npub type Model = Table<'static>;\n\n";
            "Table::new(&POLAR)".to_owned()
        }
        AerodynamicsSpec::LargeAngle(model) => {
            text += "use alula::{\n    Guidance, GuidanceParameters, LargeAngle, LargeAngleParameters, ParameterError,\n    Parameters as _, ResponseParameters, Vehicle, VehicleParameters,\n};\n\n\
                     /// Its coefficients.\npub type Model = LargeAngle;\n\n";
            format!(
                "LargeAngle::new(LargeAngleParameters {{ c0: {}, c1: {} }})?",
                float(model.c0),
                float(model.c1)
            )
        }
        other => unreachable!("no wing has {other:?}"),
    };
    text += "/// The guidance of the vehicle.\n///\n/// # Errors\n/// None, unless the numbers are changed.\n\
             pub fn guidance() -> Result<Guidance<Model>, ParameterError> {\n    let mut aircraft = VehicleParameters::DEFAULT;\n";
    for (field, value) in [
        ("mass", facts.mass_kg),
        ("k_a", facts.k_a()),
        ("delta", facts.delta_deg.to_radians()),
        ("thrust_min", least),
        ("thrust_max", most),
    ] {
        let _ = writeln!(text, "    aircraft.{field} = {};", float(value));
    }
    let [rate, thrust, hertz, cruise] = [
        facts.rate_lag_s,
        facts.thrust_lag_s,
        facts.control_rate_hz,
        facts.cruise_m_s,
    ]
    .map(float);
    text += "    let mut response = ResponseParameters::DEFAULT;\n";
    for (field, value) in [
        ("rate_lag", rate),
        ("thrust_lag", thrust),
        ("control_rate", hertz),
        ("cruise_speed", cruise),
    ] {
        let _ = writeln!(text, "    response.{field} = {value};");
    }
    let _ = write!(
        text,
        "    let parameters = GuidanceParameters::for_vehicle(&aircraft, &response)?;\n    \
         Guidance::new(Vehicle::new(aircraft, {model})?, &parameters)\n}}\n"
    );
    text
}

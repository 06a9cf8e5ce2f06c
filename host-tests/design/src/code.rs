//! A vehicle as C code for an autopilot: a header that makes its controller.

use std::fmt::Write as _;

use alula::{GuidanceParameters, Parameters as _, VehicleParameters};
use alula_sim::experiment::{AerodynamicsSpec, VehicleSpec};

/// A vehicle with its guidance, as code: every number that its file came to.
#[derive(Clone, Copy, Debug)]
pub struct Coded<'a> {
    /// The vehicle.
    pub vehicle: &'a VehicleSpec,
    /// Least and greatest thrust \[N\].
    pub thrust: [f64; 2],
    /// The parameters of its guidance.
    pub parameters: &'a GuidanceParameters,
}

impl Coded<'_> {
    /// Its numbers in the core's parameters of the vehicle that are not by default: name and value.
    pub(super) fn of_vehicle(&self) -> Vec<(&'static str, f32)> {
        let parameters = self.vehicle.parameters(self.thrust);
        let rows = VehicleParameters::ROWS.iter().enumerate();
        let values = rows.map(|(i, row)| (row.name, parameters.get(i), row.default));
        let changed = values.filter(|(_, value, default)| value.to_bits() != default.to_bits());
        changed.map(|(name, value, _)| (name, value)).collect()
    }

    /// The parameters of its guidance: name and value.
    pub(super) fn of_guidance(&self) -> impl Iterator<Item = (&'static str, f32)> {
        let rows = GuidanceParameters::ROWS.iter().enumerate();
        rows.map(|(i, row)| (row.name, self.parameters.get(i)))
    }
}

/// A number of C in single precision.
fn float(x: f32) -> String {
    format!("{x:?}f")
}

/// The header of the vehicle `name`: `vehicle_init` makes its controller, with every number that its file came to.
pub fn c_code(name: &str, coded: &Coded) -> String {
    let mut text = format!(
        "/* {name}, as {name}.toml has it: `alula-sil code {name}.toml` makes it anew. Include it in one source file, link alula (docs/integrating.md), call\n   \
         vehicle_init once. */\n\
         #ifndef VEHICLE_H\n#define VEHICLE_H\n\n#include <alula.h>\n\n"
    );
    if let AerodynamicsSpec::Table { polar } = &coded.vehicle.aerodynamics {
        text += "/* Angle of attack to the zero-lift line [rad], c_L, c_D. */\nstatic const alula_table_row vehicle_rows[] = {\n";
        for row in polar.rows {
            let [alpha, c_l, c_d] = row.map(|x| float(x as f32));
            let _ = writeln!(text, "    {{{alpha}, {c_l}, {c_d}}},");
        }
        text += "};\n\n";
    }
    text += "/* Makes `controller`; `table` must stay where it is for as long as that is used. Returns ALULA_OK, or a code for alula_strerror. */\n\
             static inline int32_t vehicle_init(alula_controller *controller, alula_table *table)\n{\n    alula_parameters p;\n    int32_t code = ALULA_OK;\n\n    \
             p.header = ALULA_HEADER(alula_parameters);\n    controller->header = ALULA_HEADER(alula_controller);\n    \
             table->header = ALULA_HEADER(alula_table);\n    alula_parameters_default(&p);\n";
    let mut set = |field: &str, value: f32| {
        let _ = writeln!(text, "    p.{field} = {};", float(value));
    };
    for (field, value) in coded.of_vehicle() {
        set(&format!("vehicle.{field}"), value);
    }
    for (field, value) in coded.of_guidance() {
        set(&format!("guidance.{field}"), value);
    }
    let model = match coded.vehicle.aerodynamics.parameters() {
        Ok(model) => {
            for (row, field) in model.rows().iter().enumerate() {
                set(&format!("coefficients.{}", field.name), model.get(row));
            }
            coded
                .vehicle
                .aerodynamics
                .key()
                .to_uppercase()
                .replace('-', "_")
        }
        Err(_) => {
            text += "    code = alula_table_init(table, vehicle_rows, sizeof vehicle_rows / sizeof *vehicle_rows, 0);\n";
            "TABLE".to_owned()
        }
    };
    let _ = write!(
        text,
        "    p.controller.model = ALULA_MODEL_{model};\n    \
         return code == ALULA_OK ? alula_init(controller, &p, table) : code;\n}}\n\n#endif\n"
    );
    text
}

//! The vehicle as C code for an autopilot: a header that makes its controller.

use std::fmt::Write as _;

use super::Design;
use alula_sim::experiment::AerodynamicsSpec;
use alula_sim::named::on_one_line;

/// A number of C in single precision.
fn float(x: f64) -> String {
    format!("{:?}f", x as f32)
}

/// The header of the vehicle `name`: `vehicle_init` makes a controller by the rules that made its file.
pub fn code_text(name: &str, design: &Design) -> String {
    let facts = &design.facts;
    let [least, most] = facts.thrust();
    let mut text = format!(
        "/* {name}, made by `alula-sil new`. Include it in one source file, link alula (docs/integrating.md), call vehicle_init once. */\n\
         #ifndef VEHICLE_H\n#define VEHICLE_H\n\n#include <alula.h>\n\n"
    );
    if let AerodynamicsSpec::Table { polar } = &design.wing.aerodynamics {
        for sentence in &design.wing.story {
            // A file's name may hold anything.
            let sentence = on_one_line(sentence).replace("*/", "* /");
            let _ = writeln!(text, "/* {sentence}. */");
        }
        text += "static const alula_table_row vehicle_rows[] = {\n";
        for &[alpha, c_l, c_d] in polar.rows {
            let _ = writeln!(
                text,
                "    {{{}, {}, {}}},",
                float(alpha),
                float(c_l),
                float(c_d)
            );
        }
        text += "};\n\n";
    }
    text += "/* Makes `controller`; `table` must stay where it is for as long as that is used. Returns ALULA_OK, or a code for alula_strerror. */\n\
             static inline int32_t vehicle_init(alula_controller *controller, alula_table *table)\n{\n    alula_parameters p;\n    int32_t code;\n\n    \
             p.header = ALULA_HEADER(alula_parameters);\n    controller->header = ALULA_HEADER(alula_controller);\n    \
             table->header = ALULA_HEADER(alula_table);\n    alula_parameters_default(&p);\n";
    let mut set = |field: &str, value: f64| {
        let _ = writeln!(text, "    p.{field} = {};", float(value));
    };
    set("vehicle.mass", facts.mass_kg);
    set("vehicle.k_a", facts.k_a());
    set("vehicle.delta", facts.delta_deg.to_radians());
    set("vehicle.thrust_min", least);
    set("vehicle.thrust_max", most);
    match &design.wing.aerodynamics {
        AerodynamicsSpec::LargeAngle(model) => {
            set("coefficients.c0", model.c0);
            set("coefficients.c1", model.c1);
            text += "    p.controller.model = ALULA_MODEL_LARGE_ANGLE;\n    code = ALULA_OK;\n";
        }
        _ => {
            text += "    p.controller.model = ALULA_MODEL_TABLE;\n    \
                     code = alula_table_init(table, vehicle_rows, sizeof vehicle_rows / sizeof *vehicle_rows, 0);\n";
        }
    }
    let _ = write!(
        text,
        "    if (code == ALULA_OK)\n        code = alula_parameters_for_vehicle(&p, {}, {}, {}, {}); /* rate lag, thrust lag [s], rate [Hz], cruise [m/s] */\n    \
         return code == ALULA_OK ? alula_init(controller, &p, table) : code;\n}}\n\n#endif\n",
        float(facts.rate_lag_s),
        float(facts.thrust_lag_s),
        float(facts.control_rate_hz),
        float(facts.cruise_m_s)
    );
    text
}
